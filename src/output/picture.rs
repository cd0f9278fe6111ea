//! `image.png`: the picture, with the geometry state inside.
//!
//! ParaView 5.12 and later opens a PNG as a state when its text chunk
//! `ParaViewState` holds one.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::ops::Range;

use image::RgbImage;
use rayon::prelude::*;

use super::file::{FileContent, Job, OutputFile};
use super::state_files::SHOWN_OF_CLOUD;
use crate::chart::png::{self, PngWriter};
use crate::chart::{ColorLegend, LegendKey, Scale, Swatch, draw_legends};
use crate::color::rgb8;
use crate::config::Config;
use crate::film::{Film, STRIP_ROWS, Strip};
use crate::folder::FileWriter;
use crate::material::{ArrayScale, ArrayTexture};
use crate::provenance;
use crate::scene::Scene;

/// The file's name.
pub(super) const NAME: &str = "image.png";

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: NAME,
    is_wanted: |request| !request.is_stored,
    content: FileContent::Written(|job, out| {
        let film = job.rendering.film;
        let legends = legends(job.rendering.scene);
        if !legends.is_empty() {
            write_with_legends(job, &legends, out)
        } else if job.rendering.config.film.bits == 8 {
            let rows = film.rows(|strip| &strip.rgb).map(<[_]>::as_flattened);
            write(job, rows, out)
        } else {
            write_developed(job, &developed(film), out)
        }
    }),
};

/// Writes the pixels of a film as a picture without color bars and texts.
pub(crate) fn write_bare(film: &Film, bits: u8, out: &mut impl Write) -> io::Result<()> {
    let size = [film.grid.width, film.grid.height];
    if bits == 8 {
        let rows = film.rows(|strip| &strip.rgb).map(<[_]>::as_flattened);
        return png::write(size, &rows.collect::<Vec<_>>(), &[], out);
    }
    let pixels = developed(film);
    let rows = pixels.chunks_exact(film.grid.width as usize);
    let rows: Vec<&[u8]> = rows.map(<[_]>::as_flattened).collect();
    png::write(size, &rows, &[], out)
}

/// Writes the picture of a film that comes in bands, from top to bottom: `for_each` calls its
/// function with each.
pub(super) fn write_bands(
    job: &Job,
    out: &mut FileWriter,
    for_each: impl FnOnce(&mut dyn FnMut(&Film, Range<u32>) -> io::Result<()>) -> io::Result<()>,
) -> io::Result<()> {
    let legends = legends(job.rendering.scene);
    if !legends.is_empty() {
        let grid = &job.rendering.film.grid;
        let mut picture = RgbImage::new(grid.width, grid.height);
        for_each(&mut |band, rows| {
            copy_rows(band, rows, &mut picture);
            Ok(())
        })?;
        draw_legends(&mut picture, &legends);
        return write(job, picture.chunks_exact(3 * grid.width as usize), out);
    }
    let is_deep = job.rendering.config.film.bits > 8;
    let pixel_bytes = if is_deep { 6 } else { 3 };
    let mut png = job.begin_png(pixel_bytes, out)?;
    for_each(&mut |band, rows| {
        let skipped = (rows.start - band.row_range().start) as usize;
        if is_deep {
            let pixels = developed(band);
            let of_band = pixels.chunks_exact(band.grid.width as usize);
            let of_band: Vec<&[u8]> = of_band.map(<[_]>::as_flattened).collect();
            png.add(&of_band[skipped..])
        } else {
            let of_band = band.rows(|strip| &strip.rgb).map(<[_]>::as_flattened);
            png.add(&of_band.skip(skipped).collect::<Vec<_>>())
        }
    })
}

/// Copies the last rows of a film, from this one on, into the picture.
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

/// A pixel of 16 bits per channel, the high byte first.
type Rgb16 = [u8; 6];

/// Upper bound of the memory to write a picture of 16 bits besides that of one of 8: the
/// picture, and as much again compressed; and that of a picture with color bars.
pub(super) fn write_bytes(config: &Config) -> u64 {
    let of_bands = bytes_per_band_pixel(config) * config.image.n_pixels() as u64;
    of_bands + bytes_beside_bands(config)
}

