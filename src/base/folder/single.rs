//! A single file, replaced atomically.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::disk::change;
use super::error::WriteError;
use super::own::{is_marked, is_there};
use super::workspace::{self, Workspace};
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

/// Checks that a file can be written to this path. Follows symbolic links and returns the path of
/// the file itself.
///
/// # Errors
/// The path holds something that may not be replaced: a folder, a device, or a file of another
/// program.
pub fn target(path: &Path, replace: Replace) -> Result<PathBuf, WriteError> {
    let target = followed(path).map_err(|error| WriteError::new(path, error))?;
    is_there(&target, || match replace {
        Replace::Marked => is_marked(&target),
        Replace::Known => Ok(true),
    })?;
    Ok(target)
}

/// Writes a file, then moves it into place. It keeps the permissions of the file that it replaces.
///
/// # Errors
/// The errors of `write`, or an I/O error; then the old file is unchanged.
pub fn write_file(
    path: &Path,
    replace: Replace,
    write: impl FnOnce(&mut FileWriter) -> io::Result<()>,
) -> Result<Written, WriteError> {
    put(path, replace, |folder| {
        Written::write(folder, STAGED, write)
    })
}

/// Writes a file as [`write_file`] does, with a function that creates the file.
///
/// # Errors
/// As [`write_file`].
pub fn write_file_at(
    path: &Path,
    replace: Replace,
    write: impl FnOnce(&Path) -> io::Result<()>,
) -> Result<Written, WriteError> {
    put(path, replace, |folder| {
        Written::write_at(folder, STAGED, write)
    })
}

fn put(
    path: &Path,
    replace: Replace,
    stage: impl FnOnce(&Path) -> io::Result<Written>,
) -> Result<Written, WriteError> {
    let target = target(path, replace)?;
    let fail = |error| WriteError::new(path, error);
    let folder = match target.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let name = target.file_name().unwrap_or_default();
    workspace::remove_left_of(folder, name);
    let workspace = Workspace::create(folder, name).map_err(fail)?;
    let file = stage(&workspace.new_files()).map_err(fail)?;
    let staged = workspace.new_files().join(STAGED);
    if let Ok(at) = target.metadata() {
        change(|| fs::set_permissions(&staged, at.permissions())).map_err(fail)?;
    }
    change(|| fs::rename(&staged, &target)).map_err(fail)?;
    Ok(file)
}

/// Follows a chain of symbolic links; the last path need not exist.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..40 {
        match fs::read_link(&path) {
            Ok(link) => path = path.parent().unwrap_or(Path::new("")).join(link),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("too many levels of symbolic links"))
}
