//! Surface points → the rays of paths that continue in a random direction, in lanes.

use super::bsdf::{Boundary, Leaving, Scatters, sample};
use super::interfaces::Interfaces;
use super::media::Media;
use super::numbers::WaveNumbers;
use super::path_tracing::survival;
use super::paths::{Continued, PathWave};
use crate::cost::RayKind;
use crate::trace::{PointGroup, PointLanes, Points};
use math::simd::{Arithmetic, InstructionSet, Lanes, Mask, N_LANES, SimdKernel};
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
        let at_point = Leaving::new(point, -self.points.directions(set, at));
        let numbers = self.numbers.point_numbers(set, self.wave, rays);
        let [lobe, roulette] = numbers.lobe();
        let scattered = sample(
            self.scatter,
            &at_point,
            &boundary,
            numbers.direction(),
            lobe,
        );
        // Russian roulette: paths of little weight may end.
        let refracted = scattered.is_refracted.bits();
        let behind = interfaces.as_ref().map(|of| &of.behind);
        let before = self.wave.weights.gather(set, rays);
        let index = if self.scene.has_media() {
            set.load(&self.indices(rays, refracted, behind))
        } else {
            set.splat(1.0)
        };
        let probability = survival(before.times(scattered.factor), index, self.wave.depth);
        let alive = roulette.lt(probability).bits();
        // Collect the rays that continue the paths.
        let direction = scattered.direction;
        let continued = Continued {
            origin: point.origin(direction),
            direction,
            weight: before.times(scattered.factor * (set.splat(1.0) / probability)),
            rays,
            distances: self.points.distances(at),
            kinds: kinds(refracted, scattered.is_diffuse.bits()),
            densities: scattered.density.to_array(),
            media: behind,
        };
        self.next.bounce(set, &continued, self.wave, lanes & alive);
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