/// Upper bound of the memory of a pixel of the picture while its band is written, besides that
/// of one of 8 bits.
pub(super) fn bytes_per_band_pixel(config: &Config) -> u64 {
    match config.film.bits {
        8 => 0,
        _ => 2 * size_of::<Rgb16>() as u64,
    }
}

/// Upper bound of the memory to write a picture besides that of its bands.
pub(super) fn bytes_beside_bands(config: &Config) -> u64 {
    let mut arrays = config
        .materials
        .values()
        .filter_map(|material| material.color.array());
    if arrays.any(|array| array.bar.is_some()) {
        (size_of::<[u8; 3]>() * config.image.n_pixels()) as u64
    } else {
        0
    }
}

/// The color bars of the scene's materials, each once.
fn legends(scene: &Scene) -> Vec<ColorLegend> {
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

/// What the colors of an array mean.
fn key(array: &ArrayTexture) -> LegendKey {
    let Some(n_colors) = array.map.n_categories() else {
        return LegendKey::Range {
            map: array.map.clone(),
            ends: array.table.ends,
            scale: match array.scale {
                ArrayScale::Linear => Scale::Linear,
                ArrayScale::Log => Scale::Logarithmic,
            },
            clips: array.table.clips,
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
fn write_with_legends(job: &Job, legends: &[ColorLegend], out: &mut FileWriter) -> io::Result<()> {
    let film = job.rendering.film;
    let (width, height) = (film.grid.width, film.grid.height);
    let mut picture = RgbImage::new(width, height);
    let row_bytes = 3 * width as usize;
    copy_rows(film, film.row_range(), &mut picture);
    draw_legends(&mut picture, legends);
    if job.rendering.config.film.bits == 8 {
        return write(job, picture.chunks_exact(row_bytes), out);
    }
    let mut developed = developed(film);
    let before = film.rows(|strip| &strip.rgb).flatten();
    let (drawn, _) = picture.as_chunks::<3>();
    for ((place, before), drawn) in developed.iter_mut().zip(before).zip(drawn) {
        if before != drawn {
            // 257 times as much of 16 bits is as bright.
            let [r, g, b] = *drawn;
            *place = [r, r, g, g, b, b];
        }
    }
    write_developed(job, &developed, out)
}

/// The picture of a film that keeps its radiance.
fn developed(film: &Film) -> Vec<Rgb16> {
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

/// Writes the rows of a picture of 8 or 16 bits per channel.
fn write<'a>(
    job: &Job,
    rows: impl Iterator<Item = &'a [u8]>,
    out: &mut impl Write,
) -> io::Result<()> {
    let rows: Vec<&[u8]> = rows.collect();
    let row_bytes = rows.first().map_or(0, |row| row.len());
    let pixel_bytes = row_bytes / job.rendering.film.grid.width as usize;
    job.begin_png(pixel_bytes, out)?.add(&rows)
}

impl Job<'_> {
    /// Begins the picture, of so many bytes per pixel.
    fn begin_png<'o, W: Write>(
        &self,
        pixel_bytes: usize,
        out: &'o mut W,
    ) -> io::Result<PngWriter<'o, W>> {
        let run = self.run.to_string();
        let written = self.rendering.film.extra.written;
        let state = written
            .has_all(&SHOWN_OF_CLOUD)
            .then(|| self.states.geometry());
        let mut texts = vec![(provenance::KEY, &*run)];
        texts.extend(state.iter().map(|state| ("ParaViewState", &**state)));
        let partial = self.rendering.partial.map(|partial| partial.to_string());
        texts.extend(partial.iter().map(|partial| ("Comment", &**partial)));
        let grid = &self.rendering.film.grid;
        PngWriter::begin([grid.width, grid.height], pixel_bytes, &texts, out)
    }
}

/// Writes a picture of 16 bits per channel.
fn write_developed(job: &Job, pixels: &[Rgb16], out: &mut impl Write) -> io::Result<()> {
    let rows = pixels.chunks_exact(job.rendering.film.grid.width as usize);
    write(job, rows.map(<[_]>::as_flattened), out)
}
