//! A temporary folder for new files, in or beside the folder that gets them.
//!
//! Its name is `.raycost-<hash>-<random>`, with a hash of the output folder's name. It contains
//! `new-<number>` with the new files. During a commit it also contains `old-<number>` with old files
//! that are replaced one by one, or `exchanged-<number>`, which has exchanged its name with the output
//! folder, or is about to. The number is the inode number of the workspace itself: a copy or a clone
//! has another, so raycost ignores the content of a workspace that was not made here.
//!
//! The process that creates a workspace locks it: one that is not locked belongs to a killed
//! process. (All remain where the file system has no locks.) Of this, only files directly in these
//! folders are removed, and in `exchanged-<number>`, which may have files of others, only those that
//! raycost wrote or that have another name elsewhere. Nothing in it says what to move or remove
//! elsewhere.

use std::ffi::OsStr;
use std::fs::{self, Metadata};
use std::io;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use rayon::prelude::*;

use super::SUMMARY;
use super::disk::change;
use super::listing::{is_marked, listed_in};
use super::lock::{Lock, lock, lock_left, number_of};
use crate::provenance::checksum;

/// The prefix of the names of all workspaces.
const PREFIX: &str = ".raycost-";
/// Maximum number of attempts to create files in a folder that is being exchanged.
const N_TRIES: usize = 100;

/// A temporary folder, removed when dropped.
#[derive(Debug)]
pub(super) struct Workspace {
    pub(super) place: WorkspacePlace,
    /// The lock, held while the workspace is in use.
    lock: Option<Lock>,
    /// True if it remains when dropped.
    pub(super) remains: bool,
}

/// The paths of a workspace.
#[derive(Debug)]
pub(super) struct WorkspacePlace {
    pub(super) path: PathBuf,
    /// Its inode number.
    number: u64,
}

impl Workspace {
    /// Creates a workspace in `parent` for the files of a folder with this name. Another run may take
    /// one that is not locked yet for a killed run's and remove it; then this creates another.
    pub(super) fn create(parent: &Path, folder_name: &OsStr) -> io::Result<Self> {
        retry_if_gone(parent, || {
            let mut private = fs::DirBuilder::new();
            #[cfg(unix)]
            std::os::unix::fs::DirBuilderExt::mode(&mut private, 0o700);
            let made = tempfile::Builder::new()
                .prefix(&prefix(folder_name))
                .make_in(parent, |path| change(|| private.create(path)))?;
            let path = made.into_parts().1.keep()?;
            let number = number_of(&path.metadata()?);
            let mut this = Self {
                place: WorkspacePlace { path, number },
                lock: None,
                remains: false,
            };
            // A run that removes it holds the lock.
            let locked = lock(&this.place.path)?;
            this.lock = Some(locked.ok_or(io::ErrorKind::NotFound)?);
            change(|| fs::create_dir(this.place.new_files()))?;
            Ok(this)
        })
    }

    /// Moves the workspace to another parent.
    pub(super) fn move_to(&mut self, parent: &Path) -> io::Result<()> {
        let path = parent.join(self.place.path.file_name().unwrap_or_default());
        if path != self.place.path {
            change(|| fs::rename(&self.place.path, &path))?;
            self.place.path = path;
        }
        Ok(())
    }
}

impl Drop for Workspace {
    fn drop(&mut self) {
        // Free a file descriptor, which reading the folder needs.
        self.lock = None;
        if !self.remains {
            // What fails here is left to the next run.
            let _ = twice(|| self.place.remove());
        }
    }
}

impl WorkspacePlace {
    /// Returns the path of the folder of new files.
    pub(super) fn new_files(&self) -> PathBuf {
        self.path.join(format!("new-{}", self.number))
    }

    /// Returns the path of the folder of old files that are replaced one by one.
    pub(super) fn old_files(&self) -> PathBuf {
        self.path.join(format!("old-{}", self.number))
    }

    /// Returns the path of the folder that exchanges its name with the output folder.
    pub(super) fn exchanged(&self) -> PathBuf {
        self.path.join(format!("exchanged-{}", self.number))
    }

    /// Returns the summaries of the old and the new files that a killed run was replacing one by
    /// one; none if it had not begun.
    pub(super) fn summaries(&self) -> Vec<PathBuf> {
        let (old, new) = (self.old_files(), self.new_files());
        if !old.is_dir() {
            return Vec::new();
        }
        let summaries = [old, new].map(|folder| folder.join(SUMMARY));
        summaries
            .into_iter()
            .filter(|path| path.is_file())
            .collect()
    }

