//! Sizes of the output files.

use super::length::Length;
use super::preview::Preview;
use super::sample::RowSample;
use crate::writers;
use render::attribution::{Hierarchy, Visits};
use render::checkpoint;
use render::film::{self, Column, written_columns};
use render::schedule::TileGrid;
use render::tiles::least_repeats;
use scene::config::{Config, Image, OptionalOutput};
use tracer::accel::BvhNode;
use vtk::Codec;
use world::scene::Scene;

/// Bytes of the header of a VTK file of pixels, with its field data.
const HEADER: u64 = 6_000;
/// Bytes of `summary.json`.
const SUMMARY: u64 = 6_000;
/// Bytes of a tile in `tiles.vti` and `trace.json`.
const PER_TILE: u64 = 300;

/// The sizes of the output files.
#[derive(Debug, Clone)]
pub struct DiskUse {
    /// The files of arrays.
    pub arrays: Vec<ArrayFile>,
    /// Bytes of all text files.
    pub texts: u64,
    /// Bytes of the picture and the cost map.
    pub pictures: u64,
    /// Bytes of the picture's layers before compression, which is always on; 0 without layers.
    pub layers: u64,
    /// Bytes of the file of finished tiles.
    pub tiles: u64,
}

/// The size of a file of arrays.
#[derive(Debug, Clone, Copy)]
pub struct ArrayFile {
    /// Name.
    pub name: &'static str,
    /// Bytes; before compression unless `is_known`.
    pub n_bytes: u64,
    /// True if these are the bytes on the disk.
    pub is_known: bool,
}

impl DiskUse {
    /// Predicts the files of a picture in this many pieces.
    pub(super) fn predict(
        config: &Config,
        scene: &Scene,
        (preview, sample): (&Preview, &RowSample),
        nodes: Vec<BvhNode>,
        n_pieces: u32,
    ) -> Self {
        let Image { width, height, .. } = config.image;
        let grid = TileGrid::new(width, height, config.tiles.size);
        let mut arrays = of_pixels(config, (preview, sample), n_pieces);
        arrays.extend(of_attribution(config, scene, nodes));
        let of_tiles = if config.output.has(OptionalOutput::Schedule) {
            PER_TILE * u64::from(grid.n_tiles())
        } else {
            0
        };
        let side = match n_pieces {
            1 => 1,
            _ => writers::map_side([width, height]),
        };
        let of_pixels = config.image.n_pixels() as f64 * stored_bytes(config, preview);
        Self {
            arrays,
            texts: SUMMARY + writers::state_bytes(config) + of_tiles,
            pictures: sample.of_picture() + sample.of_map(side) + writers::picture_texts(config),
            layers: writers::layer_bytes(config),
            tiles: u64::from(least_repeats(config))
                * (of_pixels as u64 + u64::from(grid.n_tiles()) * checkpoint::BYTES_PER_TILE),
        }
    }

    /// Returns the sum of the arrays whose size on the disk is known.
    pub fn of_known_arrays(&self) -> u64 {
        let known = self.arrays.iter().filter(|file| file.is_known);
        known.map(|file| file.n_bytes).sum()
    }
}

/// Predicts the cloud and the frame, in this many pieces. Adjacent pieces of the frame share a row
/// of pixels.
fn of_pixels(
    config: &Config,
    (preview, sample): (&Preview, &RowSample),
    n_pieces: u32,
) -> Vec<ArrayFile> {
    let n_pixels = config.image.n_pixels() as u64;
    let n_hits = (preview.hit_share * n_pixels as f64).round() as u64;
    let [cloud, frame] = match config.compress {
        Codec::None => {
            let columns = written_columns(config);
            let per_pixel: u64 = columns.map(|column| column.stride() as u64).sum();
            let per_hit = per_pixel + bytes_of_hit(config);
            [n_hits * per_hit, n_pixels * per_pixel]
        }
        _ => sample.of_arrays(n_hits),
    };
    let n_pieces = u64::from(n_pieces);
    let of_shared_rows = (n_pieces - 1) * frame / u64::from(config.image.height);
    let file = |name, n_bytes| ArrayFile {
        name,
        n_bytes: n_pieces * HEADER + n_bytes,
        is_known: true,
    };
    let names = match n_pieces {
        1 => ["hits.vtu", "frame.vti"],
        _ => ["hits.pvtu", "frame.pvti"],
    };
    vec![
        file(names[0], cloud),
        file(names[1], frame + of_shared_rows),
    ]
}

/// Predicts the files of the costs of primitives and nodes.
fn of_attribution(config: &Config, scene: &Scene, nodes: Vec<BvhNode>) -> Vec<ArrayFile> {
    let (cost, has) = (config.cost, |output| config.output.has(output));
    let file = |name, n_bytes| ArrayFile {
        name,
        n_bytes,
        is_known: config.compress == Codec::None,
    };
    let mut files = Vec::new();
    if has(OptionalOutput::Surface) {
        let visits = vec![Visits::default(); scene.primitives.len()];
        let write =
            |out: &mut Length| writers::write_surface(scene, &visits, cost, Codec::None, out);
        files.push(file("surface.vtu", Length::measure(write)));
    }
    if has(OptionalOutput::Bvh) {
        let visits = vec![Visits::default(); nodes.len()];
        let instances = scene.instances.as_ref();
        let hierarchy = (&Hierarchy { nodes, visits }, instances, scene.space);
        let limits = config.output.bvh;
        let write =
            |out: &mut Length| writers::write_nodes(hierarchy, limits, cost, Codec::None, out);
        files.push(file("bvh.vtu", Length::measure(write)));
    }
    files
}

/// Returns the bytes of a point of the cloud besides the arrays that the frame has too.
fn bytes_of_hit(config: &Config) -> u64 {
    let written = config.output.written_arrays();
    let index: u64 = if i32::try_from(config.image.n_pixels()).is_ok() {
        4
    } else {
        8
    };
    let of = |name: &str, n_bytes: u64| if written.has(name) { n_bytes } else { 0 };
    // A cell has a point index, the end of its points, and a type.
    let of_cell = 2 * 4 + 1;
    Column::POSITION.stride() as u64 + of("pixel", index) + of("horizon", 1) + of_cell
}

/// Returns the bytes of a pixel in a file of tiles.
fn stored_bytes(config: &Config, preview: &Preview) -> f64 {
    let of_film = film::stored_bytes_per_pixel(config.cost, config.extra_arrays());
    of_film as f64 + preview.counter_bytes
}
