//! Estimates the memory and the disk of a rendering, right within a quarter: pixels times the bytes
//! of their arrays, and the scene's primitives times theirs.
//!
//! What may not fit, with that quarter added, is [refused](crate::limits) before it is allocated.
//! What the camera sees, and how well it compresses, is in [`prediction`](crate::prediction).

use crate::writers;
use host::resident_memory;
use render::attribution::CostAttribution;
use render::film::{self, columns, written_columns};
use render::instruments::peak_memory_bytes;
use render::lanes::IdleLanes;
use render::schedule::{self, TileGrid};
use render::tiles::{StoredPicture, least_repeats, repeat_bytes_per_pixel};
use scene::build::Geometries;
use scene::config::{Acceleration, Config, Image, OptionalOutput, Repeats};
use tracer::accel::Bvh;
use tracer::cost::StepCounts;
use vtk::{Codec, appended, compressed};
use world::geometry::Transform;
use world::scene::{Instance, Primitive, SurfaceClass};

/// Bytes of a pixel's counters, packed, measured: 2 to 13 in the example scenes.
const COUNTERS: usize = 8;
/// Bytes per pixel to write the files, measured: with a metric and its map, and without.
const WRITING: [usize; 2] = [12, 4];
/// Bytes to survey the pieces of a picture by histograms.
const SURVEY: u64 = 8 << 20;
/// Maximum bytes of the map of costs of a picture in pieces.
const MOST_OF_MAP: u64 = 64 << 20;
/// Numbers of a pixel that only `image.exr` has: light, albedo, position and depth, less the color
/// and the place.
const ONLY_IN_LAYERS: usize = 5;

/// Bytes that an ellipsoid takes and a sphere does not, measured: its transform, and more of a leaf.
const STRETCHED: usize = size_of::<Transform>() + 96;

/// The expected memory of one rendering, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory {
    /// The film's arrays, the times of repeated renderings, and the output buffers.
    pub film: u64,
    /// Geometries, primitives and the acceleration structure.
    pub scene: u64,
    /// Memory that only the build of the acceleration structure takes: the film takes its place.
    pub build: u64,
    /// Rows of the picture in memory at a time; `None` for all.
    pub band_rows: Option<u32>,
    /// The costs of primitives and nodes, allocated after the rendering.
    pub attribution: u64,
    /// Why the picture must be in memory as a whole, if that can be changed.
    pub(crate) against_bands: Option<&'static str>,
    pub(crate) n_primitives: usize,
    pub(crate) repeats: Repeats,
}

impl Memory {
    /// Estimates the memory for a config and its geometries.
    pub fn estimate(config: &Config, geometries: &Geometries) -> Self {
        let of_attribution =
            CostAttribution::bytes_per_primitive(&config.output, config.acceleration);
        let bare = Self::estimate_primitives(config, geometries, of_attribution);
        let n_pixels = config.image.n_pixels() as u64;
        let of_layers = writers::LAYERS_MEMORY.min(4 * layer_bytes(config)) / 2;
        let has_lanes = config.output.has(OptionalOutput::Lanes);
        let of_lanes = u64::from(has_lanes) * IdleLanes::estimate_bytes(&config.image);
        Self {
            film: tile_bytes(config)
                + n_pixels * pixel_bytes(config)
                + file_bytes(config)
                + of_layers
                + of_lanes,
            ..bare
        }
    }

    /// Returns the memory of this picture if it is written in as large bands of rows as `limit` bytes
    /// hold, or as a whole if that takes less.
    pub(crate) fn in_bands(self, config: &Config, limit: u64) -> Self {
        let Image { width, height, .. } = config.image;
        let of_map = MOST_OF_MAP.min(4 * config.image.n_pixels() as u64);
        let fixed = tile_bytes(config) + file_bytes(config) + SURVEY + of_map;
        let unit = StoredPicture::row_unit(&grid(config));
        let of_unit = u64::from(width) * u64::from(unit) * pixel_bytes(config);
        // A band, and the rows above it that are read again.
        let others = fixed + self.scene + self.attribution;
        let n_units = (limit / 5 * 4).saturating_sub(others) / of_unit;
        let most = u64::from(height.div_ceil(unit));
        let n_units = n_units.saturating_sub(1).clamp(1, most);
        let film = fixed + (n_units + 1) * of_unit;
        // What bands need apart from their rows is more than a small picture needs.
        if film >= self.film {
            return self;
        }
        Self {
            film,
            band_rows: Some(n_units as u32 * unit),
            ..self
        }
    }

    /// Estimates the memory of part of a picture, whose tiles are in files.
    pub fn estimate_part(config: &Config, geometries: &Geometries) -> Self {
        Self {
            film: tile_bytes(config),
            ..Self::estimate_scene(config, geometries)
        }
    }

    /// Estimates the memory of the scene without a film.
    pub fn estimate_scene(config: &Config, geometries: &Geometries) -> Self {
        Self::estimate_primitives(config, geometries, 0)
    }

    /// Estimates the memory of the scene with this many bytes of costs per primitive.
    fn estimate_primitives(
        config: &Config,
        geometries: &Geometries,
        of_attribution: usize,
    ) -> Self {
        let n_primitives = geometries.n_primitives();
        let of_primitives = |n_bytes: usize| (n_primitives * n_bytes) as u64;
        let [lasting, of_build] = primitive_bytes(config).map(of_primitives);
        Self {
            film: 0,
            // The geometries as read, and their attributes in render space.
            scene: lasting
                + (geometries.n_instances() * size_of::<Instance>()) as u64
                + (geometries.n_stretched(config) * STRETCHED) as u64
                + 2 * geometries.n_bytes()
                + geometries.picture_bytes(),
            build: of_build,
            band_rows: None,
            attribution: of_primitives(of_attribution),
            against_bands: None,
            n_primitives,
            repeats: config.repeats,
        }
    }

