//! The files of a folder that raycost may replace.
//!
//! A rendering replaces the files that the `summary.json` of an earlier one lists. Other commands
//! replace files that contain raycost's mark. A file with one of raycost's names, but neither
//! listed nor marked, belongs to another program: raycost writes nothing to such a folder.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::SUMMARY;
use super::error::WriteError;
use super::listing::{is_marked, listed_in};
use super::workspace;

/// The names that a command writes or removes, and how raycost recognizes files of an earlier run.
#[derive(Debug, Clone)]
pub enum Own {
    /// The files listed in `summary.json`.
    Listed {
        /// The names that a rendering may write.
        names: Vec<String>,
        /// True for the names of numbered files, of which an earlier run may have written more or
        /// fewer.
        is_numbered: fn(&str) -> bool,
    },
    /// Files that contain the key of a run's ID.
    Marked(Vec<&'static str>),
}

impl Own {
    /// Returns the names that exist in the folder.
    ///
    /// # Errors
    /// The first file that belongs to another program.
    pub(super) fn find(&self, folder: &Path) -> Result<Vec<String>, WriteError> {
        let (names, listed): (Vec<_>, _) = match self {
            Self::Listed { names, is_numbered } => {
                let listed = read_listed(folder);
                let is_other = |name: &&String| is_numbered(name) && !names.contains(name);
                let others = listed.iter().filter(is_other);
                (names.iter().chain(others).cloned().collect(), Some(listed))
            }
            Self::Marked(names) => (names.iter().map(ToString::to_string).collect(), None),
        };
        let is_own = |name: &String, path: &Path| match &listed {
            Some(listed) => Ok(listed.contains(name)),
            None => is_marked(path),
        };
        let mut found = Vec::new();
        for name in names {
            let path = folder.join(&name);
            if is_there(&path, || is_own(&name, &path))? {
                found.push(name);
            }
        }
        Ok(found)
    }
}

/// Returns true if the path has a regular file that `is_own`, and false if it has nothing.
///
/// # Errors
/// The path has something else, or an I/O error.
pub(super) fn is_there(
    path: &Path,
    is_own: impl FnOnce() -> io::Result<bool>,
) -> Result<bool, WriteError> {
    let fail = |error| WriteError::new(path, error);
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(fail(error)),
        Ok(at) if at.is_file() && is_own().map_err(fail)? => Ok(true),
        Ok(_) => Err(foreign(path)),
    }
}

/// Creates the error for a file of another program.
pub fn foreign(path: &Path) -> WriteError {
    let why = match fs::symlink_metadata(path) {
        Ok(at) if at.is_dir() => "a folder of this name is in the way",
        Ok(at) if at.is_symlink() => "a symbolic link of this name is in the way",
        Ok(at) if !at.is_file() => "it is not a regular file",
        _ => "raycost did not write the file that is there",
    };
    let help = if path.is_file() {
        "move it away, or choose another place with `--out`"
    } else {
        "choose another place with `--out`"
    };
    WriteError::refused(path, why, help)
}

/// Returns the names that the folder's summary lists, and the summary's own. Without it, the names of
/// an unfinished replacement: old files that were not moved away, new ones that were moved in.
fn read_listed(folder: &Path) -> Vec<String> {
    let summary = folder.join(SUMMARY);
    if summary.exists() {
        return listed_in(&summary);
    }
    let moved_of = |summary: PathBuf| {
        let names = listed_in(&summary).into_iter();
        names.filter(move |name| !summary.with_file_name(name).exists())
    };
    workspace::summaries_in(folder).flat_map(moved_of).collect()
}
