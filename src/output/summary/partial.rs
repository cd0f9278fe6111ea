//! The section on the missing parts of a rendering.

use std::fmt;

use serde::{Deserialize, Serialize};

use base::numbers::count;

/// The missing parts of a rendering that ended before it was complete.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Partial {
    /// The number of tiles that were not rendered: their pixels are black, without hits and without
    /// cost.
    pub n_missing_tiles: u64,
    /// The number of all tiles.
    pub n_tiles: u64,
    /// The number of times that the picture was rendered.
    pub n_renderings: u8,
    /// The number of times that the picture was to be rendered.
    pub n_renderings_asked: u8,
}

impl Partial {
    /// Returns the missing parts, given the finished and all tiles, and the finished and all
    /// renderings; `None` if nothing is missing.
    pub fn new(tiles: [u32; 2], renderings: [u8; 2]) -> Option<Self> {
        let this = Self {
            n_missing_tiles: (tiles[1] - tiles[0]).into(),
            n_tiles: tiles[1].into(),
            n_renderings: renderings[0],
            n_renderings_asked: renderings[1],
        };
        let is_whole = this.n_missing_tiles == 0 && renderings[0] >= renderings[1];
        (!is_whole).then_some(this)
    }
}

impl fmt::Display for Partial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.n_missing_tiles {
            0 => write!(
                f,
                "partial: {} of {} renderings",
                self.n_renderings, self.n_renderings_asked
            ),
            n => write!(
                f,
                "partial: {} of {} tiles are missing",
                count(n),
                count(self.n_tiles)
            ),
        }
    }
}