    /// Removes the files that raycost wrote and, if nothing else is in it, the workspace.
    fn remove(&self) -> io::Result<()> {
        let [new, old, exchanged] = [self.new_files(), self.old_files(), self.exchanged()];
        remove_files(&new, |_| true);
        remove_files(&old, |_| true);
        let listed = listed_in(&exchanged.join(SUMMARY));
        remove_files(&exchanged, |path| is_superfluous(path, &listed));
        for folder in [&new, &old, &exchanged, &self.path] {
            match change(|| fs::remove_dir(folder)) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        Ok(())
    }
}

/// Runs `work` again if it fails, as it occasionally does on cluster file systems.
pub(super) fn twice<T>(mut work: impl FnMut() -> io::Result<T>) -> io::Result<T> {
    work().or_else(|_| work())
}

/// Runs `work`, which creates files in a folder, again while they are gone because another run
/// exchanges the folder.
pub(super) fn retry_if_gone<T>(folder: &Path, work: impl Fn() -> io::Result<T>) -> io::Result<T> {
    for _ in 1..N_TRIES {
        match work() {
            Err(error) if error.kind() == io::ErrorKind::NotFound && folder.is_dir() => {
                sleep(Duration::from_millis(5));
            }
            done => return done,
        }
    }
    work()
}

/// Removes the workspaces of killed runs in and beside this folder, which must be locked. One that
/// lists the files of the folder remains until a commit has replaced these.
pub(super) fn remove_left(folder: &Path) {
    let has_summary = folder.join(SUMMARY).exists();
    for mut workspace in left_in(folder, PREFIX) {
        workspace.remains = !has_summary && !workspace.place.summaries().is_empty();
    }
    if let (Some(parent), Some(name)) = (folder.parent(), folder.file_name()) {
        remove_left_of(parent, name);
    }
}

/// Removes the workspaces in a folder of killed runs that were writing a file or folder with this
/// name.
pub(super) fn remove_left_of(folder: &Path, name: &OsStr) {
    left_in(folder, &prefix(name)).for_each(drop);
}

/// Returns the summaries of the files that are being replaced one by one in this folder, or were
/// when a run was killed.
pub(super) fn summaries_in(folder: &Path) -> impl Iterator<Item = PathBuf> {
    places_in(folder, PREFIX).flat_map(|place| place.summaries())
}

/// Returns true if this is the name of a workspace.
pub(super) fn is_name(name: &str) -> bool {
    name.starts_with(PREFIX)
}

/// Returns the workspaces of killed runs in `parent`, locked.
fn left_in(parent: &Path, prefix: &str) -> impl Iterator<Item = Workspace> {
    places_in(parent, prefix).filter_map(|place| {
        Some(Workspace {
            lock: Some(lock_left(&place.path)?),
            place,
            remains: false,
        })
    })
}

/// Returns the folders in `parent` that are workspaces of this user by name; links are none.
pub(super) fn places_in(parent: &Path, prefix: &str) -> impl Iterator<Item = WorkspacePlace> {
    let entries = fs::read_dir(parent).into_iter().flatten().flatten();
    entries.filter_map(move |entry| {
        let at = entry.metadata().ok()?;
        let is_ours = entry.file_name().to_str()?.starts_with(prefix) && at.is_dir() && is_own(&at);
        is_ours.then(|| WorkspacePlace {
            path: entry.path(),
            number: number_of(&at),
        })
    })
}

/// Returns true if a file or folder belongs to the user of this process.
fn is_own(at: &Metadata) -> bool {
    #[cfg(unix)]
    return std::os::unix::fs::MetadataExt::uid(at) == nix::unistd::geteuid().as_raw();
    #[cfg(not(unix))]
    return (true, at).0;
}

/// Returns true if an exchanged file can be removed: raycost wrote it, or it has another name
/// elsewhere.
fn is_superfluous(path: &Path, listed: &[String]) -> bool {
    let Ok(at) = path.symlink_metadata() else {
        return false;
    };
    #[cfg(unix)]
    if std::os::unix::fs::MetadataExt::nlink(&at) > 1 {
        return true;
    }
    let name = path.file_name().unwrap_or_default();
    at.is_file()
        && (listed.iter().any(|file| name == file.as_str()) || is_marked(path).unwrap_or(false))
}

/// Removes the files in a folder that `is_known` accepts, the summary last, on the current thread
/// pool if there is one, since freeing large files takes the system long. Follows no link.
pub(super) fn remove_files(folder: &Path, is_known: impl Fn(&Path) -> bool + Sync) {
    if folder.is_symlink() {
        return;
    }
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let paths = entries.map(|entry| entry.path());
    let (summary, others): (Vec<PathBuf>, Vec<PathBuf>) =
        paths.partition(|path| path.ends_with(SUMMARY));
    let remove = |path: &PathBuf| !is_known(path) || change(|| fs::remove_file(path)).is_ok();
    let remains = |path: &&PathBuf| !remove(path);
    let n_left = if rayon::current_thread_index().is_some() {
        others.par_iter().with_max_len(1).filter(remains).count()
    } else {
        others.iter().filter(remains).count()
    };
    // It lists the others.
    if n_left == 0 {
        for path in &summary {
            remove(path);
        }
    }
}

fn prefix(folder_name: &OsStr) -> String {
    let hash = checksum(folder_name.as_encoded_bytes()).to_string();
    format!("{PREFIX}{}-", &hash[..16])
}
