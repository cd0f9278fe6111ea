//! The tiles of other runs that a rendering takes over, and the tiles that it keeps.

use std::fs;
use std::io;
use std::path::Path;

use super::picture_run::PictureRun;
use super::{RenderArguments, merge};
use crate::cli::{Failure, shell_word, shown};
use crate::session::{Options, Rendering, Scope, Session};
use base::numbers::{count, counted};
use host::folder::{WriteError, lock_folder, refuse_file};
use host::text::Diagnostic;
use output::summary::Partial;
use render::checkpoint::{Checkpoint, CheckpointFile, Damage, PicturePart};
use render::ranks::n_launched;
use render::tiles::Limits;

/// Name of the file of finished tiles, in the output folder until the output is complete.
pub(in crate::cli) const UNFINISHED: &str = "unfinished.tiles";

/// The rest of a sentence about such a file beside a complete output.
pub(in crate::cli) const OF_ANOTHER_RUN: &str =
    "of an interrupted run: `--resume` with its flags continues it, or remove it";

/// The source of the tiles of a picture that are finished, and the sink of new ones.
#[derive(Debug, Default)]
pub(super) struct Tiles {
    /// The part of the picture; `None` for the whole.
    part: Option<PicturePart>,
    checkpoint: Option<Checkpoint>,
    /// True if the pixels are only in the files of tiles: for a part, and for a picture that is larger
    /// than memory.
    is_stored: bool,
}

impl Tiles {
    /// Opens the tiles that a whole picture takes over: of all its parts, or of an interrupted run.
    ///
    /// # Errors
    /// If a file does not belong to the picture, or cannot be written.
    pub(super) fn of_picture(run: &PictureRun) -> Result<Self, Failure> {
        let PictureRun {
            arguments, session, ..
        } = *run;
        let path = run.out.join(UNFINISHED);
        let is_stored = session.bands().is_some();
        let checkpoint = if arguments.merges {
            Some(merge::parts(arguments, session, run.out)?)
        } else if arguments.resume || arguments.timeout.is_some() || is_stored {
            Some(kept(arguments, session, &path)?)
        } else {
            None
        };
        Ok(Self {
            part: None,
            checkpoint,
            is_stored,
        })
    }

    /// Takes the tiles of a part of a picture from a checkpoint, which keeps new ones.
    pub(super) fn of_part(part: PicturePart, checkpoint: Checkpoint) -> Self {
        Self {
            part: Some(part),
            checkpoint: Some(checkpoint),
            is_stored: true,
        }
    }

    /// Renders the tiles that are not finished.
    pub(super) fn render<'a>(
        &self,
        run: &PictureRun<'a>,
        options: &Options,
    ) -> Result<Rendering<'a>, Failure> {
        let rendering = run.session.render_within(options, &self.scope(run));
        rendering.map_err(|error| Failure::from(error).or_kept(|| self.kept(run.arguments)))
    }

    /// Returns the scope of a rendering by this process, or by all ranks of a team.
    fn scope<'a>(&'a self, run: &PictureRun<'a>) -> Scope<'a> {
        Scope {
            part: self.part,
            limits: Limits {
                checkpoint: self.checkpoint.as_ref(),
                deadline: run.deadline,
                team: run.team,
                is_stored: self.is_stored,
            },
            is_only_rank: !run.arguments.merges && n_launched() == Some(1),
        }
    }

    /// Returns the tiles, if the pixels are only in their files.
    pub(super) fn stored(&self) -> Option<&Checkpoint> {
        self.checkpoint.as_ref().filter(|_| self.is_stored)
    }

    /// Returns what a stopped rendering keeps, and how to continue; `None` if there is nothing to
    /// say.
    pub(super) fn kept(&self, arguments: &RenderArguments) -> Option<Diagnostic> {
        if arguments.run.quiet || arguments.merges {
            return None;
        }
        let Some(checkpoint) = self.checkpoint.as_ref() else {
            let help = "with `--resume`, an interrupted run goes on where it was";
            return Some(
                Diagnostic::new("stopped: nothing is kept of this picture").with_help(help),
            );
        };
        let n_tiles = counted(checkpoint.n_kept() as u64, "finished tile");
        if let Some(part) = self.part {
            let message = format!("stopped: kept {n_tiles} of part {part}");
            let help = "run the same command again: it goes on with the others";
            return Some(Diagnostic::new(message).with_help(help));
        }
        let file = shown(&arguments.scene.out().join(UNFINISHED));
        let message = format!("stopped: kept {n_tiles} in `{file}`");
        Some(Diagnostic::new(message).with_help(go_on(&arguments.scene.scene)))
    }

    /// Gives the complete file of a part its final name, flushed to the disk if `sync`.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn finish(self, path: &Path, sync: bool) -> Result<(), WriteError> {
        self.checkpoint
            .map_or(Ok(()), |checkpoint| checkpoint.finish(path, sync))
    }

    /// Removes the file of finished tiles if the output, which was written, is complete. Returns
    /// lines about tiles of other runs.
    ///
    /// # Errors
    /// If the file of this run cannot be removed.
    pub(super) fn settle(
        self,
        run: &PictureRun,
        partial: Option<Partial>,
    ) -> Result<String, WriteError> {
        let Some(checkpoint) = self.checkpoint.filter(Checkpoint::keeps) else {
            let header = || run.session.header(Vec::new(), None).ok();
            let is_used = |file: &CheckpointFile| {
                header().is_some_and(|header| file.header.foreign_to(&header).is_none())
            };
            return Ok(clear(run.out, is_used));
        };
        let mut lines = String::new();
        let n_restored = checkpoint.n_restored();
        if n_restored > 0 {
            let n_tiles = counted(n_restored as u64, "tile");
            lines += &format!("resumed {n_tiles} of an interrupted run\n");
        }
        if partial.is_none() {
            checkpoint.remove()?;
        }
        Ok(lines)
    }
}