    /// Estimates the memory of an instance of a mesh.
    pub fn instance_bytes(config: &Config) -> u64 {
        let of_primitive: usize = primitive_bytes(config).iter().sum();
        (of_primitive + size_of::<Instance>()) as u64
    }

    /// Returns an upper bound of the memory: the estimate with its error.
    pub fn at_most(&self) -> u64 {
        let [built, written] = self.stages();
        with_error(built.max(written))
    }

    /// Returns the expected memory while the hierarchy is built, and afterwards, until the last file is
    /// written.
    pub(crate) fn stages(&self) -> [u64; 2] {
        [self.build, self.film + self.attribution].map(|of_stage| self.scene + of_stage)
    }

    /// Returns the expected resident memory at the peak of a rendering in a process that has built
    /// the hierarchy; `None` where the system does not report this process's.
    pub(crate) fn peak(&self) -> Option<u64> {
        let later = self.film + self.attribution;
        Some(peak_memory_bytes()?.max(resident_memory()? + later))
    }
}

/// Returns an upper bound of estimated bytes.
pub(crate) fn with_error(n_bytes: u64) -> u64 {
    n_bytes / 4 * 5
}

/// Returns a lower bound of the bytes on the disk, whatever the camera sees and however well it
/// compresses, with the file of tiles of a picture in pieces.
pub fn least_disk(config: &Config, is_stored: bool) -> u64 {
    // frame.vti has all arrays except the positions.
    let per_pixel: usize = written_columns(config).map(|column| column.stride()).sum();
    let of_frame = (config.image.n_pixels() * per_pixel) as u64 / config.compress.max_ratio();
    let stored = film::stored_bytes_per_pixel(config.cost, config.extra_arrays());
    let n_stored = usize::from(is_stored) * usize::from(least_repeats(config));
    of_frame + (config.image.n_pixels() * n_stored * stored) as u64
}

/// Returns the bytes of all layers of `image.exr` before compression; 0 without the file.
pub(crate) fn layer_bytes(config: &Config) -> u64 {
    if !config.output.has(OptionalOutput::Exr) {
        return 0;
    }
    let numbers = columns(config.cost, config.repeats).map(|column| column.n_components);
    let n_numbers = numbers.sum::<usize>() + ONLY_IN_LAYERS;
    (config.image.n_pixels() * n_numbers * size_of::<f32>()) as u64
}

/// Returns the bytes of a pixel in the film's arrays and its counters.
pub(crate) fn film_bytes(config: &Config) -> u64 {
    let stored = film::stored_bytes_per_pixel(config.cost, config.extra_arrays());
    (stored + usize::from(config.cost.has_counters()) * COUNTERS) as u64
}

/// Returns the bytes of a pixel in a film, with the times of all renderings or, later, to write it.
fn pixel_bytes(config: &Config) -> u64 {
    let of_writing = WRITING[usize::from(!config.cost.has_counters())];
    let of_deep_picture = usize::from(config.film.bits > 8) * size_of::<[u16; 3]>();
    // Rows as they are observed, and strips.
    let n_tests = usize::from(config.output.has(OptionalOutput::Tests)) * 2;
    let of_times = repeat_bytes_per_pixel(config);
    let others = of_times.max(of_writing) + of_deep_picture + n_tests * size_of::<StepCounts>();
    film_bytes(config) + others as u64
}

/// Returns the bytes of a primitive with its share of the acceleration structure, and the bytes that
/// its build takes.
fn primitive_bytes(config: &Config) -> [usize; 2] {
    let [lasting, of_build] = match config.acceleration {
        Acceleration::Bvh(quality) => Bvh::bytes_per_primitive(quality),
        Acceleration::BruteForce => [size_of::<u32>(), 0],
    };
    let own = size_of::<Primitive>() + size_of::<SurfaceClass>();
    [own + lasting, of_build]
}

/// Returns the bytes of all tiles without their pixels.
fn tile_bytes(config: &Config) -> u64 {
    let per_tile = film::BYTES_PER_TILE + schedule::BYTES_PER_TILE;
    u64::from(grid(config).n_tiles()) * per_tile as u64
}

/// Returns the bytes to write files, apart from the film's per pixel: the windows of two arrays that
/// are written at a time, and a picture with color bars.
fn file_bytes(config: &Config) -> u64 {
    let n_pixels = config.image.n_pixels() as u64;
    let of_array = match config.compress {
        Codec::None => appended::BYTES_PER_ARRAY,
        _ => compressed::BYTES_PER_ARRAY,
    };
    let of_windows = (2 * of_array).min(n_pixels * size_of::<[f32; 3]>() as u64);
    let of_bars = if has_bars(config) { 3 * n_pixels } else { 0 };
    of_windows + of_bars
}

/// Returns true if the picture shows color bars.
pub(crate) fn has_bars(config: &Config) -> bool {
    let materials = config.materials.values();
    let mut arrays = materials.filter_map(|material| material.color.array());
    arrays.any(|array| array.bar.is_some())
}

/// Returns the tiles of the picture.
pub(crate) fn grid(config: &Config) -> TileGrid {
    let Image { width, height, .. } = config.image;
    TileGrid::new(width, height, config.tiles.size)
}
