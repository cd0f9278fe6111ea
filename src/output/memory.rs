//! Bounds the memory of a rendering before it is allocated.

use crate::writers;
use base::host::{memory_limit, resident_memory};
use base::text::Diagnostic;
use base::text::numbers::memory_sizes;
use render::attribution::CostAttribution;
use render::film;
use render::schedule::{self, TileGrid};
use render::tiles::{StoredPicture, repeat_bytes_per_pixel};
use scene::build::Geometries;
use scene::config::{Acceleration, Config, Image, OptionalOutput, Repeats};
use scene::yaml::{Fault, FieldPath};
use tracer::accel::{Bvh, TooLarge};
use world::scene::{Instance, Primitive, SurfaceClass};

pub use base::host::{available_memory as available, limit_memory as set_limit};

/// The memory of one rendering, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory {
    /// The film's arrays, the times of repeated renderings, and the output buffers.
    pub film: u64,
    /// Primitives, the acceleration structure, and the costs attributed to both.
    pub scene: u64,
    /// Rows of the picture in memory at a time; `None` for all.
    pub band_rows: Option<u32>,
    /// Bytes of the film's that a picture of any size needs.
    of_buffers: u64,
    /// Why the picture must be in memory as a whole, if that can be changed.
    against_bands: Option<&'static str>,
    n_primitives: usize,
    repeats: Repeats,
}

/// The percentage of the available memory that a picture may take by default.
const SHARE: u64 = 75;
/// Upper bound of the program's memory before rendering, without geometries, in bytes.
const PROGRAM: u64 = 32 * MIB;
const MIB: u64 = 1 << 20;

impl Memory {
    /// Estimates the memory for a config and its geometries: an upper bound, except for a few MiB
    /// of program and buffers.
    pub fn estimate(config: &Config, geometries: &Geometries) -> Self {
        let of_attribution =
            CostAttribution::bytes_per_primitive(&config.output, config.acceleration);
        let bare = Self::of_scene(config, geometries);
        Self {
            film: config.image.n_pixels() as u64
                * (film_bytes_per_pixel(config) + writers::BYTES_PER_PIXEL)
                + of_tiles(config)
                + writers::write_bytes(config),
            of_buffers: writers::compression_bytes(config.compress),
            scene: bare.scene + (bare.n_primitives * of_attribution) as u64,
            ..bare
        }
    }

    /// Estimates the memory of a still picture. If it exceeds the user's limit, by default three
    /// quarters of the available memory, the picture is rendered into files and written in bands of
    /// rows, if its outputs allow it and these need less.
    pub fn of_still(config: &Config, geometries: &Geometries) -> Self {
        let whole = Self::estimate(config, geometries);
        let limit = limit_of_still(memory_limit(), available(), geometries.n_bytes());
        let against_bands = against_bands(config);
        if whole.total() <= limit || against_bands.is_some() {
            return Self {
                against_bands,
                ..whole
            };
        }
        let fixed = of_tiles(config) + writers::bytes_beside_bands(config);
        let of_unit = of_rows(config, unit(config));
        // A band, and the rows above it that are read again.
        let n_units = limit.saturating_sub(fixed + whole.scene) / of_unit;
        let most = u64::from(config.image.height.div_ceil(unit(config)));
        let n_units = n_units.saturating_sub(1).clamp(1, most);
        let n_rows = n_units as u32 * unit(config);
        let film = fixed + (n_units + 1) * of_unit;
        // What bands need besides their rows is more than a small picture needs.
        if film >= whole.film {
            return whole;
        }
        Self {
            film,
            band_rows: Some(n_rows),
            ..whole
        }
    }

    /// Estimates the memory of part of a picture, whose tiles are in files.
    pub fn of_part(config: &Config, geometries: &Geometries) -> Self {
        Self {
            film: of_tiles(config),
            ..Self::of_scene(config, geometries)
        }
    }

