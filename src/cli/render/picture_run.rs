//! What a run knows of each picture that it renders.

use std::path::Path;
use std::time::Instant;

use super::RenderArguments;
use crate::session::Session;
use render::instruments::Profiler;
use render::ranks::Team;

/// One picture of a run: a still, or a frame of an animation.
#[derive(Clone, Copy)]
pub(super) struct PictureRun<'a> {
    pub(super) arguments: &'a RenderArguments,
    pub(super) session: &'a Session,
    /// The output folder.
    pub(super) out: &'a Path,
    /// The moment after which no further tile is started.
    pub(super) deadline: Option<Instant>,
    pub(super) profiler: Option<&'a Profiler>,
    /// The ranks that render, if there are several.
    pub(super) team: Option<&'a Team<'a>>,
}
