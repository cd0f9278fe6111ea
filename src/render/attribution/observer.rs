//! The observation of a pixel.

use std::collections::VecDeque;
use std::iter::repeat_n;

use glam::Vec3;

use crate::attribution::{RayTree, TracedRay};
use crate::tiles::{PathProbe, Rounds, View, follow, rounds_of, with_samples_planned};
use scene::build::Sensor;
use tracer::accel::{Hit, TraversalStep};
use tracer::cost::{Clock, Cost, RayKind};
use tracer::shade::{LightSample, PathRay};
use tracer::trace::{SurfacePoint, Tracer};
use world::light::Illumination;

/// Renders pixels and records their rays.
#[derive(Clone, Copy)]
pub struct PathObserver<'a> {
    view: View<'a>,
    keeps_steps: bool,
    /// The clock that measures the rays; `None` for no times.
    clock: Option<&'a Clock>,
}

impl<'a> PathObserver<'a> {
    /// Creates an observer of the pixels of this sensor, which measures their rays with the clock,
    /// if there is one. If efficiency decides about samples, unless the sensor knows how, probes some
    /// pixels on the current rayon pool.
    pub fn new(tracer: Tracer<'a>, sensor: &Sensor, clock: Option<&'a Clock>) -> Self {
        Self {
            view: View::new(tracer, &with_samples_planned(tracer, sensor)),
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

    /// Overwrites `tree` with the rays of the pixel at a place: column and row, row 0 on top.
    pub fn observe(&self, place: (u32, u32), tree: &mut RayTree) {
        self.observe_rounds(place, &rounds_of(self.view, place), tree);
    }

    /// Overwrites `tree` with the rays of this number of samples of the pixel at a place.
    pub(super) fn observe_samples(&self, place: (u32, u32), n: u32, tree: &mut RayTree) {
        self.observe_rounds(place, &self.view.rounds.with_samples(n), tree);
    }

    fn observe_rounds(&self, place: (u32, u32), rounds: &Rounds, tree: &mut RayTree) {
        tree.clear();
        let mut recorder = RayRecorder {
            observer: self,
            tree,
            number: 0,
            parents: VecDeque::new(),
        };
        let (_, n_samples) = follow(&self.view, rounds, place, &mut Vec::new(), &mut recorder);
        for ray in &mut tree.rays {
            ray.contribution /= n_samples as f32;
        }
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
}

/// Records the rays of a pixel; contributions are relative to a sample.
struct RayRecorder<'a> {
    observer: &'a PathObserver<'a>,
    tree: &'a mut RayTree,
    /// Index of the path's ray that was traced last.
    number: u32,
    /// The indices of the rays that those still to be traced continue.
    parents: VecDeque<u32>,
}

impl PathProbe for RayRecorder<'_> {
    fn trace(&mut self, path: &PathRay) -> Option<SurfacePoint> {
        let tracer = &self.observer.view.tracer;
        let ray = path.ray;
        let traced = TracedRay {
            kind: path.kind,
            parent: self.parents.pop_front(),
            sample: path.id.sample,
            light: None,
            bounce: path.depth,
            ray,
            t_max: f32::INFINITY,
            hit: None,
            particle: None,
            node_visits: 0,
            primitive_tests: 0,
            time_ns: 0.0,
            contribution: Vec3::ZERO,
            steps: 0..0,
        };
        let trace = |cost: &mut Cost| tracer.trace_after(path.length, &ray, path.kind, cost);
        let (cost, time_ns, hit) = self.observer.timed(trace);
        self.number = self.add(traced, cost, time_ns, |steps| tracer.record(&ray, steps));
        hit
    }

    fn shade(
        &mut self,
        eye: Vec3,
        path: &PathRay,
        met: Option<&SurfacePoint>,
        next: &mut Vec<PathRay>,
    ) -> Vec3 {
        let (number, shader) = (self.number, &self.observer.view.shader);
        // Trace a shadow ray to each light.
        let mut lights: Vec<(Option<u32>, Illumination<f32>)> = Vec::new();
        for sample in met
            .into_iter()
            .flat_map(|at| shader.light_samples(path, at))
        {
            if !shader.casts_shadows() {
                lights.push((None, sample.light));
                continue;
            }
            let (shadow, share) = self.trace_shadow(&sample);
            let arriving = sample.light.weakened_to(share);
            lights.extend(arriving.map(|light| (Some(shadow), light)));
        }
        // Shade the point by the lights that reach it, or add the background.
        let shade = |left_out: Option<u32>, next: &mut Vec<PathRay>| {
            let Some(point) = met else {
                return shader.miss(path);
            };
            let is_used = |shadow: &Option<u32>| left_out.is_none() || *shadow != left_out;
            let used = lights.iter().filter(|(shadow, _)| is_used(shadow));
            shader.shade(eye, path, point, used.map(|(_, light)| *light), next)
        };
        let n_before = next.len();
        let (_, time_ns, color) = self.observer.timed(|_| shade(None, next));
        let ray = &mut self.tree.rays[number as usize];
        ray.time_ns += time_ns;
        ray.contribution = color;
        let particle = met.filter(|point| shader.is_particle(point));
        ray.particle = particle.map(|point| point.distance);
        self.parents.extend(repeat_n(number, next.len() - n_before));
        // Find the contribution of each light: the color without it.
        for shadow in lights.iter().filter_map(|(shadow, _)| *shadow) {
            let without = shade(Some(shadow), &mut Vec::new());
            self.tree.rays[shadow as usize].contribution = color - without;
        }
        color
    }
}

impl RayRecorder<'_> {
    /// Traces the shadow ray of a light sample and adds it. Returns its index, and the share of
    /// light that passes.
    fn trace_shadow(&mut self, sample: &LightSample) -> (u32, f32) {
        let tracer = &self.observer.view.tracer;
        let shadow = &sample.shadow;
        let traced = TracedRay {
            kind: RayKind::Shadow,
            parent: Some(self.number),
            light: Some(sample.index),
            ray: shadow.ray,
            t_max: shadow.t_max,
            particle: None,
            contribution: Vec3::ZERO,
            ..self.tree.rays[self.number as usize].clone()
        };
        let trace = |cost: &mut Cost| tracer.light_along(shadow, cost);
        let (cost, time_ns, share) = self.observer.timed(trace);
        let record = |steps: &mut Vec<TraversalStep>| tracer.record_shadow(shadow, steps);
        (self.add(traced, cost, time_ns, record), share)
    }

    /// Adds a ray to the tree with its hit and its cost. Returns its index.
    fn add(
        &mut self,
        mut ray: TracedRay,
        cost: Cost,
        time_ns: f32,
        record: impl FnOnce(&mut Vec<TraversalStep>) -> Option<Hit>,
    ) -> u32 {
        let RayTree { rays, steps } = &mut *self.tree;
        let first = steps.len();
        ray.hit = record(steps);
        if !self.observer.keeps_steps {
            steps.truncate(first);
        }
        ray.steps = first..steps.len();
        ray.node_visits = cost.node_visits as u32;
        ray.primitive_tests = cost.primitive_tests as u32;
        ray.time_ns = time_ns;
        rays.push(ray);
        rays.len() as u32 - 1
    }
}
