//! The report of `raycost check` on a scene, for people.

use super::CheckedScene;
use crate::cli::run_summary::{notes, primitives};
use crate::cli::{hints, shown};
use crate::session::Frames;
use base::Keyword;
use base::numbers::{bytes, count, counted};
use host::text;
use output::estimate::Memory;
use output::limits;
use output::prediction::{ArrayFile, Prediction};
use render::schedule::TileGrid;
use render::tiles::most_repeats;
use scene::config::{Acceleration, Config, CostMode, FilmSettings, Image, Repeats, Tiling};
use world::color::{ToneCurve, Transfer};
use world::scene::Scene;

/// Returns the lines of the report.
pub(super) fn lines(checked: &CheckedScene) -> String {
    let CheckedScene {
        arguments,
        open,
        config,
        scene,
        memory,
        expected,
    } = checked;
    let frames = open
        .frames
        .as_ref()
        .map(|frames| ("frames", frames_of(frames, config)));
    let lines = [
        ("scene", format!("{} is fine", shown(&arguments.scene))),
        ("image", image(&config.image)),
        ("film", film(config)),
        ("objects", objects(config, scene)),
        ("light", light(config)),
        ("rays", rays(config)),
        ("cost", cost(config)),
        ("tiles", tiles(config)),
        ("memory", peak(config, memory, expected)),
        ("files", files(checked)),
        ("disk", disk(config, memory, expected)),
    ];
    // After the line about the scene.
    let (first, others) = lines.split_at(1);
    let lines = first.iter().chain(&frames).chain(others);
    let text: String = lines
        .map(|(name, text)| format!("{name:<8}{text}\n"))
        .collect();
    let text = text + &notes(config, scene) + &hints::lines(config, Some(expected.look));
    text::wrapped(&text).into_owned()
}

fn image(image: &Image) -> String {
    let Image {
        width,
        height,
        seed,
        ..
    } = image;
    let samples = image.samples();
    format!("{width} x {height} pixels, {samples} per pixel, seed {seed}")
}

fn objects(config: &Config, scene: &Scene) -> String {
    let n_objects = counted(config.objects.len() as u64, "object");
    format!("{n_objects} ({}), {}", kinds(config), primitives(scene))
}

fn light(config: &Config) -> String {
    format!(
        "{}, {}, up to {}",
        counted(config.lights.len() as u64, "light"),
        counted(config.materials.len() as u64, "material"),
        counted(u64::from(config.shading.max_depth), "bounce")
    )
}

fn rays(config: &Config) -> String {
    let structure = match config.acceleration {
        Acceleration::Bvh(quality) => format!("a BVH of {} quality", quality.name()),
        Acceleration::BruteForce => "brute force".to_owned(),
    };
    let up_to = match config.image.adaptive {
        None => "",
        Some(adaptive) if adaptive.noise.is_some() => "up to ",
        Some(_) => "about ",
    };
    let n_rays = count(config.image.n_camera_rays());
    format!("{up_to}{n_rays} from the camera, hits found by {structure}")
}

fn peak(config: &Config, memory: &Memory, expected: &Prediction) -> String {
    let peak = expected.peak_memory;
    let of_costs = match memory.attribution {
        0 => String::new(),
        n_bytes => format!(", its costs {}", bytes(n_bytes)),
    };
    let at_the_peak = peak.map(|peak| format!("about {} at the peak: ", bytes(peak)));
    format!(
        "{}film {}, scene {}, its build {}{}{}; at most {} beside the program, {} free",
        at_the_peak.unwrap_or_default(),
        bytes(memory.film),
        bytes(memory.scene),
        bytes(memory.build),
        of_costs,
        per_instance(config),
        bytes(memory.at_most()),
        bytes(limits::available())
    )
}

/// Returns the bytes of the files; before compression where the compressed ones are not predicted.
fn disk(config: &Config, memory: &Memory, disk: &Prediction) -> String {
    let list = |is_known: bool| {
        let files = disk.arrays.iter().filter(|file| file.is_known == is_known);
        let of_file = |file: &ArrayFile| format!("{} {}", file.name, bytes(file.n_bytes));
        let mut list: Vec<String> = files.map(of_file).collect();
        if !is_known && disk.layers > 0 {
            list.push(format!("image.exr {}", bytes(disk.layers)));
        }
        list.join(", ")
    };
    let [arrays, pictures] = [disk.known_array_bytes() + disk.texts, disk.pictures].map(bytes);
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
    let n_bytes = Memory::instance_bytes(config);
    format!(", {} for each instance", bytes(n_bytes))
}

/// Returns the number of frames, their times, and the rays of all.
fn frames_of(frames: &Frames, config: &Config) -> String {
    let n_frames = frames.n_frames();
    let n_rays = u64::from(n_frames) * config.image.n_camera_rays();
    let [first, last] = [0, n_frames - 1].map(|number| frames.frame(number).time);
    format!(
        "{}, times {first} to {last}, {} per second in the video; in all {} from the camera",
        counted(n_frames.into(), "frame"),
        frames.fps(),
        counted(n_rays, "ray"),
    )
}

/// Returns the files that would be written.
fn files(checked: &CheckedScene) -> String {
    let CheckedScene { config, memory, .. } = checked;
    let of_bands = memory.band_rows.map_or(String::new(), |n_rows| {
        let n_pieces = config.image.height.div_ceil(n_rows);
        format!(
            "; image.png; {} of {n_rows} rows for each of cloud and frame",
            counted(n_pieces.into(), "piece")
        )
    });
    let codec = (config.compress.label()).map(|codec| format!(", VTK files compressed by {codec}"));
    let codec = codec.unwrap_or_default();
    let (names, out) = (checked.files().join(", "), shown(&checked.folder()));
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
        curve => format!("tone curve {}", curve.name()),
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
                CostMode::SingleRayTime => "rays are traced one by one",
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
