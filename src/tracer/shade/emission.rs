//! The light that surfaces emit toward the rays that hit them, and the background toward rays that
//! hit nothing.

use glam::Vec3;

use super::path_tracing::power_heuristic;
use super::paths::PathWave;
use crate::trace::{PointGroup, PointLanes, Points, ShadingPoint};
use math::simd::{InstructionSet, N_LANES, Real, SimdKernel, Vector, VectorColumn, set_lane};
use world::geometry::{N_PARAMETERS, Seen};
use world::material::Material;
use world::scene::{Emitter, Lights, Scene};

/// A ray that has hit a surface that emits light, or one per lane.
pub(super) struct Arrival<R> {
    /// The origin of the ray.
    pub(super) from: Vector<R>,
    /// The density with which the ray's direction was chosen.
    pub(super) density: R,
    pub(super) seen: Seen<R>,
    pub(super) shape: [R; N_PARAMETERS],
}

/// Returns the radiance that a material emits at a point, to the side that is seen.
#[inline(always)]
pub(super) fn emitted<R: Real>(material: &Material, at: &ShadingPoint<R>) -> Vector<R> {
    let side = at.side;
    let radiance = Vector::splat(side, material.emission).times(at.factors.emission);
    if material.two_sided {
        return radiance;
    }
    let none = Vector::splat(side, Vec3::ZERO);
    Vector::select(side.splat(0.0).lt(side), radiance, none)
}

/// Returns the weight of light from this emitter that a ray has found, when combined with light
/// samples.
#[inline(always)]
pub(super) fn weight<R: Real>(
    lights: &Lights,
    emitter: &Emitter,
    index: u32,
    arrival: &Arrival<R>,
) -> R {
    let Arrival {
        from,
        density,
        seen,
        shape,
    } = arrival;
    let of_light = emitter.density(shape, *from, seen) * lights.probability(index, *from);
    power_heuristic(*density, of_light)
}

/// Returns the radiance of the background that a ray finds, from a point in a direction that was
/// chosen with a density, weighted for its combination with light samples.
#[inline(always)]
pub(super) fn weighted_background<R: Real>(
    scene: &Scene,
    [from, direction]: [Vector<R>; 2],
    density: R,
) -> Vector<R> {
    let (background, lights) = (&scene.background, &scene.lights);
    let density = density.max(density.splat(f32::MIN_POSITIVE));
    let mut radiance = background.without_sun(direction);
    // The environment may also be found by light samples.
    if let Some((environment, index)) = lights.environment() {
        let of_light = environment.density(direction) * lights.probability(index, from);
        radiance = radiance * power_heuristic(density, of_light);
    }
    // The sun is added separately, with its own weight.
    let Some(sun) = background.sun() else {
        return radiance;
    };
    let of_light = match lights.sun() {
        Some(index) => sun.density(direction) * lights.probability(index, from),
        None => density.splat(0.0),
    };
    radiance + sun.radiance(direction) * power_heuristic(density, of_light)
}

/// Adds the light that surfaces emit to the radiance of points.
pub(super) struct AddEmission<'a> {
    pub(super) scene: &'a Scene,
    pub(super) wave: &'a PathWave,
    pub(super) points: &'a Points,
    pub(super) radiance: &'a mut VectorColumn,
}

impl SimdKernel for AddEmission<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) {
        for group in self.points.groups() {
            let material = self.scene.material(group.material);
            if !material.emits() {
                continue;
            }
            for at in group.lanes() {
                let before = self.radiance.load(set, at.first);
                let emitted = emitted(material, &self.points.shading(set, at));
                let weighted = emitted * self.weight(set, group, at);
                self.radiance.store(at.first, before + weighted);
            }
        }
    }
}

impl AddEmission<'_> {
    #[inline(always)]
    fn weight<I: InstructionSet>(&self, set: I, group: &PointGroup, at: PointLanes) -> I::Lanes {
        let emitter = self.scene.lights.emitter(group.material, group.shape);
        let Some((emitter, index)) = emitter.filter(|_| self.scene.scatters_paths()) else {
            return set.splat(1.0);
        };
        // Gather the rays' origins and the densities of their directions.
        let (mut from, mut density) = ([[0.0; N_LANES]; 3], [0.0; N_LANES]);
        for (lane, &ray) in self.points.rays(at).iter().enumerate() {
            set_lane(&mut from, lane, self.wave.rays.get(ray as usize).origin);
            density[lane] = self.wave.branches[ray as usize].density;
        }
        // Weight the light by the chance that a light sample finds it.
        let point = self.points.shading(set, at);
        let direction = self.points.directions(set, at);
        let arrival = Arrival {
            from: set.load_vector(&from),
            density: set.load(&density),
            seen: Seen {
                direction,
                distance: set.load(self.points.distances(at)),
                cos: -point.outward(point.geometric_normal).dot(direction),
            },
            shape: self.points.parameters(set, self.scene, at),
        };
        weight(&self.scene.lights, emitter, index, &arrival)
    }
}
