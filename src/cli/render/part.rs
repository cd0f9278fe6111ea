//! `raycost render --part`: some tiles of a picture, in a file.

use std::path::Path;
use std::time::Duration;

use super::picture_run::PictureRun;
use super::tiles::{self, Tiles};
use crate::cli::progress::Bars;
use crate::cli::{Failure, shell_word, shown};
use base::numbers::{count, counted, duration};
use host::folder::create_within;
use output::summary::Partial;
use render::checkpoint::{Checkpoint, CheckpointFile, PARTS, PicturePart};

/// The extension of a file that is not complete.
const UNFINISHED: &str = "unfinished";

/// The outcome of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PartDone {
    /// Number of tiles rendered, and the time they took.
    Rendered(u64, Duration),
    /// The time is over before the part is complete.
    Partial(Partial),
    /// It was complete already.
    Kept,
}

impl PartDone {
    /// Returns a line about a part in an output folder.
    pub(super) fn line(self, part: PicturePart, out: &Path) -> String {
        let path = shown(&out.join(PARTS).join(part.file_name()));
        match self {
            Self::Rendered(n_tiles, wall) => {
                let (n_tiles, wall) = (counted(n_tiles, "tile"), duration(wall));
                format!("part    {part}: {n_tiles} in {wall}\nwrote   {path}\n")
            }
            Self::Partial(partial) => {
                let (n, of) = (count(partial.n_missing_tiles), count(partial.n_tiles));
                format!("part    {part}: partial, {n} of {of} tiles are missing; run it again\n")
            }
            Self::Kept => format!("part    {part}: complete from an earlier run, {path}\n"),
        }
    }
}

/// Returns the line about the step after all parts are complete.
pub(super) fn next_line(out: &Path) -> String {
    let out = shell_word(out);
    format!("next    raycost merge {out}, when all parts are there\n")
}

/// Renders a part of a picture into the folder of parts of its output folder, unless it is there.
/// Continues where an interrupted run of the same part ended.
pub(super) fn render(run: PictureRun, part: PicturePart) -> Result<PartDone, Failure> {
    let arguments = run.arguments;
    let header = run
        .session
        .header(arguments.scene.all_flags(), Some(part))?;
    let folder = create_within(run.out, Path::new(PARTS))?;
    let path = folder.join(part.file_name());
    let is_same = |file: &CheckpointFile| {
        file.header.part == header.part && file.header.foreign_to(&header).is_none()
    };
    let whole = tiles::open(&path)?.filter(is_same);
    if whole.is_some_and(|file| file.is_complete && !file.is_torn) {
        return Ok(PartDone::Kept);
    }
    let unfinished = path.with_extension(UNFINISHED);
    let checkpoint = match tiles::open(&unfinished)?.filter(is_same) {
        Some(file) if !file.is_complete => Checkpoint::resume(file)?,
        _ => Checkpoint::create(&unfinished, &header)?,
    };
    let tiles = Tiles::of_part(part, checkpoint);
    let bars = Bars::new(arguments.run.quiet);
    let on_event = |event| bars.show(event);
    let rendering = tiles.render(&run, &arguments.options(&on_event))?;
    if let Some(partial) = rendering.partial() {
        return Ok(PartDone::Partial(partial));
    }
    tiles.finish(&path, arguments.run.sync)?;
    let n_tiles = rendering.schedule().rendered().count() as u64;
    Ok(PartDone::Rendered(
        n_tiles,
        rendering.stages().wall("render"),
    ))
}
