//! The system calls of a commit that change the disk. Tests make each of them fail, and kill the
//! process at each of them.

use std::fs::File;
use std::io;
use std::path::Path;

/// Runs a system call that changes the disk.
pub(super) fn change<T>(call: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    #[cfg(test)]
    super::tests::faults::fault()?;
    call()
}

/// Reserves space for a file of this length; the file does not change. Errors are ignored: either
/// the file system cannot reserve, or the write will fail too.
#[cfg(target_os = "linux")]
pub(super) fn reserve(file: &File, n_bytes: u64) {
    use rustix::fs::{FallocateFlags, fallocate};
    let _ = fallocate(file, FallocateFlags::KEEP_SIZE, 0, n_bytes);
}

#[cfg(not(target_os = "linux"))]
pub(super) fn reserve(_: &File, _: u64) {}

/// Flushes a file or a folder to the disk.
pub(super) fn sync(path: &Path) -> io::Result<()> {
    change(|| File::open(path)?.sync_all())
}

/// Exchanges the names of two folders of one file system atomically.
#[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
pub(super) fn exchange(one: &Path, other: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    change(|| Ok(renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE)?))
}

#[cfg(not(any(target_os = "linux", target_os = "android", target_vendor = "apple")))]
pub(super) fn exchange(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Copies owner and group of one folder to another.
#[cfg(unix)]
pub(super) fn set_owner(path: &Path, as_of: &std::fs::Metadata) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, chown};
    let owner = |of: &std::fs::Metadata| (of.uid(), of.gid());
    if owner(&path.metadata()?) == owner(as_of) {
        return Ok(());
    }
    change(|| chown(path, Some(as_of.uid()), Some(as_of.gid())))
}
