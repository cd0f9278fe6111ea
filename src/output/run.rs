//! The ID of a run.

use rayon::prelude::*;

use super::RenderingView;
use crate::film::{Column, PackedCounters, RenderedTile, Strip};
use crate::provenance::{Hasher, RunId};

/// Tiles that are hashed by one task: some hundred kilobytes.
const TILES_PER_HASH: usize = 256;

/// Returns the ID of a rendering: a hash of its settings and of what its film stores,
/// except for the threads, which vary from run to run.
pub(super) fn id_of(rendering: &RenderingView) -> RunId {
    let film = rendering.film;
    let stored: Vec<Column> = film.columns().filter(Column::is_in_strips).collect();
    let of_strip = |strip: &Strip| {
        let mut hasher = Hasher::new();
        for column in &stored {
            hasher.add(column.bytes(film, strip, &mut Vec::new()));
        }
        hasher.checksum().bits()
    };
    // Packed counters are equal where the counts are.
    let of_tiles = |tiles: &[RenderedTile]| {
        let mut hasher = Hasher::new();
        let parts = tiles.iter().flat_map(|tile| &tile.counters);
        for bytes in parts.flat_map(PackedCounters::bytes) {
            hasher.add(bytes);
        }
        hasher.checksum().bits()
    };
    let strips = film.strips.par_iter().map(of_strip);
    let tiles = film.tiles.par_chunks(TILES_PER_HASH).map(of_tiles);
    let hashes: Vec<u128> = strips.chain(tiles).collect();
    let time = rendering.frame.map(|frame| frame.time);
    let asked = format!("{:?}", (rendering.scene_file, rendering.config, time));
    let mut hasher = Hasher::new();
    hasher.add(env!("CARGO_PKG_VERSION").as_bytes());
    hasher.add(asked.as_bytes());
    hashes.iter().for_each(|sum| hasher.add(&sum.to_le_bytes()));
    hasher.checksum().into()
}
