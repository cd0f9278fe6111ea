//! The optional output `lanes`.

use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{DeserializeSeed, Deserializer, Error, Unexpected, Visitor};
use serde::{Deserialize, Serialize};

use base::keywords;
use world::values;

/// The warps that the array `idle_lanes` is computed for.
///
/// ```
/// # use raycost_scene::config::{RayOrder, Warps};
/// let warps: Warps = raycost_scene::yaml::from_str("
/// { warp: 16, order: morton }
/// ").unwrap();
/// # assert_eq!(warps, Warps { warp: 16, order: RayOrder::Morton });
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Warps {
    /// Lanes of a warp; 32 if not given.
    #[serde(with = "WarpSize")]
    pub warp: u32,
    /// The order in which rays fill warps.
    pub order: RayOrder,
}

keywords! {
    /// The order in which rays fill warps.
    #[derive(Default)]
    pub enum RayOrder {
        /// Row by row
        Rows = "rows",
        /// In tiles of 8 x 4 pixels
        #[default]
        Tiles = "tiles",
        /// Along a Morton curve
        Morton = "morton",
        /// As raycost's waves hold pixels: tile by tile, in blocks of 4 x 4
        Waves = "waves",
        /// By the signs of the direction, then as in `tiles`
        Octant = "octant",
        /// By the material that it starts from, then as in `tiles`
        Material = "material",
    }
}

impl Warps {
    /// The possible numbers of lanes of a warp.
    pub const SIZES: [u32; 4] = [8, 16, 32, 64];
}

impl Default for Warps {
    fn default() -> Self {
        Self {
            warp: 32,
            order: RayOrder::default(),
        }
    }
}

world::kinds! {
    WarpSize: u32 = WarpForm;
}

/// One of [`Warps::SIZES`].
struct WarpForm;

impl<'de> DeserializeSeed<'de> for WarpForm {
    type Value = u32;

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<u32, D::Error> {
        d.deserialize_any(self)
    }
}

impl Visitor<'_> for WarpForm {
    type Value = u32;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("8, 16, 32 or 64 lanes")
    }

    fn visit_u64<E: Error>(self, found: u64) -> Result<u32, E> {
        let mut sizes = Warps::SIZES.into_iter();
        let size = sizes.find(|&size| u64::from(size) == found);
        size.ok_or_else(|| E::invalid_value(Unexpected::Unsigned(found), &self))
    }
}

impl values::Form for WarpForm {
    fn schema(&self, _: &mut SchemaGenerator) -> Schema {
        json_schema!({ "enum": Warps::SIZES, "expected": "8, 16, 32 or 64 lanes" })
    }
}
