//! The `tiles` section.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::keywords;
use world::values;

/// The division of the picture among threads. It changes neither the picture nor its counters.
///
/// ```
/// # use raycost_scene::config::{TileOrder, Tiling};
/// let tiling: Tiling = raycost_scene::yaml::from_str("
/// { size: 32, order: hilbert }
/// ").unwrap();
/// # assert_eq!(tiling, Tiling { size: 32, order: TileOrder::Hilbert });
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(
    deny_unknown_fields,
    default,
    expecting = "tiles such as { size: 32, order: hilbert }"
)]
pub struct Tiling {
    /// Side of a tile in pixels, 2 to 256; 16 if not given.
    #[serde(with = "values::Between::<{ Tiling::MIN_SIZE }, { Tiling::MAX_SIZE }>")]
    pub size: u32,
    /// The order in which threads take tiles.
    pub order: TileOrder,
}

keywords! {
    /// The order in which threads take tiles.
    #[derive(Default)]
    pub enum TileOrder {
        /// Row by row
        #[default]
        Scanline = "scanline",
        /// Along a Hilbert curve
        Hilbert = "hilbert",
        /// The most expensive first
        Cost = "cost",
    }
}

impl Tiling {
    /// Minimum side in pixels: the number of tiles of the largest picture then fits into 32 bits.
    pub const MIN_SIZE: u32 = 2;
    /// Maximum side in pixels.
    pub const MAX_SIZE: u32 = 256;
}

impl Default for Tiling {
    fn default() -> Self {
        Self {
            // Small enough to balance the load, large enough to fill a stream.
            size: 16,
            order: TileOrder::default(),
        }
    }
}
