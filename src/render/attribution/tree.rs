//! The rays of a pixel.

use std::ops::Range;

use glam::Vec3;

use scene::geometry::Ray;
use tracer::accel::{Hit, TraversalStep};
use tracer::cost::{Cost, Probe, RayKind};

/// The rays of a pixel, each after its parent, and the steps of their traversals.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RayTree {
    /// The rays, sample by sample; the camera ray is the first of its sample.
    pub rays: Vec<TracedRay>,
    /// The steps, ray by ray.
    pub steps: Vec<TraversalStep>,
}

/// A ray, its hit, its cost and its contribution.
#[derive(Debug, Clone, PartialEq)]
pub struct TracedRay {
    /// Its kind.
    pub kind: RayKind,
    /// The index of the ray at whose hit it starts, lower than its own; `None` for
    /// camera rays.
    pub parent: Option<u32>,
    /// The index of its sample in the pixel.
    pub sample: u32,
    /// The index of a shadow ray's light in the scene file; `None` for other rays.
    pub light: Option<u32>,
    /// Number of reflections between the camera and its start.
    pub bounce: u32,
    /// Its origin and direction.
    pub ray: Ray,
    /// Only hits before this parameter count: for a shadow ray that of the light,
    /// for other rays infinity.
    pub t_max: f32,
    /// Its hit; for a shadow ray the one that occludes it.
    pub hit: Option<Hit>,
    /// The parameter at which it meets a particle of fog, which is before its hit, and from
    /// which its path goes on.
    pub particle: Option<f32>,
    /// Number of BVH nodes visited.
    pub node_visits: u32,
    /// Number of ray-primitive tests.
    pub primitive_tests: u32,
    /// Thread time in nanoseconds to trace it and to shade its hit, without the
    /// overhead of the clock; 0 without a clock. It is that of the kernel of
    /// `cost: time`, which records no steps.
    pub time_ns: f32,
    /// Its contribution to the pixel's color, without limits: the light of the
    /// point that it hit, or of the background, times its weight in the pixel.
    /// For a shadow ray, it is the part of its parent's contribution that would
    /// be missing without its light.
    pub contribution: Vec3,
    /// The range of its steps in the tree; empty if the observer keeps no steps.
    pub steps: Range<usize>,
}

impl TracedRay {
    /// The parameter at which it meets a particle or its hit.
    pub fn end(&self) -> Option<f32> {
        self.particle.or(self.hit.map(|hit| hit.t))
    }

    /// Its hit, if it gets there.
    pub fn surface(&self) -> Option<Hit> {
        self.hit.filter(|_| self.particle.is_none())
    }
}

impl RayTree {
    /// The steps of one of its rays.
    pub fn steps_of(&self, ray: &TracedRay) -> &[TraversalStep] {
        &self.steps[ray.steps.clone()]
    }

    /// The sum of the counters of all rays.
    pub fn cost(&self) -> Cost {
        let mut cost = Cost::default();
        for ray in &self.rays {
            cost.ray(ray.kind);
            cost.traversal(ray.node_visits, ray.primitive_tests);
            cost.bounce(ray.bounce);
        }
        cost
    }

    /// The pixel's color if no sample is limited.
    pub fn color(&self) -> Vec3 {
        color_of(&self.rays)
    }

    /// The pixel's color: the mean of the samples, each channel of which is limited
    /// to `most`, as by [`Scene::sample_limit`](scene::world::Scene::sample_limit).
    pub fn limited_color(&self, most: f32) -> Vec3 {
        let n_samples = self.rays.last().map_or(0, |ray| ray.sample + 1);
        let most = Vec3::splat(most / n_samples as f32);
        let samples = self.rays.chunk_by(|a, b| a.sample == b.sample);
        samples.map(|rays| color_of(rays).min(most)).sum()
    }

    /// Removes all rays and steps; keeps the memory.
    pub(super) fn clear(&mut self) {
        self.rays.clear();
        self.steps.clear();
    }
}

/// The sum of the contributions. Those of shadow rays are part of their parents'.
fn color_of(rays: &[TracedRay]) -> Vec3 {
    let rays = rays.iter().filter(|ray| ray.kind != RayKind::Shadow);
    rays.map(|ray| ray.contribution).sum()
}
