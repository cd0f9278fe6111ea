//! Errors of a rendering.

use std::path::PathBuf;
use std::{fmt, io};

use base::stop::{self, Stopped};
use device::DeviceError;
use host::folder::WriteError;
use host::text::Diagnostic;
use render::checkpoint::PicturePart;
use render::ranks::RankFailure;

/// Reasons why a scene was not rendered.
pub enum RenderError {
    /// A mistake in the scene.
    Scene(Diagnostic),
    /// The system refused a resource that the rendering needs, such as threads.
    Machine(Diagnostic),
    /// The rendering was canceled. The finished work is kept, if a job had begun to render.
    Stopped(Stopped, Option<Kept>),
    /// The observer of a job ended it.
    Observer(io::Error),
}

/// The finished work of a job that was stopped, with which another run continues.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Kept {
    /// No tile.
    Nothing,
    /// This many tiles, in this file.
    Tiles(u64, PathBuf),
    /// This many tiles of a part.
    PartTiles(u64, PicturePart),
    /// This many complete frames.
    Frames(u64),
}

impl RenderError {
    /// Returns the reason why another rank cannot render.
    pub(crate) fn from_rank(rank: &str, failure: &RankFailure) -> Self {
        let diagnostic = Diagnostic::new(format!("{rank} cannot render with the others"))
            .with_note(&*failure.message);
        let help = "all ranks need the same program, scene, flags and files";
        match failure.exit_code {
            2 => Self::Scene(diagnostic.with_help(help)),
            _ => Self::Machine(diagnostic),
        }
    }

    /// Returns the failure of a rank in the form that rank 0 prints.
    pub(crate) fn to_failure(&self) -> RankFailure {
        let (exit_code, message) = match self {
            Self::Scene(_) => (2, format!("{self:?}")),
            Self::Machine(_) | Self::Observer(_) => (1, format!("{self:?}")),
            Self::Stopped(stopped, _) => (stopped.exit_code(), String::new()),
        };
        RankFailure { exit_code, message }
    }

    /// Adds what is kept, if the rendering was canceled.
    pub(crate) fn or_kept(self, kept: impl FnOnce() -> Option<Kept>) -> Self {
        match self {
            Self::Stopped(stopped, _) => Self::Stopped(stopped, kept()),
            error => error,
        }
    }
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(diagnostic) | Self::Machine(diagnostic) => diagnostic.fmt(f),
            Self::Stopped(stopped, _) => stopped.fmt(f),
            Self::Observer(error) => error.fmt(f),
        }
    }
}

/// Prints the message after the word `Error:` of a `main` that returns it.
impl fmt::Debug for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(diagnostic) | Self::Machine(diagnostic) => fmt::Debug::fmt(diagnostic, f),
            Self::Stopped(stopped, _) => fmt::Display::fmt(stopped, f),
            Self::Observer(error) => fmt::Debug::fmt(error, f),
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
        Self::Stopped(stopped, None)
    }
}

impl From<WriteError> for RenderError {
    fn from(error: WriteError) -> Self {
        Self::Machine(Diagnostic::new(error.to_string()).with_help(error.help()))
    }
}

impl From<DeviceError> for RenderError {
    fn from(error: DeviceError) -> Self {
        match (stop::check(), error) {
            // A compilation or a launch was given up.
            (Err(stopped @ Stopped::Signal(_)), _) => stopped.into(),
            (_, DeviceError::Missing(message)) => Self::Scene(message),
            (_, DeviceError::Failed(message)) => Self::Machine(message),
        }
    }
}

impl From<io::Error> for RenderError {
    fn from(error: io::Error) -> Self {
        Self::Observer(error)
    }
}
