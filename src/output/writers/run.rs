//! The ID of a run.

use rayon::prelude::*;

use super::RenderingView;
use host::provenance::{Hasher, RunId};
use render::film::{Column, Film, PackedCounters, RenderedTile, Strip};

/// Hashes of a film's content except for the threads, which vary from run to run: one hash per
/// strip, and one per row of tiles.
#[derive(Debug, Clone, Default)]
pub(super) struct PixelHashes {
    strips: Vec<u128>,
    tiles: Vec<u128>,
}

impl PixelHashes {
    /// Adds the hashes of a film, or of its next rows.
    pub(super) fn add(&mut self, film: &Film) {
        let stored: Vec<Column> = film.kept_columns().filter(Column::is_in_strips).collect();
        let of_strip = |strip: &Strip| {
            let mut hasher = Hasher::default();
            for column in &stored {
                hasher.add(column.bytes(film, strip, &mut Vec::new()));
            }
            hasher.checksum().bits()
        };
        // Packed counters are equal if the counts are.
        let of_tiles = |tiles: &[RenderedTile]| {
            let mut hasher = Hasher::default();
            let parts = tiles.iter().flat_map(|tile| &tile.counters);
            for bytes in parts.flat_map(PackedCounters::bytes) {
                hasher.add(bytes);
            }
            hasher.checksum().bits()
        };
        let strips = film.strips.par_iter().map(of_strip);
        self.strips.par_extend(strips);
        let tiles = film
            .tiles_of_rows()
            .par_chunks(film.grid.n_columns as usize);
        self.tiles.par_extend(tiles.map(of_tiles));
    }
}

/// Returns the ID of a rendering: a hash of its settings and of its pixels.
pub(super) fn id_of(rendering: &RenderingView) -> RunId {
    let PixelHashes { strips, tiles } = &rendering.survey.hashes;
    let time = rendering.frame.map(|frame| frame.time);
    let config = rendering.config.filled();
    let mut hasher = Hasher::default();
    hasher.add(env!("CARGO_PKG_VERSION").as_bytes());
    hasher.add_value(&(rendering.scene_file, &config, config.image.window, time));
    for sum in strips.iter().chain(tiles) {
        hasher.add(&sum.to_le_bytes());
    }
    hasher.checksum().into()
}
