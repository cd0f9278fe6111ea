//! The tiles of other runs that a rendering takes over, and the tiles that it keeps.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::{RenderArguments, merge};
use crate::cli::{Failure, shell_word, shown};
use crate::session::{Scope, Session};
use base::folder::{WriteError, lock_folder, refuse_file};
use base::text::Diagnostic;
use base::text::numbers::{count, counted};
use output::summary::Partial;
use render::checkpoint::{Checkpoint, CheckpointFile, Damage};
use render::ranks::Team;
use render::tiles::Limits;

/// Name of the file of finished tiles, in the output folder until the output is complete.
const UNFINISHED: &str = "unfinished.tiles";

/// The tiles of a whole picture.
#[derive(Debug, Default)]
pub(super) struct Tiles {
    checkpoint: Option<Checkpoint>,
    deadline: Option<Instant>,
    /// The file of an interrupted run that this one does not continue.
    left: Option<PathBuf>,
    /// True if the picture is larger than memory: its pixels are only in the files.
    is_stored: bool,
}

impl Tiles {
    /// Opens the tiles that a session's rendering takes over from files in its output folder. It
    /// ends at the deadline.
    ///
    /// # Errors
    /// If a file does not belong to the rendering, or cannot be written.
    pub(super) fn of(
        arguments: &RenderArguments,
        session: &Session,
        out: &Path,
        deadline: Option<Instant>,
    ) -> Result<Self, Failure> {
        let path = out.join(UNFINISHED);
        let is_stored = session.bands().is_some();
        let checkpoint = if arguments.merges {
            merge::parts(arguments, session, out)?
        } else if arguments.resume || arguments.timeout.is_some() || is_stored {
            kept(arguments, session, &path)?
        } else {
            return Ok(Self {
                left: Some(path).filter(|path| path.is_file()),
                ..Self::default()
            });
        };
        Ok(Self {
            checkpoint: Some(checkpoint),
            deadline,
            left: None,
            is_stored,
        })
    }

    /// Returns the scope of a rendering by this process, or by all ranks of a team.
    pub(super) fn scope<'a>(&'a self, team: Option<&'a Team<'a>>) -> Scope<'a> {
        Scope {
            limits: Limits {
                checkpoint: self.checkpoint.as_ref(),
                deadline: self.deadline,
                team,
                is_stored: self.is_stored,
            },
            ..Scope::default()
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
        let file = shown(&arguments.scene.out().join(UNFINISHED));
        let message = format!("stopped: kept {n_tiles} in `{file}`");
        Some(Diagnostic::new(message).with_help(go_on(arguments)))
    }

    /// Removes the file of finished tiles if the output, which was written, is complete. Returns
    /// lines about tiles of other runs.
    ///
    /// # Errors
    /// If the file cannot be removed.
    pub(super) fn settle(self, partial: Option<Partial>) -> Result<String, WriteError> {
        let mut lines = String::new();
        if let Some(left) = &self.left {
            let left = shown(left);
            lines += &format!("kept    {left} of an interrupted run: `--resume` continues it\n");
        }
        let Some(checkpoint) = self.checkpoint.filter(Checkpoint::keeps) else {
            return Ok(lines);
        };
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
    format!("partial {what}: {}\n", go_on(arguments))
}

/// Returns how to continue an incomplete picture.
fn go_on(arguments: &RenderArguments) -> String {
    let scene = shell_word(&arguments.scene.scene);
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
/// after the folder was put in place. Ignores errors.
pub(super) fn remove_left(folder: &Path) {
    // Other files of finished tiles belong to another picture.
    let path = folder.join(UNFINISHED);
    let is_used = |file: &CheckpointFile| file.has_all_tiles();
    if let Ok(_lock) = lock_folder(folder)
        && CheckpointFile::open(&path).is_ok_and(|file| is_used(&file))
    {
        let _ = fs::remove_file(path);
    }
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
