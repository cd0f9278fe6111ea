//! Ambient occlusion: the share of free space around a point.
//!
//! Zhukov, Iones and Kronin, "An Ambient Light Illumination Model", Rendering Techniques 1998. Each
//! sample of a pixel sends one ray, with a density proportional to the cosine of its angle with the
//! normal: the mean is the color times the share of the rays that hit nothing within a distance.
//! Paths end there.

use super::bsdf::Boundary;
use super::model::{Bounce, Model};
use crate::trace::ShadingPoint;
use math::simd::{Real, Vector};
use world::light::Illumination;
use world::material::Material;

/// The ambient occlusion model; see the module's documentation.
#[derive(Clone, Copy)]
pub(super) struct AmbientOcclusion;

impl Model for AmbientOcclusion {
    const BOUNCE: Bounce = Bounce::None;

    fn is_lit(self, _: &Material) -> bool {
        true
    }

    #[inline(always)]
    fn may_arrive<R: Real>(
        self,
        _: &Material,
        point: &ShadingPoint<R>,
        light: &Illumination<R>,
    ) -> R::Mask {
        point.is_faced_by(light.direction)
    }

    #[inline(always)]
    fn reflected<R: Real>(
        self,
        _: &Material,
        _: &Boundary<R>,
        point: &ShadingPoint<R>,
        light: &Illumination<R>,
        _: Vector<R>,
    ) -> Vector<R> {
        point.color.times(light.radiance)
    }
}
