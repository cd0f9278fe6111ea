//! The bytes of the files.

use std::io::{self, Seek, SeekFrom, Write};

use super::preview::Preview;
use crate::accel::BvhNode;
use crate::attribution::{Hierarchy, Visits};
use crate::config::{Config, OptionalOutput};
use crate::film::{self, Column, written_columns};
use crate::output;
use crate::scene::Scene;
use crate::schedule::TileGrid;
use crate::vtk::Codec;

/// The bytes of the header of a VTK file of pixels, with its field data.
const HEADER: u64 = 6_000;
/// The bytes of `summary.json`.
const SUMMARY: u64 = 6_000;
/// The bytes of a tile in `tiles.vti` and `trace.json`.
const PER_TILE: u64 = 300;

/// The bytes of the files.
#[derive(Debug, Clone)]
pub(crate) struct DiskUse {
    /// Of each file of arrays before compression, by its name.
    pub(crate) arrays: Vec<(&'static str, u64)>,
    /// Of all files of text.
    pub(crate) texts: u64,
    /// Of all pictures before compression, which is always on.
    pub(crate) pictures: u64,
    /// Of the file of finished tiles.
    pub(crate) tiles: u64,
}

impl DiskUse {
    pub(super) fn of(
        config: &Config,
        scene: &Scene,
        preview: &Preview,
        nodes: Vec<BvhNode>,
    ) -> Self {
        let n_pixels = config.image.n_pixels() as u64;
        let n_hits = (preview.hit_share * n_pixels as f64).round() as u64;
        let per_pixel: u64 = written_columns(config)
            .map(|column| column.stride() as u64)
            .sum();
        let per_hit = per_pixel + bytes_of_hit(config);
        let mut arrays = vec![
            ("hits.vtu", HEADER + n_hits * per_hit),
            ("frame.vti", HEADER + n_pixels * per_pixel),
        ];
        let (cost, has) = (config.cost, |output| config.output.has(output));
        if has(OptionalOutput::Surface) {
            let visits = vec![Visits::default(); scene.primitives.len()];
            let write =
                |out: &mut Length| output::write_surface(scene, &visits, cost, Codec::None, out);
            arrays.push(("surface.vtu", length(write)));
        }
        if has(OptionalOutput::Bvh) {
            let visits = vec![Visits::default(); nodes.len()];
            let hierarchy = (&Hierarchy { nodes, visits }, scene.instances.as_ref());
            let limits = config.output.bvh;
            let write =
                |out: &mut Length| output::write_nodes(hierarchy, limits, cost, Codec::None, out);
            arrays.push(("bvh.vtu", length(write)));
        }
        let grid = TileGrid::new(config.image.width, config.image.height, config.tiles.size);
        let of_tiles = if has(OptionalOutput::Schedule) {
            PER_TILE * u64::from(grid.n_tiles())
        } else {
            0
        };
        Self {
            arrays,
            texts: SUMMARY + output::state_bytes(config) + of_tiles,
            pictures: of_pictures(config, preview),
            tiles: (n_pixels as f64 * stored_bytes(config, preview)) as u64,
        }
    }

    /// The sum of all arrays.
    pub(crate) fn of_arrays(&self) -> u64 {
        self.arrays.iter().map(|(_, n_bytes)| n_bytes).sum()
    }
}

/// The bytes of a point of the cloud besides the arrays that the frame has, too.
fn bytes_of_hit(config: &Config) -> u64 {
    let written = config.output.written_arrays();
    let index: u64 = if i32::try_from(config.image.n_pixels()).is_ok() {
        4
    } else {
        8
    };
    let of = |name: &str, n_bytes: u64| if written.has(name) { n_bytes } else { 0 };
    // A cell has a point, where its points end, and a type.
    let of_cell = 2 * 4 + 1;
    Column::POSITION.stride() as u64 + of("pixel", index) + of("horizon", 1) + of_cell
}

/// The bytes of a pixel in a file of tiles.
fn stored_bytes(config: &Config, preview: &Preview) -> f64 {
    let of_film = film::stored_bytes_per_pixel(config.cost, config.extra_arrays());
    of_film as f64 + preview.counter_bytes
}

/// The bytes of the pictures before compression.
fn of_pictures(config: &Config, preview: &Preview) -> u64 {
    let n_pixels = config.image.n_pixels() as f64;
    let of_picture = 3.0 * f64::from(config.film.bits) / 8.0;
    let of_map = 3.0 * preview.map_pixels;
    (n_pixels * (of_picture + of_map)) as u64 + output::layer_bytes(config)
}

/// The length of what a function writes.
fn length(write: impl FnOnce(&mut Length) -> io::Result<()>) -> u64 {
    let mut out = Length::default();
    match write(&mut out) {
        Ok(()) => out.length,
        Err(_) => 0,
    }
}

/// Counts bytes, and forgets them.
#[derive(Debug, Default)]
struct Length {
    position: u64,
    length: u64,
}

impl Write for Length {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.position += bytes.len() as u64;
        self.length = self.length.max(self.position);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Length {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let from = |base: u64, offset: i64| base.checked_add_signed(offset);
        let position = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::End(offset) => from(self.length, offset),
            SeekFrom::Current(offset) => from(self.position, offset),
        };
        self.position = position.ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.position)
    }
}
