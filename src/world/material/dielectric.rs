//! Transparent media: glass, water, ice.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::kinds;
use crate::values::{self, Number};

/// A smooth, clear medium inside a closed surface.
///
/// ```
/// # use raycost_world::material::Dielectric;
/// let glass: Dielectric = scene::yaml::from_str("
/// index: 1.5                    # of refraction
/// absorption: [0.1, 0.02, 0.1]  # per world unit: green in thick glass
/// priority: 1                   # where media overlap, the higher one counts
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(deny_unknown_fields, expecting = "a medium such as { index: 1.5 }")]
pub struct Dielectric {
    /// The index of refraction: 1.33 for water, 1.5 for glass.
    #[serde(with = "Index")]
    pub index: f32,
    /// The absorption coefficient of each channel per world unit, by the law of Beer and Lambert.
    #[serde(with = "values::Radiance", default)]
    pub absorption: Vec3,
    /// Where media overlap, the highest priority counts.
    #[serde(with = "values::Byte", default)]
    pub priority: u8,
}

kinds! {
    /// An index of refraction.
    pub(super) Index: f32 = Number { expected: "an index of refraction from 1 to 10", ranges: &[[1.0, 10.0]] };
}
