//! `raycost merge`: the parts of a picture → all files of a rendering.

use std::path::{Path, PathBuf};

use super::RenderArguments;
use super::run_arguments::RunArguments;
use crate::cli::device::{DeviceChoice, parse_device};
use crate::cli::scene::SceneArguments;
use crate::cli::{Failure, refuse_file, shown};
use crate::job::{Tiles, read_parts};
use host::text::Diagnostic;
use render::checkpoint::{Header, PARTS, PartFiles};
use render::ranks::n_launched;
use tools::series::FRAMES;

/// Merge the parts of a picture that `raycost render --part` wrote
///
/// Checks that all parts are there, of the same scene, settings and program, and writes the
/// files that a rendering of the whole picture writes.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  raycost render configs/seed_sphere.yaml --part 1/2
  raycost render configs/seed_sphere.yaml --part 2/2
  raycost merge out/seed_sphere")]
pub(in crate::cli) struct MergeArguments {
    /// The output folder of the parts
    #[arg(value_name = "DIR")]
    folder: PathBuf,

    /// The scene's file, if it is not where it was
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,

    /// With the output `lanes`: trace the rays once more on this device, as `raycost render --device`
    /// does, so that its launches are in `lanes.csv`
    #[arg(long, value_name = "DEVICE", value_parser = parse_device)]
    device: Option<DeviceChoice>,

    #[command(flatten)]
    run: RunArguments,
}

pub(in crate::cli) fn run(arguments: &MergeArguments) -> Result<(), Failure> {
    if n_launched().is_some_and(|n| n > 1) {
        let message = "`raycost merge` is one process, and not several ranks";
        let help = "start it without `mpirun`";
        return Err(Diagnostic::new(message).with_help(help).into());
    }
    let folder = &arguments.folder;
    refuse_file(folder)?;
    let found = read_parts(folder)?;
    let in_frames = || {
        frames_with_parts(folder).into_iter().find_map(|frame| {
            let files = PartFiles::open(&folder.join(frame)).ok()?;
            files.header().cloned()
        })
    };
    let header = if found.is_empty() {
        in_frames()
    } else {
        found.header().cloned()
    };
    let Some(header) = header else {
        let shown = shown(folder);
        let message = if found.is_empty() {
            format!("`{shown}` has no parts: there is no `{PARTS}` with files of them")
        } else {
            format!("no file in `{shown}/{PARTS}` is whole")
        };
        let help = "render them with `raycost render SCENE --part 1/4 --out DIR`, and so on";
        return Err(Diagnostic::new(message).with_help(help).into());
    };
    drop(found);
    let arguments = RenderArguments {
        scene: scene_of(arguments, &header)?,
        device: arguments.device.clone(),
        run: arguments.run.clone(),
        ..RenderArguments::default()
    };
    super::render(&arguments, Tiles::Merged)
}

/// Returns the folders of frames with parts, in the folder of a series.
fn frames_with_parts(out: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(out.join(FRAMES)).into_iter().flatten();
    let names = entries
        .flatten()
        .map(|entry| Path::new(FRAMES).join(entry.file_name()));
    let mut folders: Vec<PathBuf> = names
        .filter(|folder| out.join(folder).join(PARTS).is_dir())
        .collect();
    folders.sort();
    folders
}

/// Returns the scene of the parts, with its settings.
fn scene_of(arguments: &MergeArguments, header: &Header) -> Result<SceneArguments, Diagnostic> {
    let path = arguments.scene.as_deref();
    let path = path.unwrap_or(Path::new(&header.scene));
    if !path.exists() {
        let message = format!("there is no scene `{}`", path.display());
        let help = format!(
            "its parts were rendered in `{}`: merge there, or give the file with `--scene`",
            header.folder
        );
        return Err(Diagnostic::new(message).with_help(help));
    }
    SceneArguments::from_flags(path, &header.flags, &arguments.folder)
}
