//! Predicts the peak memory and the files of a rendering, for `raycost check`.
//!
//! The steps before the film are performed: the scene is read and its hierarchy built as for the
//! rendering. A small picture of the scene shows how many pixels have a hit, and some rows of the
//! picture how well it compresses.

use crate::estimate::{self, Memory};
use crate::look::Look;
use crate::sample::{Length, RowSample, small_picture};
use crate::writers::{self, Request};
use render::attribution::{Hierarchy, Visits};
use render::tiles::least_repeats;
use scene::config::{Config, Image, OptionalOutput};
use tracer::accel::{Accel, TooLarge};
use tracer::trace::Tracer;
use vtk::Codec;
use world::scene::Scene;

/// Bytes of the header of a VTK file of pixels, with its field data.
const HEADER: u64 = 6_000;
/// Bytes of `summary.json`.
const SUMMARY: u64 = 6_000;
/// Bytes of a tile in `tiles.vti` and `trace.json`.
const PER_TILE: u64 = 300;

/// The predicted resources of a rendering, and what its camera sees.
#[derive(Debug, Clone)]
pub struct Prediction {
    /// Resident memory at the peak, in bytes; `None` where the system does not report this
    /// process's.
    pub peak_memory: Option<u64>,
    /// The camera's view.
    pub look: Look,
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

impl Prediction {
    /// Predicts the rendering of a scene that was read and placed, on the current rayon pool. Builds
    /// the hierarchy and renders a small picture, and some rows.
    ///
    /// # Errors
    /// The hierarchy is too large.
    pub fn new(config: &Config, scene: &Scene, memory: &Memory) -> Result<Self, TooLarge> {
        let accel = Accel::build(scene, config.acceleration, &|_| {})?;
        let tracer = Tracer::new(scene, &accel);
        let peak_memory = memory.peak();
        let small = small_picture(config, tracer);
        let sample = RowSample::render(config, tracer);
        let Image { width, height, .. } = config.image;
        let n_pixels = config.image.n_pixels() as u64;
        let n_pieces = memory.band_rows.map_or(1, |rows| height.div_ceil(rows));
        // The cloud and the frame. Adjacent pieces of the frame share a row of pixels.
        let small_pixels = small.grid.width as usize * small.grid.height as usize;
        let hit_share = small.n_hits() as f64 / small_pixels as f64;
        let n_rows = height + n_pieces - 1;
        let sizes = sample.array_bytes((hit_share * n_pixels as f64) as u64, n_rows);
        let names = match n_pieces {
            1 => ["hits.vtu", "frame.vti"],
            _ => ["hits.pvtu", "frame.pvti"],
        };
        let of_pixels = names.into_iter().zip(sizes).map(|(name, size)| ArrayFile {
            name,
            n_bytes: u64::from(n_pieces) * HEADER + size,
            is_known: true,
        });
        let [texts, in_picture] = text_bytes(config, n_pieces > 1);
        let side = match n_pieces {
            1 => 1,
            _ => writers::map_side([width, height]),
        };
        Ok(Self {
            peak_memory,
            look: Look::new(&small, config, tracer),
            arrays: of_pixels.chain(attribution_files(config, tracer)).collect(),
            texts,
            pictures: sample.picture_bytes() + sample.map_bytes(side) + in_picture,
            layers: estimate::layer_bytes(config),
            tiles: u64::from(least_repeats(config)) * n_pixels * estimate::film_bytes(config),
        })
    }

    /// Returns the sum of the arrays whose size on the disk is known.
    pub fn known_array_bytes(&self) -> u64 {
        let known = self.arrays.iter().filter(|file| file.is_known);
        known.map(|file| file.n_bytes).sum()
    }
}

/// Returns the bytes of all text files, and the bytes of the state that the picture has a copy of.
fn text_bytes(config: &Config, is_stored: bool) -> [u64; 2] {
    let request = Request {
        config,
        is_profiled: false,
        vtkhdf: false,
        is_stored,
    };
    let wanted = writers::files().filter(|file| file.is_wanted(&request));
    let states = wanted.filter_map(|file| Some((file.name, writers::state_template(file.name)?)));
    let n_listed = if config.output.has(OptionalOutput::Schedule) {
        estimate::grid(config).n_tiles()
    } else {
        0
    };
    let mut texts = [SUMMARY + PER_TILE * u64::from(n_listed), 0];
    for (name, template) in states {
        texts[0] += template.len() as u64;
        if name == writers::GEOMETRY.name {
            texts[1] = template.len() as u64;
        }
    }
    texts
}

/// Predicts the files of the costs of primitives and nodes.
fn attribution_files(config: &Config, tracer: Tracer) -> Vec<ArrayFile> {
    let (scene, cost, none) = (tracer.scene, config.cost, Codec::None);
    let mut files = Vec::new();
    let mut add = |name, n_bytes| {
        files.push(ArrayFile {
            name,
            n_bytes,
            is_known: config.compress == none,
        });
    };
    if config.output.has(OptionalOutput::Surface) {
        let visits = vec![Visits::default(); scene.primitives.len()];
        let write = |out: &mut _| writers::write_surface(scene, &visits, cost, none, out);
        add("surface.vtu", Length::measure(write));
    }
    if config.output.has(OptionalOutput::Bvh) {
        let nodes = tracer.accel.nodes();
        let visits = vec![Visits::default(); nodes.len()];
        let hierarchy = &Hierarchy { nodes, visits };
        let (instances, space) = (scene.instances.as_ref(), scene.space);
        let limits = config.output.bvh;
        let write = |out: &mut _| {
            writers::write_nodes(hierarchy, instances, space, limits, cost, none, out)
        };
        add("bvh.vtu", Length::measure(write));
    }
    files
}
