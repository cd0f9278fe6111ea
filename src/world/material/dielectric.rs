//! Transparent media: glass, water, ice.

use glam::Vec3;
use serde::{Deserialize, Deserializer, Serialize};

use crate::values;

/// A smooth, clear medium inside a closed surface.
///
/// ```
/// # use world::material::Dielectric;
/// let glass: Dielectric = scene::yaml::from_str("
/// index: 1.5                    # of refraction
/// absorption: [0.1, 0.02, 0.1]  # per world unit: green in thick glass
/// priority: 1                   # where media overlap, the higher one counts
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, expecting = "a medium such as { index: 1.5 }")]
pub struct Dielectric {
    /// The index of refraction, from 1 (vacuum) to 10.
    #[serde(deserialize_with = "index")]
    pub index: f32,
    /// The absorption coefficient of each channel per world unit, at least 0: light is
    /// weakened by `exp(-absorption * distance)`, the law of Beer and Lambert.
    #[serde(deserialize_with = "values::radiance", default)]
    pub absorption: Vec3,
    /// Where media overlap, the one with the highest priority counts; of equal ones the one that
    /// the ray entered last.
    #[serde(deserialize_with = "values::byte", default)]
    pub priority: u8,
}

pub(super) fn index<'de, D: Deserializer<'de>>(d: D) -> Result<f32, D::Error> {
    values::within(d, 1.0..=10.0, "an index of refraction from 1 to 10")
}
