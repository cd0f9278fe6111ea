//! A single file, replaced as a whole.

use std::fs;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use super::error::WriteError;
use super::own::{foreign, is_marked};
use super::staged::{StagedFile, SummedFile};
use super::workspace::{self, Workspace};
use super::{Written, disk};

/// Which files that are there may be replaced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Replace {
    /// Those that say that raycost wrote them.
    Marked,
    /// Any regular file: the caller knows that it is raycost's.
    Known,
}

/// The name of the file before it is whole.
const STAGED: &str = "file";

/// Makes sure that a file can be written to this path, and follows symbolic
/// links: gives the path of the file itself.
///
/// # Errors
/// What is there and may not be replaced: a folder, a device, someone else's
/// file.
pub(crate) fn target(path: &Path, replace: Replace) -> Result<PathBuf, WriteError> {
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

/// Writes a file, which takes its place when it is whole; one that was there
/// leaves it its permissions.
///
/// # Errors
/// What `write` or the system says; then an old file is still there.
pub(crate) fn write_file(
    path: &Path,
    replace: Replace,
    write: impl FnOnce(&mut BufWriter<SummedFile>) -> io::Result<()>,
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
    let file = StagedFile::write(&workspace.new_files(), STAGED, write).map_err(fail)?;
    let staged = workspace.new_files().join(STAGED);
    if let Ok(at) = target.metadata() {
        disk::set_permissions(&staged, at.permissions()).map_err(fail)?;
    }
    disk::rename(&staged, &target).map_err(fail)?;
    Ok(file.written())
}

/// Where a chain of symbolic links leads to, be there a file or not.
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
