//! `image.exr`: the light of the pixels and all other arrays of the film, as layers of one OpenEXR
//! file for compositors.
//!
//! One part holds all channels: simple viewers read `R`, `G` and `B`, compositors find the layers.
//! Blocks of rows are compressed in parallel, a few at a time, and the file has the same bytes on
//! any number of threads.

mod channels;

use std::io::{self, Seek, Write};

use exr::block::writer::{ChunksWriter, write_chunks_with};
use exr::block::{BlockIndex, UncompressedBlock};
use exr::compression::Compression;
use exr::error::{Error, Result, UnitResult};
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, Chromaticities, LineOrder, Text};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, Headers};
use rayon::prelude::*;

use super::RenderingView;
use super::file::{FileContent, OutputFile};
use super::summary::totals;
use channels::{CHANNEL_BYTES, Channel, channels};
use host::provenance::{self, RunId};
use render::film::{Film, STRIP_ROWS};
use scene::config::OptionalOutput;
use tracer::cost::Metric;

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: "image.exr",
    is_wanted: |request| request.has(OptionalOutput::Exr),
    content: FileContent::Written(|job, out| write(job.rendering, job.run, out)),
};

/// Rows of a block; a multiple of `STRIP_ROWS`.
const BLOCK_ROWS: u32 = 16;

/// Memory of the blocks that are compressed at a time; at least one block is.
pub(crate) const BLOCKS_MEMORY: u64 = 1 << 26;

/// Upper bound of the copies of a block during compression.
const COPIES: u64 = 4;

/// Returns the memory to compress this many columns and rows.
fn block_memory([width, n_rows]: [u32; 2], n_channels: usize) -> u64 {
    COPIES * u64::from(width) * u64::from(n_rows) * (n_channels * CHANNEL_BYTES) as u64
}

/// Writes the film's layers.
pub(super) fn write(
    rendering: &RenderingView,
    run: RunId,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    let film = rendering.film;
    let channels = channels(film, rendering.image_plane());
    let headers = Headers::from_elem(header(rendering, &channels, run), 1);
    let write_blocks = |_, chunks: &mut _| write_blocks(film, &channels, &headers, chunks);
    write_chunks_with(out, headers.clone(), true, write_blocks).map_err(|error| match error {
        Error::Io(error) => error,
        other => io::Error::other(other),
    })
}

fn header(rendering: &RenderingView, channels: &[Channel], run: RunId) -> Header {
    let film = rendering.film;
    let size = Vec2(film.grid.width as usize, film.grid.height as usize);
    let described = channels.iter().map(Channel::described).collect();
    let mut header = Header::new(Text::from(""), size, described).with_encoding(
        Compression::ZIP16,
        BlockDescription::ScanLines,
        LineOrder::Increasing,
    );
    // The only part of a file needs no name.
    header.own_attributes.layer_name = None;
    let program = concat!("raycost ", env!("CARGO_PKG_VERSION"));
    header.own_attributes.software_name = Some(Text::from(program));
    header.own_attributes.comments = Some(Text::from(&*comments(rendering)));
    // Only one attribute, because the crate writes several in any order.
    let run = AttributeValue::Text(Text::from(&*run.to_string()));
    let key = Text::from(provenance::KEY);
    header.own_attributes.other.insert(key, run);
    header.shared_attributes.chromaticities = Some(SRGB);
    header
}

/// Returns a line about missing parts, if there are some, and the totals of all metrics with their
/// units: viewers such as tev and mrViewer show the attribute.
fn comments(rendering: &RenderingView) -> String {
    let partial = rendering.partial.map(|partial| format!("{partial}\n"));
    let mut text = partial.unwrap_or_default();
    if rendering.film.cost.has_counters() {
        text += "Totals of all pixels:\n";
        for (name, total) in totals(rendering.film, rendering.survey) {
            let unit = Metric::named(&name).map_or("", |metric| metric.unit_label());
            if let Some(total) = total {
                text += format!("{name} {total} {unit}").trim_end();
                text.push('\n');
            }
        }
    }
    text
}

/// The primaries and the white of sRGB (IEC 61966-2-1).
const SRGB: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

fn write_blocks(
    film: &Film,
    channels: &[Channel],
    headers: &Headers,
    chunks: &mut impl ChunksWriter,
) -> UnitResult {
    let firsts: Vec<u32> = (0..film.grid.height).step_by(BLOCK_ROWS as usize).collect();
    let memory = block_memory([film.grid.width, BLOCK_ROWS], channels.len());
    for some in firsts.chunks((BLOCKS_MEMORY / memory).max(1) as usize) {
        let compressed = some.par_iter().map(|&first| {
            let block = encode_block(film, channels, first);
            block.compress_to_chunk(headers)
        });
        let compressed: Result<Vec<_>> = compressed.collect();
        for (chunk, first) in compressed?.into_iter().zip(some) {
            chunks.write_chunk((first / BLOCK_ROWS) as usize, chunk)?;
        }
    }
    Ok(())
}

/// Returns the rows of a block from top to bottom, each with its channels one after the other.
fn encode_block(film: &Film, channels: &[Channel], first_row: u32) -> UncompressedBlock {
    let width = film.grid.width as usize;
    let n_rows = BLOCK_ROWS.min(film.grid.height - first_row) as usize;
    let mut words = vec![0; n_rows * width * channels.len()];
    let first = (first_row / STRIP_ROWS) as usize;
    let strips = &film.strips[first..][..n_rows.div_ceil(STRIP_ROWS as usize)];
    let mut of_channel = Vec::new();
    let of_strips = words.chunks_mut(STRIP_ROWS as usize * width * channels.len());
    for (strip, words) in strips.iter().zip(of_strips) {
        for (i, channel) in channels.iter().enumerate() {
            of_channel.clear();
            channel.add_words(film, strip, &mut of_channel);
            let rows = words.chunks_exact_mut(width * channels.len());
            for (row, from) in rows.zip(of_channel.chunks_exact(width)) {
                row[i * width..][..width].copy_from_slice(from);
            }
        }
    }
    UncompressedBlock {
        index: BlockIndex {
            layer: 0,
            pixel_position: Vec2(0, first_row as usize),
            pixel_size: Vec2(width, n_rows),
            level: Vec2(0, 0),
        },
        data: bytemuck::cast_slice(&words).to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_made_of_whole_strips() {
        assert_eq!(BLOCK_ROWS % STRIP_ROWS, 0);
        assert_eq!(
            Compression::ZIP16.scan_lines_per_block(),
            BLOCK_ROWS as usize
        );
    }
}
