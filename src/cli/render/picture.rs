//! A whole picture: rendered, and written with the tiles of other runs.

use std::path::Path;
use std::time::Instant;

use super::RenderArguments;
use super::tiles::Tiles;
use crate::cli::Failure;
use crate::cli::progress::Bars;
use crate::session::{Options, Rendering, Scope, Session};
use base::folder::Written;
use base::stop;
use output::summary::Partial;
use render::instruments::Profiler;
use render::ranks::{Team, n_launched};

/// A picture whose files are written.
pub(super) struct FinishedPicture<'a> {
    pub(super) rendering: Rendering<'a>,
    pub(super) written: Vec<Written>,
    /// Lines about tiles of other runs.
    pub(super) of_tiles: String,
    /// The missing tiles.
    pub(super) partial: Option<Partial>,
}

/// The deadline, the profiler and the ranks of a rendering.
#[derive(Clone, Copy, Default)]
pub(super) struct Until<'a> {
    pub(super) deadline: Option<Instant>,
    pub(super) profiler: Option<&'a Profiler>,
    /// The ranks that render, if there are several.
    pub(super) team: Option<&'a Team<'a>>,
}

impl<'a> FinishedPicture<'a> {
    /// Renders a session's picture and writes its files into a folder.
    pub(super) fn render(
        arguments: &RenderArguments,
        session: &'a Session,
        out: &Path,
        until: Until,
    ) -> Result<Self, Failure> {
        let folder = session.folder(out)?.synced(arguments.run.sync);
        stop::check()?;
        let tiles = Tiles::of(arguments, session, out, until.deadline)?;
        let bars = Bars::new(arguments.run.quiet);
        let on_event = |event| bars.show(event);
        let options = Options {
            // For an animation, all frames share one file each for cloud and frame.
            vtkhdf: arguments.run.format.is_some() && !session.is_frame(),
            ..arguments.options(&on_event)
        };
        let scope = Scope {
            is_only_rank: !arguments.merges && n_launched() == Some(1),
            ..tiles.scope(until.team)
        };
        let or_kept = |error| Failure::from(error).or_kept(|| tiles.kept(arguments));
        let mut rendering = session.render_within(&options, &scope).map_err(or_kept)?;
        let written = match tiles.stored().zip(session.bands()) {
            None => rendering.write_to(&folder, until.profiler)?,
            Some(stored) => rendering
                .write_stored(&folder, until.profiler, stored, &options)
                .map_err(or_kept)?,
        };
        let partial = rendering.partial();
        Ok(Self {
            of_tiles: tiles.settle(partial)?,
            rendering,
            written,
            partial,
        })
    }
}