    /// Estimates the memory of an instance of a mesh: an upper bound.
    pub fn of_instance(config: &Config) -> u64 {
        (Self::per_primitive(config) + size_of::<Instance>()) as u64
    }

    /// Returns an upper bound of the bytes of a primitive and its share of the acceleration
    /// structure.
    fn per_primitive(config: &Config) -> usize {
        size_of::<Primitive>()
            + size_of::<SurfaceClass>()
            + match config.acceleration {
                Acceleration::Bvh(quality) => Bvh::bytes_per_primitive(quality),
                Acceleration::BruteForce => size_of::<u32>(),
            }
    }

    /// Estimates the memory of the scene without a film.
    pub fn of_scene(config: &Config, geometries: &Geometries) -> Self {
        let per_primitive = Self::per_primitive(config);
        let n_primitives = geometries.n_primitives();
        Self {
            film: 0,
            // The geometries as read, and their attributes in render space.
            scene: n_primitives as u64 * per_primitive as u64
                + (geometries.n_instances() * size_of::<Instance>()) as u64
                + 2 * geometries.n_bytes()
                + geometries.picture_bytes(),
            band_rows: None,
            of_buffers: 0,
            against_bands: None,
            n_primitives,
            repeats: config.repeats,
        }
    }

    /// Returns the sum of both.
    pub fn total(&self) -> u64 {
        self.film + self.scene
    }

    /// Checks that `available` bytes suffice, and that a hierarchy can hold all primitives.
    ///
    /// # Errors
    /// A fault in the section that needs the most memory.
    pub fn check(&self, available: u64) -> Result<(), Fault> {
        if self.n_primitives > Bvh::MAX_PRIMITIVES {
            let most = Bvh::MAX_PRIMITIVES;
            let message = format!("the scene has {} primitives", self.n_primitives);
            let objects = FieldPath::default().key("objects");
            return Err(
                Fault::of_key(objects, message, format!("expected at most {most}"))
                    .with_help("reduce the `count` of generators, or use smaller files"),
            );
        }
        if self.total() <= available {
            return Ok(());
        }
        let fits_if_smaller = self.scene + self.of_buffers <= available;
        let (section, what, advice) = if self.film <= self.scene {
            let advice = "reduce the `count` of generators, or use smaller files".to_owned();
            ("objects", "the scene is too large: ", Some(advice))
        } else if fits_if_smaller {
            (
                "image",
                "the image is too large: ",
                Some(self.image_advice()),
            )
        } else {
            ("image", "", None)
        };
        let [needed, left] = memory_sizes([self.total(), available]);
        let [of_section, _] = memory_sizes([self.film.max(self.scene), available]);
        let limit = memory_limit();
        let more = limit.map(|limit| {
            let enough = limit.saturating_sub(available) + self.total();
            format!("give `--memory {}M` or more", enough.div_ceil(MIB) + 1)
        });
        let help = match (advice, more) {
            (Some(advice), Some(more)) => format!("{advice}; or {more}"),
            (advice, more) => advice.or(more).unwrap_or("stop other programs".to_owned()),
        };
        let left_of = limit.map_or("free", |_| "left of `--memory`");
        Err(Fault::of_key(
            FieldPath::default().key(section),
            format!("{what}{needed} of memory are needed, {left} are {left_of}"),
            format!("needs {of_section}"),
        )
        .with_help(help))
    }

    fn image_advice(&self) -> String {
        let advice = match self.repeats {
            Repeats::Auto | Repeats::ONCE => "choose a smaller `width` or `height`",
            Repeats::Exactly(_) => "choose a smaller `width` or `height`, or fewer `--repeats`",
        };
        match self.against_bands {
            None => advice.to_owned(),
            Some(reason) => format!("{advice}; {reason}"),
        }
    }
}

