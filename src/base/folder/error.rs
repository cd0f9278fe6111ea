//! The error of a file or folder that was not written.

use std::fmt;
use std::io;
use std::path::PathBuf;

use crate::host::advice;
use crate::text::Diagnostic;

/// A file or folder that could not be written.
pub struct WriteError {
    path: PathBuf,
    error: io::Error,
    help: Option<&'static str>,
}

/// Why a folder that another run has locked is refused.
pub(super) const LOCKED: &str = "another run is writing to this folder";

impl WriteError {
    /// Creates the error of a failed operation on this file.
    pub fn new(path: impl Into<PathBuf>, error: io::Error) -> Self {
        Self {
            path: path.into(),
            error,
            help: None,
        }
    }

    /// Creates the error of a path that holds something that raycost did not write, or may not
    /// replace.
    pub fn refused(path: impl Into<PathBuf>, why: &'static str, help: &'static str) -> Self {
        Self {
            path: path.into(),
            error: io::Error::other(why),
            help: Some(help),
        }
    }

    /// Returns true if another run has locked the folder.
    pub(super) fn is_locked(&self) -> bool {
        self.help.is_some() && self.error.to_string() == LOCKED
    }

    /// Returns advice on how to correct it.
    pub fn help(&self) -> &'static str {
        if let Some(help) = self.help {
            return help;
        }
        match self.error.kind() {
            io::ErrorKind::FileTooLarge => {
                "raise the limit on a file's size (`ulimit -f`), or choose another folder with \
                 `--out`"
            }
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                "choose a folder that you may write to with `--out`"
            }
            _ => advice(&self.error).unwrap_or("choose another folder with `--out`"),
        }
    }
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot write `{}`: {}", self.path.display(), self.error)
    }
}

/// The message with its advice, as `main` prints it after `Error:`.
impl fmt::Debug for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let diagnostic = Diagnostic::new(self.to_string()).with_help(self.help());
        fmt::Debug::fmt(&diagnostic, f)
    }
}

impl std::error::Error for WriteError {}
