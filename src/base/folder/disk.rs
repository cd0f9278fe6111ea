//! All system calls of a commit that change the disk. Tests make each of them fail, and kill the
//! process at each of them.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

pub(super) fn create_dir(path: &Path) -> io::Result<()> {
    fault()?;
    fs::create_dir(path)
}

/// Creates a folder that only this user may open.
pub(super) fn create_private_dir(path: &Path) -> io::Result<()> {
    fault()?;
    let mut builder = fs::DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(path)
}

/// Creates a file; fails if it exists.
pub(super) fn create_file(path: &Path) -> io::Result<File> {
    fault()?;
    File::create_new(path)
}

/// Writes to an open file.
pub(super) fn write(mut file: &File, bytes: &[u8]) -> io::Result<usize> {
    fault()?;
    file.write(bytes)
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

pub(super) fn rename(from: &Path, to: &Path) -> io::Result<()> {
    fault()?;
    fs::rename(from, to)
}

pub(super) fn hard_link(original: &Path, link: &Path) -> io::Result<()> {
    fault()?;
    fs::hard_link(original, link)
}

pub(super) fn remove_file(path: &Path) -> io::Result<()> {
    fault()?;
    fs::remove_file(path)
}

pub(super) fn remove_dir(path: &Path) -> io::Result<()> {
    fault()?;
    fs::remove_dir(path)
}

pub(super) fn set_permissions(path: &Path, permissions: fs::Permissions) -> io::Result<()> {
    fault()?;
    fs::set_permissions(path, permissions)
}

/// Flushes a file or a folder to the disk.
pub(super) fn sync(path: &Path) -> io::Result<()> {
    fault()?;
    File::open(path)?.sync_all()
}

/// Exchanges the names of two folders of one file system atomically.
#[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
pub(super) fn exchange(one: &Path, other: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    fault()?;
    Ok(renameat_with(CWD, one, CWD, other, RenameFlags::EXCHANGE)?)
}

#[cfg(not(any(target_os = "linux", target_os = "android", target_vendor = "apple")))]
pub(super) fn exchange(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Copies owner and group of one folder to another.
#[cfg(unix)]
pub(super) fn set_owner(path: &Path, as_of: &fs::Metadata) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, chown};
    let now = path.metadata()?;
    if (now.uid(), now.gid()) == (as_of.uid(), as_of.gid()) {
        return Ok(());
    }
    fault()?;
    chown(path, Some(as_of.uid()), Some(as_of.gid()))
}

#[cfg(not(unix))]
pub(super) fn set_owner(_: &Path, _: &fs::Metadata) -> io::Result<()> {
    Ok(())
}

#[cfg(not(test))]
#[inline]
fn fault() -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
use faults::fault;

/// Faults that tests inject into the calls.
#[cfg(test)]
pub(super) mod faults {
    use std::cell::Cell;
    use std::io;

    /// The fault of a call.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub(in crate::folder) enum DiskFault {
        /// The process is killed: neither this call nor any later one changes
        /// the disk.
        Kill,
        /// The call fails with this error, later ones do not.
        Error(i32),
        /// The call and all later ones fail with this error.
        Errors(i32),
    }

    thread_local! {
        static PLAN: Cell<Option<(usize, DiskFault)>> = const { Cell::new(None) };
        static N_CALLS: Cell<usize> = const { Cell::new(0) };
    }

    /// Runs `work` and injects the fault into the call with this number; also returns the number of
    /// calls.
    pub(in crate::folder) fn with<T>(
        number: usize,
        fault: DiskFault,
        work: impl FnOnce() -> T,
    ) -> (T, usize) {
        N_CALLS.set(0);
        PLAN.set(Some((number, fault)));
        let done = work();
        PLAN.set(None);
        (done, N_CALLS.get())
    }

    pub(super) fn fault() -> io::Result<()> {
        let Some((number, fault)) = PLAN.get() else {
            return Ok(());
        };
        let n = N_CALLS.get();
        N_CALLS.set(n + 1);
        match fault {
            DiskFault::Kill if n >= number => Err(io::Error::other("killed")),
            DiskFault::Error(code) if n == number => Err(io::Error::from_raw_os_error(code)),
            DiskFault::Errors(code) if n >= number => Err(io::Error::from_raw_os_error(code)),
            _ => Ok(()),
        }
    }
}
