//! One picture of a job: a still, or a frame of an animation.

use std::path::{Path, PathBuf};

use super::tiles::{OtherTiles, PictureRun, TileFiles};
use super::{Finished, Observer, Tiles};
use crate::session::{Options, RenderError, Rendering, Scope};
use base::stop;
use host::folder::Written;
use output::summary::{FrameSection, Partial};
use render::tiles::Limits;

/// A picture whose files were written.
#[derive(Debug)]
pub struct FinishedPicture<'a> {
    /// The pixels and their cost.
    pub rendering: Rendering<'a>,
    /// The output folder, or the file of the picture.
    pub path: PathBuf,
    /// The files.
    pub written: Vec<Written>,
    /// The tiles of other runs.
    pub other_tiles: OtherTiles,
    /// The missing tiles, if the time was over.
    pub partial: Option<Partial>,
    /// True for a frame that keeps the hierarchy of an earlier one.
    pub keeps_hierarchy: bool,
}

impl FinishedPicture<'_> {
    /// Returns the number and the time of the frame; `None` for a still.
    pub fn frame(&self) -> Option<&FrameSection> {
        self.rendering.view(None).frame
    }
}

impl<'a> PictureRun<'a> {
    /// Renders the picture, or its part, and writes its files into a folder.
    pub(super) fn finish(
        self,
        path: &Path,
        observer: &dyn Observer,
    ) -> Result<Finished<'a>, RenderError> {
        let Self { job, session, .. } = self;
        if let Tiles::Part(part) = job.tiles {
            let done = self.render_part(part, path, observer)?;
            return Ok(Finished::Part(part, done, path.to_owned()));
        }
        let folder = session.folder(path)?.synced(job.sync);
        stop::check()?;
        let tiles = TileFiles::open(self, path)?;
        let on_event = |event| observer.event(event);
        let options = Options {
            // For an animation, all frames share one file each for cloud and frame.
            vtkhdf: job.options.vtkhdf && !session.is_frame(),
            ..job.options(&on_event)
        };
        let mut rendering = tiles.render(&options)?;
        let written = match tiles.stored().zip(session.bands()) {
            None => rendering.write_to(&folder, self.profiler)?,
            Some((checkpoint, rows)) => rendering
                .write_stored(&folder, self.profiler, checkpoint, rows, &options)
                .map_err(|error| error.or_kept(|| tiles.kept()))?,
        };
        let partial = rendering.partial();
        Ok(Finished::Picture(FinishedPicture {
            other_tiles: tiles.settle(partial)?,
            rendering,
            path: path.to_owned(),
            written,
            partial,
            keeps_hierarchy: false,
        }))
    }

    /// Renders the picture and writes nothing else, to this file.
    pub(super) fn finish_alone(
        self,
        file: &Path,
        observer: &dyn Observer,
    ) -> Result<Finished<'a>, RenderError> {
        let limits = Limits {
            team: self.team,
            ..Limits::default()
        };
        let scope = Scope {
            limits,
            ..Scope::default()
        };
        let on_event = |event| observer.event(event);
        let mut rendering = (self.session).render_within(&self.job.options(&on_event), &scope)?;
        let written = vec![rendering.write_picture(file)?];
        Ok(Finished::OnlyPicture(FinishedPicture {
            rendering,
            path: file.to_owned(),
            written,
            other_tiles: OtherTiles::default(),
            partial: None,
            keeps_hierarchy: false,
        }))
    }
}
