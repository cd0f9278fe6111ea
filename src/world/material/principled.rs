//! The principled material: few keys for most surfaces.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::dielectric::{Dielectric, Index};
use crate::values;
use math::optics::{Ggx, Masking};

/// The scattering of a surface of one color: as a metal, as a diffuse surface with a clear coat, as
/// a clear medium, or in between. For path tracing.
///
/// ```
/// # use raycost_world::material::Principled;
/// let plastic: Principled = scene::yaml::from_str("{ roughness: 0.3 }").unwrap();
/// let frosted: Principled = scene::yaml::from_str("
/// metallic: 0        # 0, no metal, to 1
/// roughness: 0.4     # 0, polished, to 1
/// transmission: 1    # 0, opaque, to 1, clear; not for metals
/// index: 1.45        # of refraction, of the coat and of the medium
/// ").unwrap();
/// # assert_eq!((plastic.metallic, frosted.index), (0.0, 1.45));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(
    deny_unknown_fields,
    expecting = "a principled surface such as { metallic: 1, roughness: 0.3 }"
)]
pub struct Principled {
    /// The share of metal, 0 to 1: it mirrors in the color. 0 by default.
    #[serde(default, with = "values::Fraction")]
    pub metallic: f32,
    /// The roughness, 0 to 1; 0.5 by default.
    #[serde(default = "values::half", with = "values::Fraction")]
    pub roughness: f32,
    /// The share of the rest that lets light through, in the color. 0 by default.
    #[serde(default, with = "values::Fraction")]
    pub transmission: f32,
    /// The index of refraction of the coat and of the medium, 1 to 10; 1.5 by default.
    #[serde(default = "glass", with = "Index")]
    pub index: f32,
}

fn glass() -> f32 {
    1.5
}

impl Principled {
    /// Returns the medium inside the surface, if the surface transmits light.
    pub(super) fn medium(&self) -> Option<Dielectric> {
        (self.transmission > 0.0 && self.metallic < 1.0).then_some(Dielectric {
            index: self.index,
            absorption: Vec3::ZERO,
            priority: 0,
        })
    }

    /// Returns the facets of the metal and of the coat, which are never perfectly smooth.
    pub fn facets(&self, masking: Masking) -> Ggx {
        Ggx::never_smooth(self.roughness, masking)
    }
}
