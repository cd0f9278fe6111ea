//! `raycost check`.

use std::path::{Path, PathBuf};

use super::hints;
use super::open_scene::OpenScene;
use super::run_summary::{left_out, primitives};
use super::scene::SceneArguments;
use super::verify_output::{outputs_in, verified};
use super::{Failure, on_threads, shown, study};
use crate::session::{Frames, Input};
use base::stop;
use base::text::numbers::{bytes, count, counted, parse_bytes};
use base::text::{self, Diagnostic};
use output::memory::{self, Memory};
use output::prediction::{ArrayFile, DiskUse, Prediction};
use output::writers::{self, Request};
use render::schedule::TileGrid;
use render::tiles::most_repeats;
use scene::color::{ToneCurve, Transfer};
use scene::config::{Acceleration, Config, CostMode, FilmSettings, Image, Repeats, Tiling};
use scene::world::Scene;

/// Check scenes and studies without rendering them, or verify output folders
///
/// For a scene, prints what `raycost render` would do, and predicts its memory and disk. For a study, checks it and
/// its scenes, and prints how many runs it makes. For a folder that `raycost render` wrote, compares every file with
/// its length and checksum in summary.json. Of several, all are checked, and the exit code is the greatest.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  raycost check configs/seed_extended.yaml --width 3840 --height 2160
  raycost check configs/studies/tiles.yaml
  raycost check configs/*.yaml
  raycost check out/seed_extended")]
pub(super) struct CheckArguments {
    #[command(flatten)]
    scene: SceneArguments,

    /// Further scenes, studies or folders
    #[arg(value_name = "SCENE")]
    others: Vec<PathBuf>,

    /// Frame of an animated scene [default: the first]
    #[arg(long, value_name = "N")]
    frame: Option<u32>,

    /// The memory that `render` may use, such as 4G or 500M [default: three quarters of what is
    /// available]
    #[arg(long, value_name = "SIZE", value_parser = parse_bytes)]
    memory: Option<u64>,
}

impl CheckArguments {
    /// Checks a scene that a study measures, without printing a report. Returns the files that
    /// determine its picture.
    ///
    /// # Errors
    /// The first fault of the scene, or if it has many frames.
    pub(super) fn checked_files(&self) -> Result<Vec<PathBuf>, Diagnostic> {
        if let Some(word) = self.others.first() {
            let message = format!("`{}` in `flags` is not a flag", shown(word));
            return Err(Diagnostic::new(message).with_help("name further scenes in `scenes`"));
        }
        let scene = OpenScene::read(&self.scene)?;
        if scene.frames.is_some() {
            let message = format!("the scene {} is animated", shown(&self.scene.scene));
            return Err(Diagnostic::new(message)
                .with_help("a study measures stills: leave out `animation` and data series"));
        }
        placed(&scene, None)?;
        scene.files()
    }
}

pub(super) fn run(arguments: &CheckArguments) -> Result<(), Failure> {
    let mut failures = Vec::new();
    for scene in [&arguments.scene.scene]
        .into_iter()
        .chain(&arguments.others)
    {
        let mut one = arguments.clone();
        one.scene.scene = scene.clone();
        failures.extend(on_threads(|| check(&one)).err());
        stop::check()?;
    }
    match failures.pop() {
        None => Ok(()),
        Some(only) if failures.is_empty() => Err(only),
        Some(last) => {
            failures.push(last);
            Err(Failure::Several(failures))
        }
    }
}

fn check(arguments: &CheckArguments) -> Result<(), Failure> {
    if let Some(parts) = outputs_in(&arguments.scene.scene) {
        return verified(&arguments.scene.scene, &parts);
    }
    if let Some(limit) = arguments.memory {
        memory::set_limit(limit);
    }
    let source = arguments.scene.source()?;
    if study::is_study(&source) {
        if arguments.scene.changes_scene() {
            return Err(study::refuse_flags().into());
        }
        return Ok(text::print(&study::checked(&source)?)?);
    }
    let scene = OpenScene::of(&arguments.scene, source)?;
    let n_frames = scene.frames.as_ref().map_or(1, Frames::n_frames);
    for number in 0..n_frames {
        scene.at(number)?;
        stop::check()?;
    }
    let (config, mut placed, memory) = placed(&scene, arguments.frame)?;
    let expected = Prediction::of(&config, &mut placed, memory.band_rows)
        .map_err(|error| scene.point_at(memory::too_large(error)))?;
    stop::check()?;
    let report = report(arguments, &scene, &config, &placed, (&memory, &expected))
        + &left_out(&config.output)
        + &hints::lines(&config, &expected);
    Ok(text::print(&report)?)
}

/// Returns the config of a frame, or of a still, the scene in world space, and the memory of its
/// rendering.
fn placed(scene: &OpenScene, frame: Option<u32>) -> Result<(Config, Scene, Memory), Diagnostic> {
    let Input {
        document,
        config,
        geometries,
        memory,
        ..
    } = match scene.frames {
        None => scene.load(frame, Memory::of_still)?,
        Some(_) => scene.load(frame, Memory::of)?,
    };
    let placed = Scene::new(&config, geometries).map_err(|fault| document.point_at(fault))?;
    Ok((config, placed, memory))
}

fn report(
    arguments: &CheckArguments,
    open: &OpenScene,
    config: &Config,
    scene: &Scene,
    (memory, expected): (&Memory, &Prediction),
) -> String {
    let arguments = &arguments.scene;
    let frames = open
        .frames
        .as_ref()
        .map(|frames| ("frames", frames_of(frames, config)));
    let folder = match &open.frames {
        None => arguments.out(),
        Some(_) => arguments.out().join("frames/NNNN"),
    };
    let image = &config.image;
    let n_samples = image.n_pixels() as u64 * u64::from(image.samples_per_pixel);
    let structure = match config.acceleration {
        Acceleration::Bvh(quality) => format!("a BVH of {quality} quality"),
        Acceleration::BruteForce => "brute force".to_owned(),
    };
    let lines = [
        ("scene", format!("{} is fine", shown(&arguments.scene))),
        (
            "image",
            format!(
                "{} x {} pixels, {} per pixel, seed {}",
                image.width,
                image.height,
                image.samples(),
                image.seed
            ),
        ),
        ("film", film(config)),
        (
            "objects",
            format!(
                "{} ({}), {}",
                counted(config.objects.len() as u64, "object"),
                kinds(config),
                primitives(scene)
            ),
        ),
        (
            "light",
            format!(
                "{}, {}, up to {}",
                counted(config.lights.len() as u64, "light"),
                counted(config.materials.len() as u64, "material"),
                counted(u64::from(config.shading.max_depth), "bounce")
            ),
        ),
        (
            "rays",
            format!(
                "{}{} from the camera, hits found by {structure}",
                if image.adaptive.is_some() {
                    "up to "
                } else {
                    ""
                },
                count(n_samples)
            ),
        ),
        ("cost", cost(config)),
        ("tiles", tiles(config)),
        (
            "memory",
            format!(
                "{} {} (film {}, scene {}{}) beside the program, {} free",
                at_the_peak(expected),
                bytes(memory.total()),
                bytes(memory.film),
                bytes(memory.scene),
                per_instance(config),
                bytes(memory::available())
            ),
        ),
        ("files", files(config, memory, &folder)),
        ("disk", disk(config, memory, &expected.disk)),
    ];
    // After the line about the scene.
    let (first, others) = lines.split_at(1);
    let lines = first.iter().chain(&frames).chain(others);
    lines
        .map(|(name, text)| format!("{name:<8}{text}\n"))
        .collect()
}

/// Returns "about 159 MB at the peak; with at most", where the peak is known.
fn at_the_peak(expected: &Prediction) -> String {
    match expected.peak_memory {
        Some(peak) => format!("about {} at the peak; with at most", bytes(peak)),
        None => "up to".to_owned(),
    }
}

/// Returns the bytes of the files; before compression where the compressed ones are not predicted.
fn disk(config: &Config, memory: &Memory, disk: &DiskUse) -> String {
    let list = |is_known: bool| {
        let files = disk.arrays.iter().filter(|file| file.is_known == is_known);
        let of_file = |file: &ArrayFile| format!("{} {}", file.name, bytes(file.n_bytes));
        let mut list: Vec<String> = files.map(of_file).collect();
        if !is_known && disk.layers > 0 {
            list.push(format!("image.exr {}", bytes(disk.layers)));
        }
        list.join(", ")
    };
    let [arrays, pictures] = [disk.of_known_arrays() + disk.texts, disk.pictures].map(bytes);
    let codec = (config.compress.label()).map(|codec| format!(" compressed by {codec}"));
    let codec = codec.unwrap_or_default();
    let mut text = format!(
        "about {arrays} ({}{codec}), and {pictures} of pictures",
        list(true)
    );
    let unknown = list(false);
    if !unknown.is_empty() {
        text += &format!("; before compression {unknown}");
    }
    if memory.band_rows.is_some() {
        text += &format!("; until the end {} of tiles", bytes(disk.tiles));
    }
    text
}

/// Returns ", 512 bytes for each instance", in a scene that has some.
fn per_instance(config: &Config) -> String {
    if !config.has_instances() {
        return String::new();
    }
    let n_bytes = Memory::of_instance(config);
    format!(", {} for each instance", bytes(n_bytes))
}

/// Returns the number of frames, their times, and the rays of all.
fn frames_of(frames: &Frames, config: &Config) -> String {
    let n_frames = frames.n_frames();
    let image = &config.image;
    let n_samples = image.n_pixels() as u64 * u64::from(image.samples_per_pixel);
    let [first, last] = [0, n_frames - 1].map(|number| frames.frame(number).time);
    format!(
        "{}, times {first} to {last}, {} per second in the video; in all {} from the camera",
        counted(n_frames.into(), "frame"),
        frames.fps(),
        counted(u64::from(n_frames) * n_samples, "ray"),
    )
}

/// Returns the files that would be written.
fn files(config: &Config, memory: &Memory, out: &Path) -> String {
    let request = Request {
        vtkhdf: false,
        config,
        is_profiled: false,
        is_stored: memory.band_rows.is_some(),
    };
    let wanted = writers::files().filter(|file| file.is_wanted(&request));
    let names: Vec<&str> = wanted.map(|file| file.name).collect();
    let of_bands = memory.band_rows.map_or(String::new(), |n_rows| {
        let n_pieces = config.image.height.div_ceil(n_rows);
        format!(
            "; image.png; {} of {n_rows} rows for each of cloud and frame",
            counted(n_pieces.into(), "piece")
        )
    });
    let codec = (config.compress.label()).map(|codec| format!(", VTK files compressed by {codec}"));
    let codec = codec.unwrap_or_default();
    let (names, out) = (names.join(", "), shown(out));
    format!("{names}{of_bands} in {out}{codec}")
}

/// Describes how light would become the picture.
fn film(config: &Config) -> String {
    let film = &config.film;
    let transfer = match film.transfer(config.shading.model) {
        Transfer::Srgb => "encoded for sRGB",
        Transfer::Linear => "linear",
    };
    let curve = match film.tone_curve {
        ToneCurve::None => "no tone curve".to_owned(),
        curve => format!("tone curve {}", text::keyword_name(&curve)),
    };
    let FilmSettings { exposure, bits, .. } = film;
    format!("exposure {exposure}, {curve}, {transfer}, {bits} bits per channel")
}

/// Describes the tiles of the picture.
fn tiles(config: &Config) -> String {
    let Image { width, height, .. } = config.image;
    let Tiling { size, order } = config.tiles;
    let n_tiles = TileGrid::new(width, height, size).n_tiles();
    let n_tiles = counted(n_tiles.into(), "tile");
    format!(
        "{n_tiles} of {size} x {size} pixels in {} order",
        order.name()
    )
}

/// Describes the cost that would be measured, and how.
fn cost(config: &Config) -> String {
    match (config.cost, config.repeats) {
        (CostMode::None, _) => "none; rays are traced in streams".to_owned(),
        (CostMode::Counters, _) => "counters, no time; rays are traced in streams".to_owned(),
        (mode, repeats) => {
            let median = match repeats {
                Repeats::ONCE => String::new(),
                Repeats::Exactly(n) => format!(", the median of {n}"),
                Repeats::Auto => {
                    let most = most_repeats(config);
                    format!(", the median of up to {most} within half a second")
                }
            };
            let rays = match mode {
                CostMode::SingleRayTime => "each ray is traced alone",
                _ => "rays are traced and timed in streams",
            };
            format!("counters and time{median}; {rays}")
        }
    }
}

/// Returns the number of objects of each kind, such as "3 sphere, 1 plane", in the order of the
/// file.
fn kinds(config: &Config) -> String {
    let mut kinds: indexmap::IndexMap<String, u64> = indexmap::IndexMap::new();
    for object in &config.objects {
        *kinds.entry(object.geometry.to_string()).or_default() += 1;
    }
    let kinds: Vec<String> = kinds
        .iter()
        .map(|(kind, n)| format!("{} {kind}", count(*n)))
        .collect();
    kinds.join(", ")
}
