//! The tiles that a session renders.

use super::RenderError;
use host::text::Diagnostic;
use render::checkpoint::{CheckpointFailure, PicturePart};
use render::ranks::Team;
use render::tiles::{Limits, TilePlan};
use scene::build::Sensor;
use scene::config::Config;
use tracer::trace::Tracer;

/// The tiles that a rendering renders, takes over and keeps.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Scope<'a> {
    /// The part of the picture; `None` for the whole.
    pub(crate) part: Option<PicturePart>,
    /// The tiles of other runs, and the end.
    pub(crate) limits: Limits<'a>,
    /// True if the summary has a section of ranks although this process is the only one.
    pub(crate) is_only_rank: bool,
}

impl Scope<'_> {
    /// Returns the tiles in their order.
    pub(super) fn plan(&self, tracer: Tracer, config: &Config) -> TilePlan {
        let plan = TilePlan::new(tracer, &Sensor::new(tracer.scene, config), config.tiles);
        match (self.part, self.limits.team) {
            (Some(part), _) => plan.into_part(tracer, part),
            (None, Some(_)) => plan.most_expensive_first(tracer),
            (None, None) => plan,
        }
    }

    /// Checks that tiles could be read and kept.
    ///
    /// # Errors
    /// The reason if they could not.
    pub(super) fn check(&self) -> Result<(), RenderError> {
        if let Some((rank, failure)) = self.limits.team.and_then(Team::failure) {
            return Err(RenderError::from_rank(&rank, &failure));
        }
        let failure = self.limits.checkpoint.and_then(|kept| kept.failure());
        Err(match failure {
            None => return Ok(()),
            Some(CheckpointFailure::Write(error)) => {
                RenderError::Machine(Diagnostic::new(error.to_string()).with_help(error.help()))
            }
            Some(CheckpointFailure::Read(path)) => {
                let message = format!("cannot take over the tiles of `{}`", path.display());
                let help = "they do not fit the scene, or the file has changed: remove it";
                RenderError::Scene(Diagnostic::new(message).with_help(help))
            }
        })
    }
}
