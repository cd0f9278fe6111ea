//! `image.png`: the picture, with the geometry state inside.
//!
//! ParaView 5.12 and later opens a PNG as a state when its text chunk
//! `ParaViewState` holds one.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::ops::Range;

use image::RgbImage;
use rayon::prelude::*;

use super::RenderingView;
use super::file::{FileContent, OutputFile, WriterInput};
use super::state_files::SHOWN_OF_CLOUD;
use crate::chart::{self, ColorLegend, LegendKey, Scale, Swatch, draw_legends, png};
use host::folder::FileWriter;
use host::provenance::{self, RunId};
use render::film::{Film, STRIP_ROWS, Strip};
use world::color::rgb8;
use world::material::{ArrayScale, ArrayTexture};
use world::scene::Scene;

/// The file's name.
pub(super) const NAME: &str = "image.png";

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: NAME,
    is_wanted: |request| !request.is_stored,
    content: FileContent::Written(|job, out| write(job.rendering, &texts(job), out)),
};

/// Key and value of each text chunk.
pub(super) type Texts = [(&'static str, String)];

/// Writes the picture of a rendering whose film has all rows.
pub(super) fn write(
    rendering: &RenderingView,
    texts: &Texts,
    out: &mut FileWriter,
) -> io::Result<()> {
    let legends = collect_legends(rendering.scene);
    if !legends.is_empty() {
        return write_with_legends(rendering, &legends, texts, out);
    }
    let bits = rendering.config.film.bits;
    let write_rows = |rows: &mut dyn Write| write_rows(rendering.film, 0, bits, rows);
    write_png(rendering, bits, texts, out, write_rows)
}

/// Returns the text chunks of a picture in a folder with the other files of its run.
fn texts(job: &WriterInput) -> Vec<(&'static str, String)> {
    let written = job.rendering.film.extra.written;
    let state = written
        .has_all(&SHOWN_OF_CLOUD)
        .then(|| ("ParaViewState", job.states.geometry().to_string()));
    let mut texts = texts_of_run(job.rendering, job.run);
    texts.splice(1..1, state);
    texts
}

/// Returns the run's ID, and a comment if pixels are missing.
pub(super) fn texts_of_run(rendering: &RenderingView, run: RunId) -> Vec<(&'static str, String)> {
    let partial = rendering.partial.map(|partial| partial.to_string());
    let partial = partial.map(|partial| ("Comment", partial));
    let run = (provenance::KEY, run.to_string());
    [run].into_iter().chain(partial).collect()
}

/// Writes the pixels of a film as a picture without color bars and texts.
pub(crate) fn write_bare(film: &Film, bits: u8, out: &mut impl Write) -> io::Result<()> {
    let size = [film.grid.width, film.grid.height];
    let write_rows = |rows: &mut dyn Write| write_rows(film, 0, bits, rows);
    png::write(size, pixel_bytes(bits), &[], out, write_rows)
}

/// Returns the bytes of a pixel with this number of bits per channel.
fn pixel_bytes(bits: u8) -> usize {
    if bits == 8 { 3 } else { size_of::<Rgb16>() }
}

/// Writes the pixels of a film with 8 or 16 bits per channel, after the first `n_skipped` rows.
fn write_rows(film: &Film, n_skipped: usize, bits: u8, out: &mut dyn Write) -> io::Result<()> {
    if bits == 8 {
        let rows = film.rows(|strip| &strip.rgb).map(<[_]>::as_flattened);
        return (rows.skip(n_skipped)).try_for_each(|row| out.write_all(row));
    }
    let pixels = develop(film);
    out.write_all(pixels[n_skipped * film.grid.width as usize..].as_flattened())
}

/// Writes the picture of a film that comes in bands, from top to bottom: `for_each` calls its
/// argument with each band.
pub(super) fn write_bands(
    job: &WriterInput,
    out: &mut FileWriter,
    for_each: impl FnOnce(&mut dyn FnMut(&Film, Range<u32>) -> io::Result<()>) -> io::Result<()>,
) -> io::Result<()> {
    let legends = collect_legends(job.rendering.scene);
    if !legends.is_empty() {
        let grid = &job.rendering.film.grid;
        let mut picture = RgbImage::new(grid.width, grid.height);
        for_each(&mut |band, rows| {
            copy_rows(band, rows, &mut picture);
            Ok(())
        })?;
        draw_legends(&mut picture, &legends);
        let write_rows = |rows: &mut dyn Write| rows.write_all(&picture);
        return write_png(job.rendering, 8, &texts(job), out, write_rows);
    }
    let bits = job.rendering.config.film.bits;
    write_png(job.rendering, bits, &texts(job), out, |out| {
        for_each(&mut |band, rows| {
            let n_skipped = (rows.start - band.row_range().start) as usize;
            write_rows(band, n_skipped, bits, out)
        })
    })
}

/// Copies the rows of a film from this row to the last into the picture.
fn copy_rows(film: &Film, rows: Range<u32>, picture: &mut RgbImage) {
    let row_bytes = 3 * film.grid.width as usize;
    let skipped = (rows.start - film.row_range().start) as usize;
    let from = film.rows(|strip| &strip.rgb).map(<[_]>::as_flattened);
    let into = picture
        .chunks_exact_mut(row_bytes)
        .skip(rows.start as usize);
    for (into, row) in into.zip(from.skip(skipped)) {
        into.copy_from_slice(row);
    }
}

/// A pixel of 16 bits per channel, big-endian.
type Rgb16 = [u8; 6];

/// Returns the color bars of the scene's materials, each once.
fn collect_legends(scene: &Scene) -> Vec<ColorLegend> {
    let mut legends = Vec::new();
    let materials = scene.materials.iter();
    for array in materials.filter_map(|material| material.color.array()) {
        let Some(title) = &array.bar else { continue };
        let legend = ColorLegend {
            title: title.clone(),
            key: key(array),
        };
        if !legends.contains(&legend) {
            legends.push(legend);
        }
    }
    legends
}

/// Returns the legend of an array's colors.
fn key(array: &ArrayTexture) -> LegendKey {
    let Some(n_colors) = array.map.n_categories() else {
        let scale = match array.scale {
            ArrayScale::Linear => Scale::Linear,
            ArrayScale::Log => Scale::Logarithmic,
        };
        return LegendKey::Range {
            map: array.map.clone(),
            range: chart::Range::between(scale, array.table.ends, array.table.clips),
        };
    };
    let labeled = 0..array.labels.len() as i64;
    let present = array.table.categories.iter().copied();
    let all: BTreeSet<i64> = labeled.chain(present).collect();
    let swatch = |category: i64| {
        let label = usize::try_from(category).ok();
        let label = label.and_then(|i| array.labels.get(i)).cloned();
        let turn = category.rem_euclid(n_colors as i64) as f64;
        let color = array.map.at((turn + 0.5) / n_colors as f64);
        Swatch {
            label: label.unwrap_or_else(|| category.to_string().replace('-', "−")),
            color: rgb8(color),
        }
    };
    LegendKey::Categories(all.into_iter().map(swatch).collect())
}

/// Writes the picture with color bars.
fn write_with_legends(
    rendering: &RenderingView,
    legends: &[ColorLegend],
    texts: &Texts,
    out: &mut FileWriter,
) -> io::Result<()> {
    let film = rendering.film;
    let (width, height) = (film.grid.width, film.grid.height);
    let mut picture = RgbImage::new(width, height);
    copy_rows(film, film.row_range(), &mut picture);
    draw_legends(&mut picture, legends);
    if rendering.config.film.bits == 8 {
        return write_png(rendering, 8, texts, out, |rows| rows.write_all(&picture));
    }
    let mut developed = develop(film);
    let before = film.rows(|strip| &strip.rgb).flatten();
    let (drawn, _) = picture.as_chunks::<3>();
    for ((place, before), drawn) in developed.iter_mut().zip(before).zip(drawn) {
        if before != drawn {
            // Scale by 257, which keeps the brightness at 16 bits.
            let [r, g, b] = *drawn;
            *place = [r, r, g, g, b, b];
        }
    }
    let write_rows = |rows: &mut dyn Write| rows.write_all(developed.as_flattened());
    write_png(rendering, 16, texts, out, write_rows)
}

/// Develops the picture of a film that keeps its radiance.
fn develop(film: &Film) -> Vec<Rgb16> {
    let n_pixels = film.grid.width as usize * film.row_range().len();
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

/// Writes the picture with this number of bits per channel; `write_rows` writes the bytes of all
/// rows.
fn write_png(
    rendering: &RenderingView,
    bits: u8,
    texts: &Texts,
    out: &mut impl Write,
    write_rows: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let texts: Vec<_> = texts.iter().map(|(key, text)| (*key, &**text)).collect();
    let grid = &rendering.film.grid;
    let size = [grid.width, grid.height];
    png::write(size, pixel_bytes(bits), &texts, out, write_rows)
}
