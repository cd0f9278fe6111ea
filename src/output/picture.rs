//! `image.png`: the picture, with the geometry state inside.
//!
//! ParaView 5.12 and later opens a PNG as a state when its text chunk
//! `ParaViewState` holds one.

use std::io::{self, Write};

use rayon::prelude::*;

use super::file::{FileContent, OutputFile};
use super::states::States;
use crate::chart::png;
use crate::config::Config;
use crate::film::{Film, STRIP_ROWS, Strip};
use crate::provenance::{self, RunId};

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: "image.png",
    is_wanted: |_| true,
    content: FileContent::Written(|job, out| {
        let film = job.rendering.film;
        if job.rendering.config.film.bits == 8 {
            let rows = film.rows(|strip| &strip.rgb).map(<[_]>::as_flattened);
            write(film, rows, job.run, job.states, out)
        } else {
            let developed = developed(film);
            let rows = developed.chunks_exact(film.grid.width as usize);
            write(
                film,
                rows.map(<[_]>::as_flattened),
                job.run,
                job.states,
                out,
            )
        }
    }),
};

/// A pixel of 16 bits per channel, the high byte first.
type Rgb16 = [u8; 6];

/// Upper bound of the memory to write a picture of 16 bits besides that of one of 8: the
/// picture, and as much again compressed.
pub(super) fn write_bytes(config: &Config) -> u64 {
    match config.film.bits {
        8 => 0,
        _ => (2 * size_of::<Rgb16>() * config.image.n_pixels()) as u64,
    }
}

/// The picture of a film that keeps its radiance.
fn developed(film: &Film) -> Vec<Rgb16> {
    let n_pixels = film.grid.width as usize * film.grid.height as usize;
    let mut pixels = vec![[0; 6]; n_pixels];
    let strips = pixels.par_chunks_mut(film.grid.width as usize * STRIP_ROWS as usize);
    let develop = |(places, strip): (&mut [Rgb16], &Strip)| {
        for (place, radiance) in places.iter_mut().zip(&strip.radiance) {
            let [r, g, b] = film.development.rgb16(*radiance).map(u16::to_be_bytes);
            *place = [r[0], r[1], g[0], g[1], b[0], b[1]];
        }
    };
    strips.zip(&film.strips).for_each(develop);
    pixels
}

/// Writes the rows of a picture of 8 or 16 bits per channel.
fn write<'a>(
    film: &Film,
    rows: impl Iterator<Item = &'a [u8]>,
    run: RunId,
    states: &States,
    out: &mut impl Write,
) -> io::Result<()> {
    let rows: Vec<&[u8]> = rows.collect();
    let texts = [
        (provenance::KEY, &*run.to_string()),
        ("ParaViewState", &*states.geometry()),
    ];
    png::write([film.grid.width, film.grid.height], &rows, &texts, out)
}
