//! The tiles of other runs that a rendering takes over, and the tiles that it keeps.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::merged;
use super::{Job, Tiles};
use crate::session::{Kept, Options, RenderError, Rendering, Scope, Session};
use base::numbers::counted;
use host::folder::{WriteError, lock_folder, refuse_file};
use host::text::{Diagnostic, shown};
use output::summary::Partial;
use render::checkpoint::{Checkpoint, CheckpointFile, Damage};
use render::instruments::Profiler;
use render::ranks::{Team, n_launched};
use render::tiles::Limits;

/// Name of the file of finished tiles, in the output folder until the output is complete.
pub(crate) const UNFINISHED: &str = "unfinished.tiles";

/// One picture that a job renders.
#[derive(Clone, Copy)]
pub(super) struct PictureRun<'a> {
    pub(super) job: &'a Job<'a>,
    pub(super) session: &'a Session,
    /// The moment after which no further tile is started.
    pub(super) deadline: Option<Instant>,
    pub(super) profiler: Option<&'a Profiler>,
    /// The ranks that render, if there are several.
    pub(super) team: Option<&'a Team<'a>>,
}

/// The tiles of other runs in an output folder.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct OtherTiles {
    /// Number of tiles that the picture took over from an interrupted run.
    pub n_resumed: u64,
    /// The file that an interrupted run of another picture has left.
    pub left: Option<PathBuf>,
}

/// The source of the tiles of a picture that are finished, and the sink of new ones.
pub(super) struct TileFiles<'a> {
    picture: PictureRun<'a>,
    /// The output folder of the picture.
    folder: PathBuf,
    checkpoint: Option<Checkpoint>,
    /// True if the pixels are only in the files of tiles: for a part, and for a picture that is
    /// larger than memory.
    is_stored: bool,
}

impl<'a> TileFiles<'a> {
    /// Opens the tiles that a whole picture takes over: of all its parts, or of an interrupted run.
    ///
    /// # Errors
    /// If a file does not belong to the picture, or cannot be written.
    pub(super) fn open(picture: PictureRun<'a>, folder: &Path) -> Result<Self, RenderError> {
        let PictureRun { job, session, .. } = picture;
        let is_stored = session.bands().is_some();
        let checkpoint = match job.tiles {
            Tiles::Merged => Some(merged::open(job, session, folder)?),
            Tiles::All if job.timeout.is_none() && !is_stored => None,
            _ => Some(open_kept(picture, &folder.join(UNFINISHED))?),
        };
        Ok(Self {
            picture,
            folder: folder.to_owned(),
            checkpoint,
            is_stored,
        })
    }

    /// Takes the tiles of a part of a picture from a checkpoint, which keeps new ones.
    pub(super) fn from_checkpoint(
        picture: PictureRun<'a>,
        folder: &Path,
        checkpoint: Checkpoint,
    ) -> Self {
        Self {
            picture,
            folder: folder.to_owned(),
            checkpoint: Some(checkpoint),
            is_stored: true,
        }
    }

    /// Renders the tiles that are not finished, by this process or by all ranks of a team.
    pub(super) fn render(&self, options: &Options) -> Result<Rendering<'a>, RenderError> {
        let PictureRun {
            job,
            session,
            deadline,
            team,
            ..
        } = self.picture;
        let scope = Scope {
            part: job.part(),
            limits: Limits {
                checkpoint: self.checkpoint.as_ref(),
                deadline,
                team,
                is_stored: self.is_stored,
            },
            is_only_rank: job.tiles != Tiles::Merged && n_launched() == Some(1),
        };
        let rendering = session.render_within(options, &scope);
        rendering.map_err(|error| error.or_kept(|| self.kept()))
    }

    /// Returns the tiles, if the pixels are only in their files.
    pub(super) fn stored(&self) -> Option<&Checkpoint> {
        self.checkpoint.as_ref().filter(|_| self.is_stored)
    }

    /// Returns what a stopped rendering keeps; `None` if it only takes over the tiles of parts.
    pub(super) fn kept(&self) -> Option<Kept> {
        let n_tiles = self.checkpoint.as_ref().map(|kept| kept.n_kept() as u64);
        Some(match (self.picture.job.tiles, n_tiles) {
            (Tiles::Merged, _) => return None,
            (_, None) => Kept::Nothing,
            (Tiles::Part(part), Some(n)) => Kept::PartTiles(n, part),
            (Tiles::All | Tiles::Missing, Some(n)) => Kept::Tiles(n, self.folder.join(UNFINISHED)),
        })
    }

    /// Gives the complete file of a part its final name, flushed to the disk if the job asks for it.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn finish(self, path: &Path) -> Result<(), WriteError> {
        let sync = self.picture.job.sync;
        (self.checkpoint).map_or(Ok(()), |checkpoint| checkpoint.finish(path, sync))
    }

    /// Removes the file of finished tiles if the output, which was written, is complete. Returns the
    /// tiles of other runs.
    ///
    /// # Errors
    /// If the file of this run cannot be removed.
    pub(super) fn settle(self, partial: Option<Partial>) -> Result<OtherTiles, WriteError> {
        let Some(checkpoint) = self.checkpoint.filter(Checkpoint::keeps) else {
            let header = self.picture.session.header(Vec::new(), None).ok();
            let is_used = |file: &CheckpointFile| {
                let header = header.as_ref();
                header.is_some_and(|header| file.header.foreign_to(header).is_none())
            };
            return Ok(clear(&self.folder, is_used));
        };
        let n_resumed = checkpoint.n_restored() as u64;
        if partial.is_none() {
            checkpoint.remove()?;
        }
        Ok(OtherTiles {
            n_resumed,
            left: None,
        })
    }
}

/// Opens the tiles of an interrupted run, and the file for new ones.
fn open_kept(picture: PictureRun, path: &Path) -> Result<Checkpoint, RenderError> {
    let PictureRun { job, session, .. } = picture;
    let header = session.header(job.scene.flags(), None)?;
    let file = shown(path);
    match open(path)? {
        Some(found) if job.tiles == Tiles::Missing => {
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
/// after the folder was put in place. Returns the tiles of another run.
pub(super) fn remove_left(folder: &Path) -> OtherTiles {
    match lock_folder(folder) {
        Ok(_lock) => clear(folder, CheckpointFile::has_all_tiles),
        Err(_) => OtherTiles::default(),
    }
}

/// Removes the file of finished tiles from the folder of a complete picture if it is of no further
/// use; ignores errors. Returns a file that remains, which is of another picture.
fn clear(folder: &Path, is_used: impl Fn(&CheckpointFile) -> bool) -> OtherTiles {
    let path = folder.join(UNFINISHED);
    if CheckpointFile::open(&path).is_ok_and(|file| is_used(&file)) {
        let _ = fs::remove_file(&path);
    }
    OtherTiles {
        n_resumed: 0,
        left: Some(path).filter(|path| path.is_file()),
    }
}

/// Opens a file of finished tiles; `None` if there is none, or no whole header.
///
/// # Errors
/// If another program wrote it, or another version of raycost, or it cannot be read.
pub(super) fn open(path: &Path) -> Result<Option<CheckpointFile>, RenderError> {
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
