//! Predicts the peak memory and the disk space of a rendering.
//!
//! [`memory`](crate::memory) has an upper bound, to refuse a rendering that may not fit; this is
//! the expected value. The steps before the film are not estimated but performed: the scene is read
//! and its hierarchy built as for the rendering, so this process measures their memory. A small
//! picture of the scene shows what depends on the camera: how many pixels have a hit, and how large
//! their counters are. The rest is the film's arrays and the copies of some of them while files are
//! written.

mod length;
mod look;
mod preview;
mod sample;
mod bands;
mod disk;

pub use disk::{ArrayFile, DiskUse};

use crate::writers;
use base::host::{free_heap, resident_memory};
pub use look::Look;
use preview::Preview;
use render::attribution::Visits;
use render::film;
use render::instruments::peak_memory_bytes;
use render::schedule::{self, TileGrid};
use render::tiles::most_repeats;
use sample::RowSample;
use scene::config::{Config, OptionalOutput, Repeats};
use tracer::accel::{Accel, BvhNode, TooLarge};
use tracer::trace::Tracer;
use world::scene::Scene;

/// The predicted resources of a rendering.
#[derive(Debug, Clone)]
pub struct Prediction {
    /// Resident memory at the peak, in bytes; `None` where the system does not report this
    /// process's.
    pub peak_memory: Option<u64>,
    /// The files.
    pub disk: DiskUse,
    /// The camera's view.
    pub look: Look,
}

impl Prediction {
    /// Predicts the rendering of a scene that was read and placed, in bands of this many rows if it
    /// is larger than memory, on the current rayon pool. Builds the hierarchy and renders a small
    /// picture, and some rows.
    ///
    /// # Errors
    /// The hierarchy is too large.
    pub fn new(config: &Config, scene: &Scene, band_rows: Option<u32>) -> Result<Self, TooLarge> {
        // Build the hierarchy as the rendering will.
        let accel = Accel::build(scene, config.acceleration, &|_| {})?;
        // Render a small picture for all that depends on the camera.
        let tracer = Tracer::new(scene, &accel);
        let preview = Preview::render(config, tracer);
        let has_nodes = config.output.has(OptionalOutput::Bvh);
        // Before the list of nodes takes memory itself.
        let so_far = MemorySoFar::so_far();
        let nodes = if has_nodes { accel.nodes() } else { Vec::new() };
        // Add the memory of the film and of writing the files.
        let peak_memory = so_far.map(|so_far| {
            let (film, later) = match band_rows {
                None => (
                    of_film(config, &preview),
                    of_attribution(config, scene, &nodes) + of_files(config, &preview),
                ),
                Some(n_rows) => (bands::of_bands(config, &preview, n_rows), 0),
            };
            let filled = film.saturating_sub(so_far.free);
            so_far.peak.max(so_far.resident + filled + later)
        });
        let n_pieces = band_rows.map_or(1, |n_rows| config.image.height.div_ceil(n_rows));
        let is_repeated = n_repeats(config, &preview) > 1;
        // Render some rows to measure the sizes of files.
        let sample = RowSample::render(config, tracer, is_repeated);
        Ok(Self {
            peak_memory,
            look: preview.look,
            disk: DiskUse::predict(config, scene, (&preview, &sample), nodes, n_pieces),
        })
    }
}

/// The memory of this process, in bytes.
struct MemorySoFar {
    resident: u64,
    /// The free part, which allocations use next.
    free: u64,
    peak: u64,
}

impl MemorySoFar {
    fn so_far() -> Option<Self> {
        Some(Self {
            resident: resident_memory()?,
            free: free_heap(),
            peak: peak_memory_bytes()?,
        })
    }
}

/// Returns the bytes of the film and of the times of all renderings. The latter are free before the
/// files are written, but the deviations, which take their place, leave no room for larger blocks.
fn of_film(config: &Config, preview: &Preview) -> u64 {
    let stored = film::stored_bytes_per_pixel(config.cost, config.extra_arrays());
    let has_samples = config.cost.has_time() && config.repeats.has_spread();
    let of_samples = if has_samples {
        size_of::<f32>() * usize::from(n_repeats(config, preview))
    } else {
        0
    };
    let per_pixel = (stored + of_samples) as f64 + preview.counter_bytes;
    let grid = TileGrid::new(config.image.width, config.image.height, config.tiles.size);
    let per_tile = film::BYTES_PER_TILE + schedule::BYTES_PER_TILE;
    let of_tiles = u64::from(grid.n_tiles()) * per_tile as u64;
    (config.image.n_pixels() as f64 * per_pixel) as u64 + of_tiles
}

/// Returns the number of times that the picture will be rendered.
fn n_repeats(config: &Config, preview: &Preview) -> u8 {
    match config.repeats {
        Repeats::Exactly(n) => n.get(),
        Repeats::Auto => {
            let n_pixels = config.image.n_pixels() as f64;
            let samples = f64::from(config.image.samples_per_pixel);
            let fitting = 0.5 / (preview.seconds_per_sample * samples * n_pixels);
            (fitting as u8).clamp(1, most_repeats(config))
        }
    }
}

/// Returns the bytes of the costs attributed to primitives and nodes, and of the lists of nodes
/// that file and state need, each with a reference to the node, one to its visits, and its cost.
fn of_attribution(config: &Config, scene: &Scene, nodes: &[BvhNode]) -> u64 {
    let of_surface = if config.output.has(OptionalOutput::Surface) {
        scene.primitives.len() * size_of::<Visits>()
    } else {
        0
    };
    let listed = size_of::<(&BvhNode, &Visits, f32)>() + size_of::<Visits>();
    let per_node = size_of::<BvhNode>() + size_of::<Visits>() + listed;
    (of_surface + nodes.len() * per_node) as u64
}

/// Returns the bytes copied to write the files: by the states first, or by the writers.
fn of_files(config: &Config, preview: &Preview) -> u64 {
    let n_pixels = config.image.n_pixels() as f64;
    let number = size_of::<f32>() as f64;
    let of_map = if config.cost.has_counters() {
        number
    } else {
        0.0
    };
    // The distances of hits, for their median, and beside them the values of the cost map and of
    // the second cost, larger than the room that the distances leave.
    let of_states = number * preview.hit_share + 2.0 * of_map;
    let of_pictures = of_map + 3.0 * preview.map_pixels;
    let of_writers = (n_pixels * of_pictures) as u64 + writers::expected_write_bytes(config);
    of_writers.max((n_pixels * of_states) as u64)
}
