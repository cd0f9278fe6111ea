//! The ID of a run.

use rayon::prelude::*;

use super::RenderingView;
use crate::film::{Column, Strip, columns};
use crate::provenance::{Hasher, RunId};

/// Returns the ID of a rendering: a hash of its settings and of every array of
/// its film except `thread`, which varies from run to run.
pub(super) fn id_of(rendering: &RenderingView) -> RunId {
    let film = rendering.film;
    let columns: Vec<Column> = columns(film.cost, film.repeats)
        .filter(|column| column.name != "thread")
        .collect();
    let of_strip = |buffer: &mut Vec<u32>, strip: &Strip| {
        let mut hasher = Hasher::new();
        for column in &columns {
            hasher.add(column.bytes(film, strip, buffer));
        }
        hasher.checksum().bits()
    };
    let strips = film.strips.par_iter();
    let strips: Vec<u128> = strips.map_init(Vec::new, of_strip).collect();
    let asked = format!("{:?}", (rendering.scene_file, rendering.config));
    let mut hasher = Hasher::new();
    hasher.add(env!("CARGO_PKG_VERSION").as_bytes());
    hasher.add(asked.as_bytes());
    strips.iter().for_each(|sum| hasher.add(&sum.to_le_bytes()));
    hasher.checksum().into()
}
