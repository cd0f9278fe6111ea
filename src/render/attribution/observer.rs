//! The observation of a pixel.

use glam::Vec3;

use crate::attribution::{RayTree, TracedRay};
use crate::tiles::{SampleSums, View};
use scene::geometry::Ray;
use scene::light::Illumination;
use scene::world::Sensor;
use tracer::accel::{Hit, TraversalStep};
use tracer::cost::{Clock, Cost, RayKind};
use tracer::shade::{LightSample, PathRay};
use tracer::trace::{SurfacePoint, Tracer};

/// Renders pixels and records their rays.
#[derive(Clone, Copy)]
pub struct Observer<'a> {
    view: View<'a>,
    keeps_steps: bool,
    /// The clock that measures the rays; `None` for no times.
    clock: Option<&'a Clock>,
}

/// A ray to be traced.
struct Start {
    kind: RayKind,
    parent: Option<u32>,
    sample: u32,
    light: Option<u32>,
    bounce: u32,
    /// Length of the path before the ray.
    length: f32,
    ray: Ray,
    t_max: f32,
}

impl<'a> Observer<'a> {
    /// Creates an observer of the pixels of this sensor, which measures their rays with the clock,
    /// if there is one.
    pub fn new(tracer: Tracer<'a>, sensor: &Sensor, clock: Option<&'a Clock>) -> Self {
        Self {
            view: View::new(tracer, sensor),
            keeps_steps: true,
            clock,
        }
    }

    /// Omits the steps of the rays, which take most of the memory.
    pub fn without_steps(self) -> Self {
        Self {
            keeps_steps: false,
            ..self
        }
    }

    /// Returns the greatest number of samples of a pixel.
    pub(super) fn most_samples(&self) -> u32 {
        self.view.rounds.n_most()
    }

    /// Returns true if times are measured.
    pub(super) fn is_timed(&self) -> bool {
        self.clock.is_some()
    }

    /// Overwrites `tree` with the rays of the pixel in column `x` and row `y`; row 0 is on top.
    pub fn observe(&self, (x, y): (u32, u32), tree: &mut RayTree) {
        tree.clear();
        let mut sums = SampleSums::zero(0.0);
        let mut round = self.view.rounds.first();
        // Observe the samples, in rounds as in a rendering.
        while !round.is_empty() {
            for sample in round.clone() {
                let color = self.observe_sample((x, y), sample, tree);
                sums.add(self.view.limited(color.into()));
            }
            round = self.view.rounds.next(&sums, round.end);
        }
        for ray in &mut tree.rays {
            ray.contribution /= round.end as f32;
        }
    }

    /// Observes a sample; contributions are relative to it. Returns its color.
    fn observe_sample(&self, place: (u32, u32), sample: u32, tree: &mut RayTree) -> Vec3 {
        let camera_path = self.view.camera_path(place, sample);
        let eye = camera_path.ray.origin;
        let mut paths = vec![camera_path];
        let mut parents = vec![None];
        let (mut color, mut n_traced) = (Vec3::ZERO, 0);
        // Follow all paths of the sample, each ray after the ray that it continues.
        while let Some(&path) = paths.get(n_traced) {
            let start = Start {
                kind: path.kind,
                parent: parents[n_traced],
                sample,
                light: None,
                bounce: path.depth,
                length: path.length,
                ray: path.ray,
                t_max: f32::INFINITY,
            };
            // Trace the ray.
            n_traced += 1;
            let (number, hit) = self.trace(start, tree);
            // Shade its point, or add the background.
            match self.view.shader.met_in_fog(&path, hit) {
                Some(point) => {
                    if self.view.shader.is_particle(&point) {
                        tree.rays[number as usize].particle = Some(point.distance);
                    }
                    self.shade(eye, &path, number, &point, &mut paths, tree);
                }
                None => self.miss(&path, number, tree),
            }
            parents.resize(paths.len(), Some(number));
            color += tree.rays[number as usize].contribution;
        }
        color
    }

    /// Traces a ray for its nearest hit and adds it. Returns its index and the surface point.
    fn trace(&self, start: Start, tree: &mut RayTree) -> (u32, Option<SurfacePoint>) {
        let tracer = &self.view.tracer;
        let ray = start.ray;
        let (cost, time_ns, hit) =
            self.timed(|cost| tracer.trace_after(start.length, &ray, start.kind, cost));
        let record = |steps: &mut Vec<TraversalStep>| tracer.record(&ray, steps);
        (self.add(start, cost, time_ns, record, tree), hit)
    }

