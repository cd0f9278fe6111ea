//! The rays of a pixel.

use std::ops::Range;

use glam::Vec3;

use tracer::accel::{Hit, TraversalStep};
use tracer::cost::{Cost, Probe, RayKind};
use world::geometry::Ray;

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
    /// The kind of the ray.
    pub kind: RayKind,
    /// Index of the ray at whose hit this one starts, lower than this one's index; `None` for
    /// camera rays.
    pub parent: Option<u32>,
    /// Index of the sample in the pixel.
    pub sample: u32,
    /// Index of a shadow ray's light in the scene file; `None` for other rays.
    pub light: Option<u32>,
    /// Number of reflections between the camera and the start of the ray.
    pub bounce: u32,
    /// The origin and the direction.
    pub ray: Ray,
    /// Parameter before which hits count: the light's for a shadow ray, infinity for other rays.
    pub t_max: f32,
    /// The hit; for a shadow ray the hit that occludes it.
    pub hit: Option<Hit>,
    /// Parameter at which the ray meets a particle of fog, which is before its hit, and where its
    /// path continues.
    pub particle: Option<f32>,
    /// Number of BVH nodes visited.
    pub node_visits: u32,
    /// Number of ray-primitive tests.
    pub primitive_tests: u32,
    /// Thread time in nanoseconds to trace the ray and to shade its hit, without the overhead of
    /// the clock; 0 without a clock. It is the time of the kernel of `cost: time`, which records no
    /// steps.
    pub time_ns: f32,
    /// Contribution to the pixel's color, without limits: the light of the point that the ray hit,
    /// or of the background, times its weight in the pixel. For a shadow ray, the part of its
    /// parent's contribution that would be missing without its light.
    pub contribution: Vec3,
    /// Range of the ray's steps in the tree; empty if the observer keeps no steps.
    pub steps: Range<usize>,
}

impl TracedRay {
    /// Returns the parameter at which the ray meets a particle or its hit.
    pub fn end(&self) -> Option<f32> {
        self.particle.or(self.hit.map(|hit| hit.t))
    }

    /// Returns the hit, if the ray gets there.
    pub fn surface(&self) -> Option<Hit> {
        self.hit.filter(|_| self.particle.is_none())
    }
}

impl RayTree {
    /// Returns the steps of one of the rays.
    pub fn steps_of(&self, ray: &TracedRay) -> &[TraversalStep] {
        &self.steps[ray.steps.clone()]
    }

    /// Returns the sum of the counters of all rays.
    pub fn cost(&self) -> Cost {
        let mut cost = Cost::default();
        for ray in &self.rays {
            cost.ray(ray.kind);
            cost.traversal(ray.node_visits, ray.primitive_tests);
            cost.bounce(ray.bounce);
        }
        cost
    }

    /// Returns the pixel's color if no sample is limited.
    pub fn color(&self) -> Vec3 {
        color_of(&self.rays)
    }

    /// Returns the pixel's color: the mean of the samples, each channel of which is limited to
    /// `most`, as by [`Sensor::sample_limit`](scene::build::Sensor::sample_limit).
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

/// Returns the sum of the contributions. Contributions of shadow rays are part of their parents'
/// contributions.
fn color_of(rays: &[TracedRay]) -> Vec3 {
    let rays = rays.iter().filter(|ray| ray.kind != RayKind::Shadow);
    rays.map(|ray| ray.contribution).sum()
}
