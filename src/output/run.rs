//! The ID of a run.

use rayon::prelude::*;

use super::Rendering;
use crate::film::{Column, Strip, columns};
use crate::provenance::{RunId, Summer};

/// Returns the ID of a rendering: a hash of its settings and of every array of
/// its film except `thread`, which varies from run to run.
pub(super) fn id_of(rendering: &Rendering) -> RunId {
    let film = rendering.film;
    let columns: Vec<Column> = columns(film.cost, film.repeats)
        .filter(|column| column.name != "thread")
        .collect();
    let of_strip = |buffer: &mut Vec<u32>, strip: &Strip| {
        let mut summer = Summer::new();
        for column in &columns {
            summer.add(column.bytes(film, strip, buffer));
        }
        summer.checksum().bits()
    };
    let strips = film.strips.par_iter();
    let strips: Vec<u128> = strips.map_init(Vec::new, of_strip).collect();
    let asked = format!("{:?}", (rendering.scene_file, rendering.config));
    let mut summer = Summer::new();
    summer.add(env!("CARGO_PKG_VERSION").as_bytes());
    summer.add(asked.as_bytes());
    strips.iter().for_each(|sum| summer.add(&sum.to_le_bytes()));
    summer.checksum().into()
}
