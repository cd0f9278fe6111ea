//! `image.png`: the picture, with the geometry state inside.
//!
//! ParaView 5.12 and later opens a PNG as a state when its text chunk
//! `ParaViewState` holds one.

use std::io::{self, Write};

use super::file::{FileContent, OutputFile};
use super::states::States;
use crate::chart::png;
use crate::film::Film;
use crate::provenance::{self, RunId};

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: "image.png",
    is_wanted: |_| true,
    content: FileContent::Written(|job, out| write(job.rendering.film, job.run, job.states, out)),
};

/// Writes the film's colors with 8 bits per channel.
fn write(film: &Film, run: RunId, states: &States, out: &mut impl Write) -> io::Result<()> {
    let rows = film.rows(|strip| &strip.rgb).map(<[_]>::as_flattened);
    let rows: Vec<&[u8]> = rows.collect();
    let texts = [
        (provenance::KEY, &*run.to_string()),
        ("ParaViewState", &*states.geometry()),
    ];
    png::write([film.grid.width, film.grid.height], &rows, &texts, out)
}
