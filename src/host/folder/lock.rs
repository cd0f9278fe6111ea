//! The lock of a folder or a file, held by one run at a time.
//!
//! It is an advisory lock (`flock`) on the folder itself: it leaves no file behind, and ends with
//! the process that holds it. A commit may give the folder's name to another folder, which the same
//! run has already locked: a lock is valid only if the name still belongs to the locked folder.

use std::fs::{self, File, Metadata, TryLockError};
use std::io;
use std::path::Path;

/// Maximum number of attempts to lock a folder that is being exchanged.
const N_TRIES: usize = 100;

/// A locked file or folder. The lock ends when this is dropped, also if a process that another thread
/// starts has a copy of the descriptor.
#[derive(Debug)]
pub struct Lock(File);

impl Lock {
    /// Locks an open file or folder; returns `None` if another run holds the lock.
    ///
    /// # Errors
    /// An I/O error; none on a file system without locks, where a run without a lock is better than
    /// none.
    pub fn take(file: File) -> io::Result<Option<Self>> {
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(error)) if error.kind() != io::ErrorKind::Unsupported => {
                Err(error)
            }
            _ => Ok(Some(Self(file))),
        }
    }

    /// Locks a file that was opened at this path; returns `None` if another run holds the lock, or has
    /// given the file another name meanwhile.
    ///
    /// # Errors
    /// The errors of [`take`](Self::take).
    pub fn take_at(path: &Path, file: File) -> io::Result<Option<Self>> {
        let lock = Self::take(file)?;
        Ok(lock.filter(|Self(file)| {
            let both = file
                .metadata()
                .and_then(|own| Ok((own, fs::symlink_metadata(path)?)));
            both.is_ok_and(|(own, other)| is_same(&own, &other))
        }))
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        let _ = self.0.unlock();
    }
}

/// Locks a folder; returns `None` if another run holds the lock.
///
/// # Errors
/// An I/O error.
pub(super) fn lock(folder: &Path) -> io::Result<Option<Lock>> {
    for _ in 0..N_TRIES {
        let Some(lock) = Lock::take(open(folder)?)? else {
            return Ok(None);
        };
        if is_same(&lock.0.metadata()?, &fs::metadata(folder)?) {
            return Ok(Some(lock));
        }
    }
    Ok(None)
}

/// Locks the folder of a process that was killed; `None` if it is in use, which is unknown on a file
/// system without locks.
pub(super) fn lock_left(folder: &Path) -> Option<Lock> {
    let file = open(folder).ok()?;
    file.try_lock().is_ok().then(|| Lock(file))
}

#[cfg(unix)]
fn open(folder: &Path) -> io::Result<File> {
    File::open(folder)
}

/// Opens a file in the folder, on systems that cannot open folders.
#[cfg(not(unix))]
fn open(folder: &Path) -> io::Result<File> {
    File::create(folder.join(".raycost-lock"))
}

/// Returns true if both are the same file or folder.
pub(super) fn is_same(one: &Metadata, other: &Metadata) -> bool {
    number_of(one) == number_of(other)
}

/// Returns the inode number of a file or folder; 0 where there are none.
pub(super) fn number_of(metadata: &Metadata) -> u64 {
    #[cfg(unix)]
    return std::os::unix::fs::MetadataExt::ino(metadata);
    #[cfg(not(unix))]
    return (0, metadata).0;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_locked_until_its_holder_ends() {
        let folder = tempfile::tempdir().unwrap();
        let first = lock(folder.path()).unwrap();
        assert!(first.is_some());
        assert!(lock(folder.path()).unwrap().is_none());
        drop(first);
        assert!(lock(folder.path()).unwrap().is_some());
    }

    #[test]
    fn a_lock_ends_though_its_descriptor_was_copied() {
        let folder = tempfile::tempdir().unwrap();
        let first = lock(folder.path()).unwrap().unwrap();
        let _of_another_process = first.0.try_clone().unwrap();
        drop(first);
        assert!(lock(folder.path()).unwrap().is_some());
    }

    #[test]
    fn a_lock_on_what_lost_its_name_does_not_count() {
        let temporary = tempfile::tempdir().unwrap();
        let (folder, away) = (temporary.path().join("a"), temporary.path().join("b"));
        fs::create_dir(&folder).unwrap();
        let first = lock(&folder).unwrap();
        assert!(first.is_some());
        fs::rename(&folder, &away).unwrap();
        fs::create_dir(&folder).unwrap();
        assert!(lock(&folder).unwrap().is_some());
    }
}
