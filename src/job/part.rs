//! Some tiles of a picture, in a file.

use std::fs;
use std::io;
use std::path::Path;
use std::time::Duration;

use super::tiles::{self, PictureRun, TileFiles};
use super::{Observer, PicturePart};
use crate::session::RenderError;
use host::files;
use host::folder::{Lock, WriteError, create_within};
use output::summary::Partial;
use render::checkpoint::{Checkpoint, CheckpointFile, PARTS};

/// The extension of a file that is not complete.
const UNFINISHED: &str = "unfinished";

/// The outcome of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartDone {
    /// Number of tiles rendered, and the time they took.
    Rendered(u64, Duration),
    /// The time is over before the part is complete.
    Partial(Partial),
    /// Already complete.
    Kept,
}

/// Gives a whole file its name, which no other run does meanwhile.
fn name_whole(unfinished: &Path, path: &Path, sync: bool) -> io::Result<()> {
    let file = files::open(unfinished)?;
    if sync {
        file.sync_all()?;
    }
    match Lock::take_at(unfinished, file)? {
        Some(_lock) => fs::rename(unfinished, path),
        None => Err(io::Error::other("another run is writing it")),
    }
}

impl PictureRun<'_> {
    /// Renders a part of the picture into the folder of parts of its output folder, unless it is
    /// there. Continues where an interrupted run of the same part ended.
    pub(super) fn render_part(
        self,
        part: PicturePart,
        out: &Path,
        observer: &dyn Observer,
    ) -> Result<PartDone, RenderError> {
        let header = self.session.header(self.job.scene.flags(), Some(part))?;
        let folder = create_within(out, Path::new(PARTS))?;
        let path = folder.join(part.file_name());
        let is_same = |file: &CheckpointFile| {
            file.header.part == header.part && file.header.foreign_to(&header).is_none()
        };
        let is_whole = |file: &CheckpointFile| file.is_complete && !file.is_torn;
        let whole = tiles::open(&path)?.filter(is_same);
        if whole.is_some_and(|file| is_whole(&file)) {
            return Ok(PartDone::Kept);
        }
        let unfinished = path.with_extension(UNFINISHED);
        let checkpoint = match tiles::open(&unfinished)?.filter(is_same) {
            // A run ended before it gave the whole file its name.
            Some(file) if is_whole(&file) => {
                name_whole(&unfinished, &path, self.job.sync)
                    .map_err(|error| WriteError::new(&path, error))?;
                return Ok(PartDone::Kept);
            }
            Some(file) if !file.is_complete => Checkpoint::resume(file)?,
            _ => Checkpoint::create(&unfinished, &header)?,
        };
        let tiles = TileFiles::from_checkpoint(self, out, checkpoint);
        let on_event = |event| observer.event(event);
        let rendering = tiles.render(&self.job.options(&on_event))?;
        if let Some(partial) = rendering.partial() {
            return Ok(PartDone::Partial(partial));
        }
        tiles.finish(&path)?;
        let n_tiles = rendering.schedule().rendered().count() as u64;
        Ok(PartDone::Rendered(
            n_tiles,
            rendering.stages().wall("render"),
        ))
    }
}
