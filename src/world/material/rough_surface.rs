//! The microscopic facets of a surface.

use math::optics::{Albedo, AlbedoByRoughness, Ggx};
use math::simd::Real;

/// The facets of a surface, and their albedos if light reflected between facets counts.
#[derive(Debug, Clone, PartialEq)]
pub struct RoughSurface {
    /// The facets.
    pub(super) facets: Ggx,
    /// The albedo of a mirror with these facets.
    pub of_mirror: Option<Albedo>,
    /// The albedo of the surface of the medium with these facets.
    pub of_medium: Option<Albedo>,
    /// The albedo of mirrors of each roughness, if the roughness varies over the surface.
    pub by_roughness: Option<&'static AlbedoByRoughness>,
}

impl RoughSurface {
    /// Creates the surface of a material with these facets, without the light reflected between
    /// them.
    pub(super) fn losing(facets: Ggx) -> Self {
        Self {
            facets,
            of_mirror: None,
            of_medium: None,
            by_roughness: None,
        }
    }

    /// Creates the surface of a material with varying roughness, including the light reflected
    /// between facets; `facets` are the roughest ones.
    pub(super) fn varying(facets: Ggx) -> Self {
        Self {
            by_roughness: Some(AlbedoByRoughness::with_masking(facets.masking)),
            ..Self::losing(facets)
        }
    }

    /// Returns the facets, in each lane.
    #[inline(always)]
    pub fn facets<R: Real>(&self, like: R) -> Ggx<R> {
        Ggx {
            alpha: like.splat(self.facets.alpha),
            masking: self.facets.masking,
        }
    }

    /// Creates the surface of a material with these facets, including the light reflected between
    /// them; `index` is the index of refraction, if it is a medium.
    pub(super) fn new(facets: Ggx, index: Option<f32>) -> Self {
        Self {
            facets,
            of_mirror: Some(Albedo::tabulate_mirror(facets)),
            of_medium: index.map(|index| Albedo::tabulate_medium(facets, index)),
            by_roughness: None,
        }
    }
}