/// Checks that the program itself fits into the memory that the user allows.
///
/// # Errors
/// It does not.
pub fn check_limit() -> Result<(), Diagnostic> {
    let sizes = memory_limit().zip(resident_memory());
    let Some((limit, program)) = sizes.filter(|(limit, program)| limit <= program) else {
        return Ok(());
    };
    let [limit, program] = memory_sizes([limit, program]);
    let message =
        format!("`--memory` allows {limit}, and the program itself takes {program} already");
    let help = format!(
        "give `--memory {}M` or more: `raycost check` says what a scene takes beside the program",
        PROGRAM / MIB
    );
    Err(Diagnostic::new(message).with_help(help))
}

/// Returns the limit in bytes of a still picture beside `n_read` bytes of geometries: with a limit
/// set by the user, the same each time, whatever else the process holds.
fn limit_of_still(set: Option<u64>, available: u64, n_read: u64) -> u64 {
    match set {
        Some(limit) => available.min(limit.saturating_sub(PROGRAM + n_read)),
        None => available / 100 * SHARE,
    }
}

/// Returns why a picture cannot be larger than memory, with the remedy; `None` if it can.
fn against_bands(config: &Config) -> Option<&'static str> {
    let has = |output| config.output.has(output);
    if has(OptionalOutput::Tests) {
        return Some("without the output `tests` it would be written in pieces");
    }
    if has(OptionalOutput::Exr) {
        return Some("without `image.exr` it would be written in pieces");
    }
    if config.cost.has_time() && config.output.iter().any(OptionalOutput::needs_attribution) {
        return Some("with `--cost counters` it would be written in pieces");
    }
    let mut arrays = config
        .materials
        .values()
        .filter_map(|material| material.color.array());
    if config.film.bits > 8 && arrays.any(|array| array.bar.is_some()) {
        return Some("with 8 bits, or without color bars, it would be written in pieces");
    }
    None
}

/// Returns an upper bound of the bytes of a pixel in a film.
fn film_bytes_per_pixel(config: &Config) -> u64 {
    let of_samples = config.image.adaptive.map_or(0, |_| size_of::<u32>());
    let of_film = film::bytes_per_pixel(config.cost, config.extra_arrays())
        + of_samples
        + repeat_bytes_per_pixel(config);
    of_film as u64
}

/// Returns an upper bound of the bytes of all tiles without their pixels.
fn of_tiles(config: &Config) -> u64 {
    u64::from(grid(config).n_tiles()) * (film::BYTES_PER_TILE + schedule::BYTES_PER_TILE) as u64
}

fn of_rows(config: &Config, n_rows: u32) -> u64 {
    let of_writing = writers::bytes_per_band_pixel(config);
    u64::from(config.image.width) * u64::from(n_rows) * (film_bytes_per_pixel(config) + of_writing)
}

/// Returns the minimum number of rows of a band.
fn unit(config: &Config) -> u32 {
    StoredPicture::row_unit(&grid(config))
}

fn grid(config: &Config) -> TileGrid {
    let Image { width, height, .. } = config.image;
    TileGrid::new(width, height, config.tiles.size)
}

/// Returns the fault of a hierarchy that turned out too large.
pub fn too_large(error: TooLarge) -> Fault {
    let objects = FieldPath::default().key("objects");
    Fault::of_key(objects, error.to_string(), "their hierarchy is too large")
        .with_help("reduce the `count` of generators, or use `acceleration: { quality: fast }`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_a_picture_depend_on_the_limit_and_not_on_chance() {
        let limit = 100 << 20;
        let of_process = |resident: u64| limit_of_still(Some(limit), limit - resident, 5 << 20);
        for resident in [(11 << 20) + 4096, 18 << 20, 30 << 20] {
            assert_eq!(of_process(resident), 63 << 20);
        }
        // A process that holds more than expected keeps the limit.
        assert_eq!(of_process(60 << 20), 40 << 20);
        assert_eq!(limit_of_still(Some(1 << 20), 1 << 20, 0), 0);
        assert_eq!(limit_of_still(None, 1000, 5 << 20), 750);
    }
}
