//! What a film keeps tile by tile.

use super::{Film, PackedCounters, Strip};
use crate::cost::Counter;
use crate::schedule::Tile;

/// Who rendered a tile, and what that cost.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RenderedTile {
    /// The thread that rendered it, from 0.
    pub thread: u32,
    /// What was counted of its pixels, some whole rows after the other from the
    /// top; nothing where nothing was counted.
    pub counters: Vec<PackedCounters>,
}

impl Film {
    /// One counter of the pixels of a strip of the film.
    pub fn counts(&self, strip: &Strip, counter: Counter) -> Vec<u32> {
        let mut counts = Vec::with_capacity(strip.rgb.len());
        for (tile, y) in self.tile_rows(strip) {
            let width = tile.width();
            let first = (y - tile.rows[0]) as usize * width;
            self.tiles[tile.number as usize].unpack(counter, first, width, &mut counts);
        }
        counts
    }

    /// All rays of the pixels of a strip of the film.
    pub fn rays(&self, strip: &Strip) -> Vec<u32> {
        let mut rays = vec![self.n_samples; strip.rgb.len()];
        for counter in [
            Counter::ShadowRays,
            Counter::ReflectionRays,
            Counter::RefractionRays,
        ] {
            for (rays, more) in rays.iter_mut().zip(self.counts(strip, counter)) {
                *rays = rays.saturating_add(more);
            }
        }
        rays
    }

    /// For each pixel of a strip of the film the number of its tile.
    pub fn tile_numbers(&self, strip: &Strip) -> Vec<i32> {
        self.by_tile(strip, |tile| tile as i32)
    }

    /// For each pixel of a strip of the film the thread that rendered it.
    pub fn threads(&self, strip: &Strip) -> Vec<i32> {
        self.by_tile(strip, |tile| self.tiles[tile as usize].thread as i32)
    }

    fn by_tile(&self, strip: &Strip, number: impl Fn(u32) -> i32) -> Vec<i32> {
        let mut numbers = Vec::with_capacity(strip.rgb.len());
        for (tile, _) in self.tile_rows(strip) {
            numbers.resize(numbers.len() + tile.width(), number(tile.number));
        }
        numbers
    }

    /// The rows of tiles that a strip consists of, in their order: which tile
    /// and which row of the film.
    fn tile_rows(&self, strip: &Strip) -> impl Iterator<Item = (Tile, u32)> {
        let rows = strip.first_row..strip.first_row + strip.n_rows;
        rows.flat_map(|y| self.grid.tiles_of_row(y).map(move |tile| (tile, y)))
    }
}

impl RenderedTile {
    /// Puts one counter of `n` pixels of a row at the end of `counts`.
    fn unpack(&self, counter: Counter, mut first: usize, n: usize, counts: &mut Vec<u32>) {
        for part in &self.counters {
            if first < part.n_pixels() {
                part.unpack(counter, first..first + n, counts);
                return;
            }
            first -= part.n_pixels();
        }
        // Nothing was counted.
        counts.resize(counts.len() + n, 0);
    }
}
