//! `raycost merge`: the parts of a picture → all files of a rendering.

use std::path::{Path, PathBuf};

use super::RenderArguments;
use super::run_arguments::RunArguments;
use crate::cli::scene::SceneArguments;
use crate::cli::{Failure, refuse_file, shell_word, shown};
use crate::session::Session;
use host::text::Diagnostic;
use render::checkpoint::{Checkpoint, Header, PARTS, PartFaults, PartFiles, PicturePart};
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
    let found = open(folder)?;
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
        merges: true,
        run: arguments.run.clone(),
        ..RenderArguments::default()
    };
    super::render_scene(&arguments, None)
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
    SceneArguments::of_flags(path, &header.flags, &arguments.folder)
}

fn open(folder: &Path) -> Result<PartFiles, Diagnostic> {
    PartFiles::open(folder).map_err(|error| {
        let message = format!("cannot read the parts in `{}`: {error}", folder.display());
        Diagnostic::new(message)
    })
}

/// Opens the tiles of all parts of a session's picture in an output folder.
///
/// # Errors
/// If the parts do not belong to the picture.
pub(super) fn parts(
    arguments: &RenderArguments,
    session: &Session,
    out: &Path,
) -> Result<Checkpoint, Diagnostic> {
    let found = open(out)?;
    let expected = session.header(arguments.scene.all_flags(), None)?;
    if let Some(why) = found
        .header()
        .and_then(|header| header.foreign_to(&expected))
    {
        let message = format!("the parts in `{}` do not fit: {why}", out.display());
        let help = "undo what has changed since, or render all parts again";
        return Err(Diagnostic::new(message).with_help(help));
    }
    let parts = found.checked(&expected);
    let parts = parts.map_err(|faults| arguments.refused(&faults, &expected, out))?;
    Ok(Checkpoint::of_parts(parts))
}

impl RenderArguments {
    /// Returns the message about parts that do not form a picture.
    fn refused(&self, faults: &PartFaults, expected: &Header, out: &Path) -> Diagnostic {
        let message = format!("the parts in `{}` make no picture", out.display());
        let refused = Diagnostic::new(message).with_note(faults.lines.join("\n"));
        let parts: Vec<PicturePart> = faults.again.iter().copied().collect();
        match &parts[..] {
            [] => refused.with_help("remove the files that do not belong there"),
            [first, others @ ..] => {
                let frame = expected.frame.map(|frame| format!(" --frames {frame}"));
                let flags = expected
                    .flags
                    .iter()
                    .map(|flag| shell_word(Path::new(flag)));
                let words = [shell_word(Path::new(&expected.scene))]
                    .into_iter()
                    .chain(flags);
                let words: Vec<String> = words.collect();
                let out = shell_word(&self.scene.out());
                let command = format!(
                    "raycost render {} --out {out}{} --part {first}",
                    words.join(" "),
                    frame.unwrap_or_default(),
                );
                let others: Vec<String> = others.iter().map(PicturePart::to_string).collect();
                let others = match others.len() {
                    0 => String::new(),
                    _ => format!(", and so the parts {}", others.join(", ")),
                };
                refused.with_help(format!("render again: `{command}`{others}"))
            }
        }
    }
}
