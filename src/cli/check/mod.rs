//! `raycost check`.

mod json;
mod report;

use std::path::PathBuf;

use serde::Serialize;

use super::scene::SceneArguments;
use super::verify_output::{outputs_in, verify_whole};
use super::{Failure, on_threads, shown, study};
use crate::job::OpenScene;
use crate::session::{Frames, Input};
use base::numbers::parse_bytes;
use base::stop;
use host::text::{self, Diagnostic};
use output::estimate::Memory;
use output::limits;
use output::prediction::Prediction;
use output::writers::{self, Request};
use scene::config::Config;
use world::scene::Scene;

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

    /// Print each report as a line of JSON; memory and disk are in bytes
    #[arg(long)]
    json: bool,

    /// Print the scene with all values, defaults included: a scene file of the same picture, for the
    /// folder of the scene
    #[arg(long, conflicts_with_all = ["json", "others", "crop"])]
    resolved: bool,
}

/// A scene without mistakes, placed, and what `raycost render` would need for it.
struct CheckedScene<'a> {
    arguments: &'a SceneArguments,
    open: &'a OpenScene<'a>,
    /// Of the still or the frame.
    config: Config,
    scene: Scene,
    memory: Memory,
    expected: Prediction,
}

impl CheckArguments {
    /// Refuses `--resolved` for another thing than a scene.
    fn refuse_resolved(&self, kind: &str) -> Result<(), Diagnostic> {
        if !self.resolved {
            return Ok(());
        }
        let message = format!("{} is {kind}, not a scene", shown(&self.scene.scene));
        Err(Diagnostic::new(message).with_help("leave out `--resolved`, which prints a scene"))
    }

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
        place(&scene, None)?;
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
    if let Some(parts) = outputs_in(&arguments.scene.scene)? {
        if arguments.scene.changes_scene() || arguments.frame.is_some() {
            let message = "the flags of a scene do not change an output folder";
            return Err(Diagnostic::new(message).with_help("leave them out").into());
        }
        arguments.refuse_resolved("an output folder")?;
        let whole = verify_whole(&arguments.scene.scene, &parts)?;
        return print(arguments, || whole.lines(), || whole.json());
    }
    if let Some(limit) = arguments.memory {
        limits::set_limit(limit);
    }
    let source = arguments.scene.source()?;
    if study::is_study(&source) {
        if arguments.scene.changes_scene() {
            return Err(study::refuse_flags().into());
        }
        arguments.refuse_resolved("a study")?;
        let study = study::check(&source)?;
        return print(arguments, || study.lines(), || study.json());
    }
    let scene = OpenScene::parse(&arguments.scene, source)?;
    let n_frames = scene.frames.as_ref().map_or(1, Frames::n_frames);
    for number in 0..n_frames {
        scene.at(number)?;
        stop::check()?;
    }
    if arguments.resolved {
        return Ok(text::print(&scene.resolved(arguments.frame)?)?);
    }
    let (config, placed, memory) = place(&scene, arguments.frame)?;
    let expected = Prediction::new(&config, &placed, &memory)
        .map_err(|error| scene.point_at(limits::too_large(error)))?;
    stop::check()?;
    let checked = CheckedScene {
        arguments: &arguments.scene,
        open: &scene,
        config,
        scene: placed,
        memory,
        expected,
    };
    print(
        arguments,
        || report::lines(&checked),
        || json::report(&checked),
    )
}

/// Prints a report in the wanted form.
fn print<R: Serialize>(
    arguments: &CheckArguments,
    lines: impl Fn() -> String,
    report: impl Fn() -> R,
) -> Result<(), Failure> {
    if arguments.json {
        super::json::print(&report())
    } else {
        Ok(text::print(&lines())?)
    }
}

impl CheckedScene<'_> {
    /// Returns the folder of the output; of an animation, the folder of a frame.
    fn folder(&self) -> PathBuf {
        let out = self.arguments.out();
        match &self.open.frames {
            None => out,
            Some(_) => out.join("frames/NNNN"),
        }
    }

    /// Returns the names of the files that would be written, except for the pieces of a picture
    /// larger than memory.
    fn files(&self) -> Vec<&'static str> {
        let request = Request {
            vtkhdf: false,
            config: &self.config,
            is_profiled: false,
            is_stored: self.memory.band_rows.is_some(),
        };
        let wanted = writers::files().filter(|file| file.is_wanted(&request));
        wanted.map(|file| file.name).collect()
    }
}

/// Returns the config of a frame, or of a still, the scene in render space, and the memory of its
/// rendering.
fn place(scene: &OpenScene, frame: Option<u32>) -> Result<(Config, Scene, Memory), Diagnostic> {
    let Input {
        document,
        config,
        geometries,
        memory,
        ..
    } = match scene.frames {
        None => scene.load(frame, Memory::estimate_still)?,
        Some(_) => scene.load(frame, Memory::estimate)?,
    };
    let placed =
        scene::build::scene(&config, geometries).map_err(|fault| document.point_at(fault))?;
    Ok((config, placed, memory))
}