/// Returns the line about missing tiles, and how to continue.
pub(super) fn partial_line(arguments: &RenderArguments, partial: Partial) -> String {
    let what = match partial.n_missing_tiles {
        0 => format!(
            "{} of {} renderings",
            partial.n_renderings, partial.n_renderings_asked
        ),
        n => format!(
            "{} of {} tiles are missing",
            count(n),
            count(partial.n_tiles)
        ),
    };
    format!("partial {what}: {}\n", go_on(&arguments.scene.scene))
}

/// Returns how to continue an incomplete picture of a scene.
pub(in crate::cli) fn go_on(scene: &Path) -> String {
    let scene = shell_word(scene);
    format!("go on with `raycost render {scene} --resume` and the same flags")
}

/// Opens the tiles of an interrupted run, and the file for new ones.
fn kept(
    arguments: &RenderArguments,
    session: &Session,
    path: &Path,
) -> Result<Checkpoint, Failure> {
    let header = session.header(arguments.scene.all_flags(), None)?;
    let found = open(path)?;
    let file = shown(path);
    match found {
        Some(found) if arguments.resume => {
            if let Some(why) = found.header.foreign_to(&header) {
                let message = format!("cannot go on with `{file}`: {why}");
                let help = "undo what has changed since, or remove the file to begin again";
                return Err(Diagnostic::new(message).with_help(help).into());
            }
            Ok(Checkpoint::resume(found)?)
        }
        Some(found) if found.n_tiles() > 0 => {
            let n_tiles = counted(found.n_tiles() as u64, "finished tile");
            let message = format!("`{file}` has {n_tiles} of an interrupted run");
            let help = "go on with `--resume`, or remove the file";
            Err(Diagnostic::new(message).with_help(help).into())
        }
        _ => Ok(Checkpoint::create(path, &header)?),
    }
}

/// Removes files that a run left in or beside a folder with a complete picture, if it was killed
/// after the folder was put in place. Returns the line about the tiles of another run.
pub(super) fn remove_left(folder: &Path) -> String {
    match lock_folder(folder) {
        Ok(_lock) => clear(folder, CheckpointFile::has_all_tiles),
        Err(_) => String::new(),
    }
}

/// Removes the file of finished tiles from the folder of a complete picture if it is of no further
/// use; ignores errors. Returns the line about a file that remains, which is of another picture.
fn clear(folder: &Path, is_used: impl Fn(&CheckpointFile) -> bool) -> String {
    let path = folder.join(UNFINISHED);
    if CheckpointFile::open(&path).is_ok_and(|file| is_used(&file)) {
        let _ = fs::remove_file(&path);
    }
    if !path.is_file() {
        return String::new();
    }
    let path = shown(&path);
    format!("kept    {path} {OF_ANOTHER_RUN}\n")
}

/// Opens a file of finished tiles; `None` if there is none, or no whole header.
///
/// # Errors
/// If another program wrote it, or another version of raycost, or it cannot be read.
pub(super) fn open(path: &Path) -> Result<Option<CheckpointFile>, Failure> {
    match CheckpointFile::open(path) {
        Ok(file) => Ok(Some(file)),
        Err(Damage::Foreign) if !is_empty(path) => Err(refuse_file(path).into()),
        Err(Damage::OtherFormat) => {
            let message = format!("another version of raycost wrote `{}`", path.display());
            Err(Diagnostic::new(message).with_help("remove the file").into())
        }
        Err(Damage::System(error)) if error.kind() != io::ErrorKind::NotFound => {
            Err(WriteError::new(path, error).into())
        }
        Err(_) => Ok(None),
    }
}

/// Returns true if a file has no bytes, as after a crash.
fn is_empty(path: &Path) -> bool {
    path.metadata()
        .is_ok_and(|found| found.is_file() && found.len() == 0)
}
