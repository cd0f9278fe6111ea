//! Surface points → the rays of paths that continue in a random direction, in lanes.

use super::bsdf::{Boundary, Leaving, Scatters, sample};
use super::interfaces::Interfaces;
use super::media::Media;
use super::numbers::{PointNumbers, WaveNumbers};
use super::path_tracing::survival;
use super::paths::{Continued, PathWave};
use crate::cost::RayKind;
use crate::trace::{PointGroup, PointLanes, Points, ShadingPoint};
use math::simd::{InstructionSet, Lanes, Mask, N_LANES, Real, SimdKernel, Vector};
use world::scene::Scene;

/// Collects the scattered rays of the points of a group.
pub(super) struct ScatterPaths<'a, S> {
    pub(super) scene: &'a Scene,
    /// How the points of the group scatter light.
    pub(super) scatter: S,
    pub(super) group: PointGroup,
    pub(super) numbers: WaveNumbers<'a>,
    pub(super) points: &'a Points,
    pub(super) wave: &'a PathWave,
    pub(super) next: &'a mut PathWave,
}

impl<S: Scatters> SimdKernel for ScatterPaths<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(mut self, set: I) {
        let material = self.scene.material(self.group.material);
        for at in self.group.lanes() {
            let lanes = at.bits() & self.points.scattering_sides(set, at, material);
            self.scatter(set, at, lanes);
        }
    }
}

impl<S: Scatters> ScatterPaths<'_, S> {
    /// Collects the scattered rays of these lanes.
    #[inline(always)]
    fn scatter<I: InstructionSet>(&mut self, set: I, at: PointLanes, lanes: u8) {
        // Find the boundaries of media that the rays met.
        let material = self.group.material;
        let point = self.points.shading(set, at);
        let rays = self.points.rays(at);
        let is_medium = self.scene.material(material).kind.medium().is_some();
        let interfaces = if is_medium {
            let flipped = point.side.signs();
            let met = Interfaces::met(self.scene, self.wave, material, rays, flipped);
            Some(met)
        } else {
            None
        };
        let boundary = match &interfaces {
            None => Boundary::without_medium(set.splat(1.0)),
            Some(interfaces) => interfaces.boundary(set),
        };
        // Sample a direction for each point.
        let numbers = self.numbers.point_numbers(set, self.wave, rays);
        let before = self.wave.weights.gather(set, rays);
        let behind = interfaces.as_ref().map(|of| &of.behind);
        let continuation = Continuation::sample(
            self.scatter,
            &point,
            self.points.directions(set, at),
            &boundary,
            &numbers,
            before,
        );
        // Russian roulette: paths of little weight may end.
        let refracted = continuation.is_refracted.bits();
        let index = if self.scene.has_media() {
            set.load(&self.indices(rays, refracted, behind))
        } else {
            set.splat(1.0)
        };
        let (alive, weight) = continuation.survive(index, self.wave.depth);
        // Collect the rays that continue the paths.
        let continued = Continued {
            origin: continuation.origin,
            direction: continuation.direction,
            weight,
            rays,
            distances: self.points.distances(at),
            kinds: kinds(refracted, continuation.is_diffuse.bits()),
            densities: continuation.density.to_array(),
            media: behind,
        };
        self.next
            .bounce(set, &continued, self.wave, lanes & alive.bits());
    }

    /// Returns the indices of refraction where the scattered rays are.
    #[inline(always)]
    fn indices(
        &self,
        rays: &[u32; N_LANES],
        refracted: u8,
        behind: Option<&[Media; N_LANES]>,
    ) -> [f32; N_LANES] {
        let mut indices = [1.0; N_LANES];
        for (lane, &ray) in rays.iter().enumerate() {
            let media = match behind {
                Some(behind) if refracted >> lane & 1 != 0 => behind[lane],
                _ => self.wave.branches[ray as usize].media,
            };
            indices[lane] = media.index(&self.scene.materials);
        }
        indices
    }
}

/// A ray that continues a path in a direction chosen at random, or one per lane.
pub(super) struct Continuation<R: Real> {
    pub(super) origin: Vector<R>,
    pub(super) direction: Vector<R>,
    /// The density with which the direction was chosen.
    pub(super) density: R,
    pub(super) is_refracted: R::Mask,
    pub(super) is_diffuse: R::Mask,
    /// The weight of the path before.
    before: Vector<R>,
    /// The share of the light from the direction.
    factor: Vector<R>,
    roulette: R,
}

impl<R: Real> Continuation<R> {
    /// Samples a direction at a point, for paths of this weight.
    #[inline(always)]
    pub(super) fn sample(
        scatter: impl Scatters,
        point: &ShadingPoint<R>,
        arriving: Vector<R>,
        boundary: &Boundary<R>,
        numbers: &PointNumbers<R::Integer>,
        before: Vector<R>,
    ) -> Self {
        let at = Leaving::new(*point, -arriving);
        let [lobe, roulette] = numbers.lobe();
        let scattered = sample(scatter, &at, boundary, numbers.direction(), lobe);
        Self {
            origin: point.origin(scattered.direction),
            direction: scattered.direction,
            density: scattered.density,
            is_refracted: scattered.is_refracted,
            is_diffuse: scattered.is_diffuse,
            before,
            factor: scattered.factor,
            roulette,
        }
    }

    /// Ends paths of little weight by Russian roulette, in media of this index of refraction, after
    /// this number of bounces. Returns true if the path continues, and its weight.
    #[inline(always)]
    pub(super) fn survive(&self, index: R, depth: u32) -> (R::Mask, Vector<R>) {
        let Self {
            before,
            factor,
            roulette,
            ..
        } = *self;
        let probability = survival(before.times(factor), index, depth);
        let weight = before.times(factor * (index.splat(1.0) / probability));
        (roulette.lt(probability), weight)
    }
}

/// Returns the kinds of rays by bits of lanes.
#[inline(always)]
fn kinds(refracted: u8, diffuse: u8) -> [RayKind; N_LANES] {
    let mut kinds = [RayKind::Reflection; N_LANES];
    for (lane, kind) in kinds.iter_mut().enumerate() {
        *kind = scattered_kind(refracted >> lane & 1 != 0, diffuse >> lane & 1 != 0);
    }
    kinds
}

/// Returns the kind of a scattered ray.
#[inline(always)]
pub(super) fn scattered_kind(is_refracted: bool, is_diffuse: bool) -> RayKind {
    if is_refracted {
        RayKind::Refraction
    } else if is_diffuse {
        RayKind::Diffuse
    } else {
        RayKind::Reflection
    }
}
