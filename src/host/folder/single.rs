//! A single file, replaced atomically.

use std::fs;
use std::io;
use std::path::Path;

use super::disk::change;
use super::error::WriteError;
use super::listing::is_marked;
use super::own::is_there;
use super::workspace::{self, Workspace, retry_if_gone};
use super::writer::FileWriter;
use super::written::Written;

/// The existing files that may be replaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Replace {
    /// Files that contain raycost's mark.
    Marked,
    /// Any regular file: the caller knows that raycost wrote it.
    Known,
}

/// The name of the file while it is written.
const STAGED: &str = "file";

/// Checks that a file can be written to this path. A symbolic link is not followed.
///
/// # Errors
/// The path holds something that may not be replaced: a folder, a link, a device, or a file of
/// another program.
pub fn refuse_foreign_file(path: &Path, replace: Replace) -> Result<(), WriteError> {
    is_there(path, || match replace {
        Replace::Marked => is_marked(path),
        Replace::Known => Ok(true),
    })
    .map(drop)
}

/// Writes a file, then moves it into place. It keeps the permissions of the file that it replaces.
/// `write` is called again if another run exchanges the folder meanwhile.
///
/// # Errors
/// The errors of `write`, or an I/O error; then the old file is unchanged.
pub fn write_file(
    path: &Path,
    replace: Replace,
    write: impl Fn(&mut FileWriter) -> io::Result<()>,
) -> Result<Written, WriteError> {
    put(path, replace, |folder| {
        Written::write(folder, STAGED, &write)
    })
}

/// Writes a file as [`write_file`] does, with a function that creates the file.
///
/// # Errors
/// As [`write_file`].
pub fn write_file_at(
    path: &Path,
    replace: Replace,
    write: impl Fn(&Path) -> io::Result<()>,
) -> Result<Written, WriteError> {
    put(path, replace, |folder| {
        Written::write_at(folder, STAGED, &write)
    })
}

fn put(
    path: &Path,
    replace: Replace,
    stage: impl Fn(&Path) -> io::Result<Written>,
) -> Result<Written, WriteError> {
    refuse_foreign_file(path, replace)?;
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let name = path.file_name().unwrap_or_default();
    workspace::remove_left_of(folder, name);
    let put = || {
        let workspace = Workspace::create(folder, name)?;
        let file = stage(&workspace.place.new_files())?;
        let staged = workspace.place.new_files().join(STAGED);
        if let Ok(at) = path.metadata() {
            change(|| fs::set_permissions(&staged, at.permissions()))?;
        }
        change(|| fs::rename(&staged, path))?;
        Ok(file)
    };
    retry_if_gone(folder, put).map_err(|error| WriteError::new(path, error))
}
