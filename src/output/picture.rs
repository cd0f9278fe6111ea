//! `image.png`: the picture, with the geometry state inside.
//!
//! ParaView 5.12 and later opens a PNG as a state when its text chunk
//! `ParaViewState` holds one.

use std::io::{self, Write};

use super::rgb_png;
use super::run::{self, RunId};
use super::state::States;
use crate::film::Film;

/// Writes the film's colors, 8 bits a channel.
pub(super) fn write(
    film: &Film,
    run: RunId,
    states: &States,
    out: &mut impl Write,
) -> io::Result<()> {
    let rows = film.rows(|strip| &strip.rgb).map(<[_]>::as_flattened);
    let texts = [
        (run::KEY, &*run.to_string()),
        ("ParaViewState", &*states.geometry()),
    ];
    rgb_png::write([film.grid.width, film.grid.height], rows, &texts, out)
}
