//! Errors of a rendering.

use std::fmt;

use base::stop::Stopped;
use host::text::Diagnostic;
use render::ranks::RankFailure;

/// Reasons why a scene was not rendered.
pub enum RenderError {
    /// A mistake in the scene.
    Scene(Diagnostic),
    /// The system refused a resource that the rendering needs, such as threads.
    Machine(Diagnostic),
    /// The rendering was canceled.
    Stopped(Stopped),
}

impl RenderError {
    /// Returns the reason why another rank cannot render.
    pub(crate) fn of_rank(rank: &str, failure: &RankFailure) -> Self {
        let diagnostic = Diagnostic::new(format!("{rank} cannot render with the others"))
            .with_note(&*failure.message);
        let help = "all ranks need the same program, scene, flags and files";
        match failure.exit_code {
            2 => Self::Scene(diagnostic.with_help(help)),
            _ => Self::Machine(diagnostic),
        }
    }
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(diagnostic) | Self::Machine(diagnostic) => diagnostic.fmt(f),
            Self::Stopped(stopped) => stopped.fmt(f),
        }
    }
}

/// Prints the message after the word `Error:` of a `main` that returns it.
impl fmt::Debug for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(diagnostic) | Self::Machine(diagnostic) => fmt::Debug::fmt(diagnostic, f),
            Self::Stopped(stopped) => fmt::Display::fmt(stopped, f),
        }
    }
}

impl std::error::Error for RenderError {}

impl From<Diagnostic> for RenderError {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::Scene(diagnostic)
    }
}

impl From<Stopped> for RenderError {
    fn from(stopped: Stopped) -> Self {
        Self::Stopped(stopped)
    }
}
