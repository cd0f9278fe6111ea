//! Estimates the memory of a rendering before it is allocated.

use crate::accel::{Bvh, TooLarge};
use crate::attribution::CostAttribution;
use crate::config::{Acceleration, Config, Image, Repeats};
use crate::film;
use crate::output;
use crate::render::repeat_bytes_per_pixel;
use crate::scene::{Geometries, Instance, Primitive, SurfaceClass};
use crate::schedule::{self, TileGrid};
use crate::yaml::{Fault, FieldPath};

pub use crate::host::available_memory as available;

/// The memory of one rendering, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory {
    /// The film's arrays, the times of repeated renderings, and the buffers of
    /// the output.
    pub film: u64,
    /// Primitives, the acceleration structure, and the costs attributed to both.
    pub scene: u64,
    n_primitives: usize,
    repeats: Repeats,
}

impl Memory {
    /// Estimates the memory for a config and its geometries: an upper bound,
    /// except for a few MiB of program and buffers.
    pub fn of(config: &Config, geometries: &Geometries) -> Self {
        let of_samples = config.image.adaptive.map_or(0, |_| size_of::<u32>());
        let of_film = film::bytes_per_pixel(config.cost, config.extra_arrays())
            + of_samples
            + repeat_bytes_per_pixel(config);
        let per_pixel = of_film as u64 + output::BYTES_PER_PIXEL;
        let Image { width, height, .. } = config.image;
        let n_tiles = TileGrid::new(width, height, config.tiles.size).n_tiles();
        let of_tiles =
            u64::from(n_tiles) * (film::BYTES_PER_TILE + schedule::BYTES_PER_TILE) as u64;
        let of_attribution =
            CostAttribution::bytes_per_primitive(&config.output, config.acceleration);
        let bare = Self::of_scene(config, geometries);
        Self {
            film: config.image.n_pixels() as u64 * per_pixel
                + of_tiles
                + output::write_bytes(config),
            scene: bare.scene + (bare.n_primitives * of_attribution) as u64,
            ..bare
        }
    }

    /// Estimates the memory of an instance of a mesh: an upper bound.
    pub fn of_instance(config: &Config) -> u64 {
        (Self::per_primitive(config) + size_of::<Instance>()) as u64
    }

    /// Upper bound of the bytes of a primitive and its share of the acceleration structure.
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
            // The geometries as read, and their attributes in world space.
            scene: n_primitives as u64 * per_primitive as u64
                + (geometries.n_instances() * size_of::<Instance>()) as u64
                + 2 * geometries.n_bytes()
                + geometries.picture_bytes(),
            n_primitives,
            repeats: config.repeats,
        }
    }

    /// The sum of both.
    pub fn total(&self) -> u64 {
        self.film + self.scene
    }

    /// Checks that `available` bytes suffice, and that a hierarchy can hold all
    /// primitives.
    ///
    /// # Errors
    /// A fault of the section that needs most memory.
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
        let (section, what, advice) = if self.film > self.scene {
            ("image", "the image", self.image_advice())
        } else {
            (
                "objects",
                "the scene",
                "reduce the `count` of generators, or use smaller files",
            )
        };
        let gib = |bytes: u64| bytes as f64 / f64::from(1 << 30);
        Err(Fault::of_key(
            FieldPath::default().key(section),
            format!(
                "{what} is too large: {:.1} GiB of memory are needed, {:.1} GiB are free",
                gib(self.total()),
                gib(available)
            ),
            format!("needs {:.1} GiB", gib(self.film.max(self.scene))),
        )
        .with_help(advice))
    }

    fn image_advice(&self) -> &'static str {
        match self.repeats {
            Repeats::Auto | Repeats::ONCE => "choose a smaller `width` or `height`",
            Repeats::Exactly(_) => "choose a smaller `width` or `height`, or fewer `--repeats`",
        }
    }
}

/// Returns the fault of a hierarchy that turned out too large.
pub fn too_large(error: TooLarge) -> Fault {
    let objects = FieldPath::default().key("objects");
    Fault::of_key(objects, error.to_string(), "their hierarchy is too large")
        .with_help("reduce the `count` of generators, or use `acceleration: { quality: fast }`")
}
