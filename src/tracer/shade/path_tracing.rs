//! Path tracing: light samples at each point, and one direction to continue.
//!
//! Kajiya, "The Rendering Equation", SIGGRAPH 1986. Light that both a light sample and a scattered
//! ray may find is weighted by the power heuristic: Veach and Guibas, "Optimally Combining Sampling
//! Techniques for Monte Carlo Rendering", SIGGRAPH 1995.

use super::bsdf::{Boundary, Bsdf, Leaving, Scattering, Scatters, by_kind, evaluate};
use super::model::{Bounce, Model};
use crate::trace::ShadingPoint;
use math::simd::{Real, Vector};
use world::light::Illumination;
use world::material::Material;
use world::scene::Lights;

/// The path tracing model; see the module's documentation.
#[derive(Clone, Copy)]
pub(super) struct PathTracing;

impl Model for PathTracing {
    const BOUNCE: Bounce = Bounce::Scattered;

    fn is_lit(self, material: &Material) -> bool {
        by_kind!(Bsdf::new(material), |of| of.is_lit())
    }

    /// Returns 0 where the scattered ray is not traced.
    fn n_light_samples(self, lights: &Lights, depth: u32, max_depth: u32) -> usize {
        if depth < max_depth {
            lights.n_samples()
        } else {
            0
        }
    }

    #[inline(always)]
    fn may_arrive<R: Real>(
        self,
        material: &Material,
        point: &ShadingPoint<R>,
        light: &Illumination<R>,
    ) -> R::Mask {
        let zero = point.side.splat(0.0);
        let is_on = zero.lt(light.radiance.max_element());
        if by_kind!(Bsdf::new(material), |of| of.is_lit_from_all_sides()) {
            return is_on;
        }
        point.is_faced_by(light.direction) & is_on
    }

    #[inline(always)]
    fn reflected<R: Real>(
        self,
        material: &Material,
        boundary: &Boundary<R>,
        point: &ShadingPoint<R>,
        light: &Illumination<R>,
        to_viewer: Vector<R>,
    ) -> Vector<R> {
        let at = Leaving::new(*point, to_viewer);
        let Scattering { value, density } = by_kind!(Bsdf::new(material), |of| evaluate(
            of,
            &at,
            boundary,
            light.direction
        ));
        let weight = power_heuristic(light.density, density);
        value.times(light.radiance) * weight
    }
}

/// Returns the weight of a sample whose direction one method chose with density `own` and another
/// might have chosen with density `other`, by the power heuristic. The density of a method without
/// alternative is infinite.
#[inline(always)]
pub(super) fn power_heuristic<R: Real>(own: R, other: R) -> R {
    let one = own.splat(1.0);
    let ratio = other / own;
    one / (one + ratio * ratio)
}

/// Returns the probability that a path continues after `depth` bounces, if its ray would carry this
/// share of the light to the camera from a medium with this index of refraction.
///
/// Russian roulette: Arvo and Kirk, "Particle Transport and Image Synthesis", SIGGRAPH 1990. By the
/// square root of the share, as in Blender's Cycles: the variance decreases by more than the time
/// of the longer paths increases. The spread of light at the surfaces of media does not count.
#[inline(always)]
pub(super) fn survival<R: Real>(weight: Vector<R>, index: R, depth: u32) -> R {
    let (zero, one) = (index.splat(0.0), index.splat(1.0));
    let share = weight.max_element() * index * index;
    let by_share = share.sqrt().min(one);
    if depth < ROULETTE_DEPTH {
        R::select(zero.lt(share), one, by_share)
    } else {
        by_share
    }
}

/// Bounces after which paths may end early.
pub(super) const ROULETTE_DEPTH: u32 = 3;