    /// Traces the shadow ray of a light sample and adds it. Returns its index, and true if it is
    /// occluded.
    fn trace_shadow(&self, parent: u32, sample: &LightSample, tree: &mut RayTree) -> (u32, bool) {
        let tracer = &self.view.tracer;
        let shadow = &sample.shadow;
        let from = &tree.rays[parent as usize];
        let start = Start {
            kind: RayKind::Shadow,
            parent: Some(parent),
            sample: from.sample,
            light: Some(sample.index),
            bounce: from.bounce,
            length: 0.0,
            ray: shadow.ray,
            t_max: shadow.t_max,
        };
        let (cost, time_ns, is_shadowed) = self.timed(|cost| tracer.is_shadowed(shadow, cost));
        let record = |steps: &mut Vec<TraversalStep>| tracer.record_shadow(shadow, steps);
        (self.add(start, cost, time_ns, record, tree), is_shadowed)
    }

    /// Shades the point that a ray hit; appends the rays that continue the path.
    fn shade(
        &self,
        eye: Vec3,
        path: &PathRay,
        number: u32,
        point: &SurfacePoint,
        next: &mut Vec<PathRay>,
        tree: &mut RayTree,
    ) {
        let shader = &self.view.shader;
        // Trace a shadow ray to each light.
        let mut lights: Vec<(Option<u32>, Illumination<f32>)> = Vec::new();
        for sample in shader.light_samples(path, point) {
            if !shader.casts_shadows() {
                lights.push((None, sample.light));
                continue;
            }
            let (shadow, is_shadowed) = self.trace_shadow(number, &sample, tree);
            if !is_shadowed {
                lights.push((Some(shadow), sample.light));
            }
        }
        // Shade the point by the lights that reach it.
        let all = || lights.iter().map(|(_, light)| *light);
        let (_, time_ns, color) = self.timed(|_| shader.shade(eye, path, point, all(), next));
        tree.rays[number as usize].time_ns += time_ns;
        tree.rays[number as usize].contribution = color;
        // Find the contribution of each light: the color without it.
        for left_out in lights.iter().filter_map(|(shadow, _)| *shadow) {
            let others = lights
                .iter()
                .filter(|(shadow, _)| *shadow != Some(left_out));
            let others = others.map(|(_, light)| *light);
            let without = shader.shade(eye, path, point, others, &mut Vec::new());
            tree.rays[left_out as usize].contribution = color - without;
        }
    }

    /// Adds the background that a ray sees; its path ends.
    fn miss(&self, path: &PathRay, number: u32, tree: &mut RayTree) {
        let (_, time_ns, color) = self.timed(|_| self.view.shader.miss(path));
        tree.rays[number as usize].time_ns += time_ns;
        tree.rays[number as usize].contribution = color;
    }

    /// Runs `work`. Returns its counters, its time in nanoseconds and its result.
    fn timed<T>(&self, work: impl FnOnce(&mut Cost) -> T) -> (Cost, f32, T) {
        let mut cost = Cost::default();
        let Some(clock) = self.clock else {
            let result = work(&mut cost);
            return (cost, 0.0, result);
        };
        let begin = clock.now();
        let result = work(&mut cost);
        let time_ns = clock.elapsed_ns(begin, clock.now());
        (cost, time_ns, result)
    }

    /// Adds a ray to the tree. Returns its index.
    fn add(
        &self,
        start: Start,
        cost: Cost,
        time_ns: f32,
        record: impl FnOnce(&mut Vec<TraversalStep>) -> Option<Hit>,
        tree: &mut RayTree,
    ) -> u32 {
        let first = tree.steps.len();
        let hit = record(&mut tree.steps);
        if !self.keeps_steps {
            tree.steps.truncate(first);
        }
        tree.rays.push(TracedRay {
            kind: start.kind,
            parent: start.parent,
            sample: start.sample,
            light: start.light,
            bounce: start.bounce,
            ray: start.ray,
            t_max: start.t_max,
            hit,
            particle: None,
            node_visits: cost.node_visits as u32,
            primitive_tests: cost.primitive_tests as u32,
            time_ns,
            contribution: Vec3::ZERO,
            steps: first..tree.steps.len(),
        });
        tree.rays.len() as u32 - 1
    }
}
