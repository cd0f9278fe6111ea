//! The rays of a pixel.

use std::ops::Range;

use glam::Vec3;

use crate::accel::{Hit, TraversalStep};
use crate::cost::{Cost, Probe, RayKind};
use crate::geometry::Ray;

/// The rays of a pixel, each after its parent, and all of their steps.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RayTree {
    /// Sample after sample; of each, the camera ray first.
    pub rays: Vec<TracedRay>,
    /// What the rays did, ray after ray.
    pub steps: Vec<TraversalStep>,
}

/// One ray and what became of it.
#[derive(Debug, Clone, PartialEq)]
pub struct TracedRay {
    /// Why it was shot.
    pub kind: RayKind,
    /// The ray whose hit it starts from, as its index in the tree, lower than
    /// its own; `None` for camera rays.
    pub parent: Option<u32>,
    /// The pixel's sample that it belongs to.
    pub sample: u32,
    /// The light that a shadow ray asks for, by its place in the scene file's
    /// list; `None` for other rays.
    pub light: Option<u32>,
    /// Mirrors on the way from the camera to its start.
    pub bounce: u32,
    /// Where it starts and goes.
    pub ray: Ray,
    /// Hits count before this parameter: the light of a shadow ray, which may be
    /// at infinity as the ends of other rays are.
    pub t_max: f32,
    /// What it met; of a shadow ray, what is in the way.
    pub hit: Option<Hit>,
    /// BVH nodes entered.
    pub node_visits: u32,
    /// Ray-primitive tests.
    pub primitive_tests: u32,
    /// Thread time in nanoseconds from its start to its hit, and to shade that,
    /// the clock's own cost taken off; 0 without a clock. The kernel is that of
    /// `cost: time`, without anybody who watches the steps.
    pub time_ns: f32,
    /// What it brings to the pixel's colour before any limit: the light of the
    /// point that it met, or of the background, by its weight in the pixel. A
    /// shadow ray's is the part of its parent's that would be missing without
    /// its light.
    pub contribution: Vec3,
    /// Its steps in those of the tree; none where the observer keeps none.
    pub steps: Range<usize>,
}

impl RayTree {
    /// The steps of one of its rays.
    pub fn steps_of(&self, ray: &TracedRay) -> &[TraversalStep] {
        &self.steps[ray.steps.clone()]
    }

    /// The counters of all rays together.
    pub fn cost(&self) -> Cost {
        let mut cost = Cost::default();
        for ray in &self.rays {
            cost.ray(ray.kind);
            cost.traversal(ray.node_visits, ray.primitive_tests);
            cost.bounce(ray.bounce);
        }
        cost
    }

    /// The pixel's colour before any limit.
    pub fn color(&self) -> Vec3 {
        color_of(&self.rays)
    }

    /// The pixel's colour as the film has it: each sample is limited to 1, a
    /// channel at a time, before their mean is taken.
    pub fn limited_color(&self) -> Vec3 {
        let n_samples = self.rays.last().map_or(0, |ray| ray.sample + 1);
        let most = Vec3::splat(1.0 / n_samples as f32);
        let samples = self.rays.chunk_by(|a, b| a.sample == b.sample);
        samples.map(|rays| color_of(rays).min(most)).sum()
    }

    /// Empties it, to be used for another pixel.
    pub(super) fn clear(&mut self) {
        self.rays.clear();
        self.steps.clear();
    }
}

/// What these rays bring together: what shadow rays bring is part of the others'.
fn color_of(rays: &[TracedRay]) -> Vec3 {
    let rays = rays.iter().filter(|ray| ray.kind != RayKind::Shadow);
    rays.map(|ray| ray.contribution).sum()
}
