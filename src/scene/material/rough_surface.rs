//! The microscopic facets of a surface.

use math::optics::{Albedo, AlbedoByRoughness, Ggx};
use math::simd::Real;

/// The facets of a surface, and how much light they return, if light that is reflected from
/// facet to facet counts.
#[derive(Debug, Clone, PartialEq)]
pub struct RoughSurface {
    /// The facets.
    pub(super) facets: Ggx,
    /// The albedo of a mirror with these facets.
    pub of_mirror: Option<Albedo>,
    /// The albedo of the surface of the medium with these facets.
    pub of_medium: Option<Albedo>,
    /// The albedo of mirrors of each roughness, if that varies over the surface.
    pub by_roughness: Option<&'static AlbedoByRoughness>,
}

impl RoughSurface {
    /// The surface of a material with these facets that loses light between them.
    pub(super) fn losing(facets: Ggx) -> Self {
        Self {
            facets,
            of_mirror: None,
            of_medium: None,
            by_roughness: None,
        }
    }

    /// The surface of a material whose roughness varies, that loses no light. These are the
    /// roughest facets.
    pub(super) fn varying(facets: Ggx) -> Self {
        Self {
            by_roughness: Some(AlbedoByRoughness::of_mirrors(facets.masking)),
            ..Self::losing(facets)
        }
    }

    /// The facets, in each lane.
    #[inline(always)]
    pub fn facets<R: Real>(&self, like: R) -> Ggx<R> {
        Ggx {
            alpha: like.splat(self.facets.alpha),
            masking: self.facets.masking,
        }
    }

    /// The surface of a material with these facets, of a medium with an index of
    /// refraction or of none, that loses no light.
    pub(super) fn new(facets: Ggx, index: Option<f32>) -> Self {
        Self {
            facets,
            of_mirror: Some(Albedo::of_mirror(facets)),
            of_medium: index.map(|index| Albedo::of_medium(facets, index)),
            by_roughness: None,
        }
    }
}
