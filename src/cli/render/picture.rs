//! A whole picture: rendered, and written with the tiles of other runs.

use super::picture_run::PictureRun;
use super::tiles::Tiles;
use crate::cli::Failure;
use crate::cli::progress::Bars;
use crate::session::{Options, Rendering};
use base::stop;
use host::folder::Written;
use output::summary::Partial;

/// A picture whose files are written.
pub(super) struct FinishedPicture<'a> {
    pub(super) rendering: Rendering<'a>,
    pub(super) written: Vec<Written>,
    /// Lines about tiles of other runs.
    pub(super) of_tiles: String,
    /// The missing tiles.
    pub(super) partial: Option<Partial>,
}

impl<'a> FinishedPicture<'a> {
    /// Renders a whole picture and writes its files.
    pub(super) fn render(run: PictureRun<'a>) -> Result<Self, Failure> {
        let PictureRun {
            arguments, session, ..
        } = run;
        let folder = session.folder(run.out)?.synced(arguments.run.sync);
        stop::check()?;
        let tiles = Tiles::of_picture(&run)?;
        let bars = Bars::new(arguments.run.quiet);
        let on_event = |event| bars.show(event);
        let options = Options {
            // For an animation, all frames share one file each for cloud and frame.
            vtkhdf: arguments.run.format.is_some() && !session.is_frame(),
            ..arguments.options(&on_event)
        };
        let mut rendering = tiles.render(&run, &options)?;
        let written = match tiles.stored().zip(session.bands()) {
            None => rendering.write_to(&folder, run.profiler)?,
            Some(stored) => rendering
                .write_stored(&folder, run.profiler, stored, &options)
                .map_err(|error| Failure::from(error).or_kept(|| tiles.kept(arguments)))?,
        };
        let partial = rendering.partial();
        Ok(Self {
            of_tiles: tiles.settle(&run, partial)?,
            rendering,
            written,
            partial,
        })
    }
}
