//! The error of a file or folder that was not written.

use std::fmt;
use std::io;
use std::path::PathBuf;

use crate::advice;
use crate::text::Diagnostic;

/// A file or folder that could not be written.
pub struct WriteError {
    message: String,
    help: &'static str,
}

impl WriteError {
    /// Creates the error of a failed operation on this file.
    pub fn new(path: impl Into<PathBuf>, error: io::Error) -> Self {
        let help = match error.kind() {
            io::ErrorKind::FileTooLarge => {
                "raise the limit on a file's size (`ulimit -f`), or choose another folder with \
                 `--out`"
            }
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                "choose a folder that you may write to with `--out`"
            }
            _ => advice(&error).unwrap_or("choose another folder with `--out`"),
        };
        Self::refused(path, error.to_string(), help)
    }

    /// Creates the error of a path that holds something that raycost did not write, or may not
    /// replace.
    pub fn refused(path: impl Into<PathBuf>, why: impl fmt::Display, help: &'static str) -> Self {
        let message = format!("cannot write `{}`: {why}", path.into().display());
        Self { message, help }
    }

    /// Returns advice on how to correct it.
    pub fn help(&self) -> &'static str {
        self.help
    }
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// The message with its advice, as `main` prints it after `Error:`.
impl fmt::Debug for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&Diagnostic::new(&self.message).with_help(self.help), f)
    }
}

impl std::error::Error for WriteError {}
