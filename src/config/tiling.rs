//! The `tiles` section.

use serde::{Deserialize, Deserializer, Serialize};

use crate::yaml;

/// How the picture is dealt out to the threads. The picture and its counters
/// are the same however that is done.
///
/// ```
/// # use raycost::config::{TileOrder, Tiling};
/// let tiling: Tiling = raycost::yaml::from_str("
/// { size: 32, order: hilbert }
/// ").unwrap();
/// # assert_eq!(tiling, Tiling { size: 32, order: TileOrder::Hilbert });
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(
    deny_unknown_fields,
    default,
    expecting = "tiles such as { size: 32, order: hilbert }"
)]
pub struct Tiling {
    /// Pixels along a tile's side, 2 to 256; 16 if not given.
    #[serde(deserialize_with = "size")]
    pub size: u32,
    /// In which order threads take them.
    pub order: TileOrder,
}

/// The order in which threads take tiles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, clap::ValueEnum)]
#[serde(
    rename_all = "snake_case",
    expecting = "`scanline`, `hilbert` or `cost`"
)]
pub enum TileOrder {
    /// Along rows, from the top left
    #[default]
    Scanline,
    /// Along a Hilbert curve, each tile a neighbour of the one before
    Hilbert,
    /// The most costly first, as a few rays through each tell
    Cost,
}

impl Tiling {
    /// Least pixels along a side: the largest picture then has no more tiles
    /// than 32-bit numbers.
    pub const MIN_SIZE: u32 = 2;
    /// Most pixels along a side.
    pub const MAX_SIZE: u32 = 256;
}

impl Default for Tiling {
    fn default() -> Self {
        Self {
            // Small enough to share out evenly, large enough to fill a stream.
            size: 16,
            order: TileOrder::default(),
        }
    }
}

impl TileOrder {
    /// The word of the scene file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scanline => "scanline",
            Self::Hilbert => "hilbert",
            Self::Cost => "cost",
        }
    }
}

fn size<'de, D: Deserializer<'de>>(d: D) -> Result<u32, D::Error> {
    yaml::whole(d, Tiling::MIN_SIZE..=Tiling::MAX_SIZE)
}
