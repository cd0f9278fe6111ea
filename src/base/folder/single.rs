//! A single file, replaced atomically.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::error::WriteError;
use super::own::{foreign, is_marked};
use super::staged::StagedFile;
use super::workspace::{self, Workspace};
use super::writer::FileWriter;
use super::{Written, disk};

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
    let fail = |error| WriteError::new(path, error);
    let target = followed(path).map_err(fail)?;
    match fs::symlink_metadata(&target) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(fail(error)),
        Ok(at) if !at.is_file() => return Err(foreign(&target)),
        Ok(_) if replace == Replace::Known => {}
        Ok(_) => match is_marked(&target) {
            Ok(true) => {}
            Ok(false) => return Err(foreign(&target)),
            Err(error) => return Err(fail(error)),
        },
    }
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
        StagedFile::write(folder, STAGED, write)
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
        StagedFile::write_at(folder, STAGED, write)
    })
}

fn put(
    path: &Path,
    replace: Replace,
    stage: impl FnOnce(&Path) -> io::Result<StagedFile>,
) -> Result<Written, WriteError> {
    let target = target(path, replace)?;
    let fail = |error| WriteError::new(path, error);
    let folder = match target.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let name = target.file_name().unwrap_or_default();
    workspace::remove_left_of_file(folder, name);
    let workspace = Workspace::create(folder, name).map_err(fail)?;
    let file = stage(&workspace.new_files()).map_err(fail)?;
    let staged = workspace.new_files().join(STAGED);
    if let Ok(at) = target.metadata() {
        disk::set_permissions(&staged, at.permissions()).map_err(fail)?;
    }
    disk::rename(&staged, &target).map_err(fail)?;
    Ok(file.written())
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
