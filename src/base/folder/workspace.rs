//! A temporary folder for new files.
//!
//! Its name is `.raycost-<hash>-<random>`, with a hash of the output folder's name. It contains
//! `new/` with the new files and, during a commit, a [`CommitPlan`] and `old/` with old files. The
//! process that creates a workspace locks it: a workspace that is not locked belongs to a killed
//! process. Only its user may open it.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::disk::change;
use super::error::WriteError;
use super::lock::{lock, number_of};
use super::one_by_one;
use super::plan::{CommitPlan, NEW, OLD, PLAN};
use crate::provenance::checksum;

/// The prefix of the names of all workspaces.
const PREFIX: &str = ".raycost-";
/// Maximum number of attempts to create a workspace.
const N_TRIES: usize = 100;

/// A temporary folder, removed with its content when dropped.
#[derive(Debug)]
pub(super) struct Workspace {
    pub(super) path: PathBuf,
    /// The lock, held while the workspace is in use.
    lock: Option<File>,
}

impl Workspace {
    /// Creates a workspace in `parent` for the files of a folder with this name. Another run may take
    /// one that is not locked yet for a killed run's and remove it; then this creates another.
    pub(super) fn create(parent: &Path, folder_name: &OsStr) -> io::Result<Self> {
        for _ in 1..N_TRIES {
            match Self::create_once(parent, folder_name) {
                Err(error) if error.kind() == io::ErrorKind::NotFound && parent.is_dir() => {}
                done => return done,
            }
        }
        Self::create_once(parent, folder_name)
    }

    fn create_once(parent: &Path, folder_name: &OsStr) -> io::Result<Self> {
        let mut private = fs::DirBuilder::new();
        #[cfg(unix)]
        std::os::unix::fs::DirBuilderExt::mode(&mut private, 0o700);
        let made = tempfile::Builder::new()
            .prefix(&prefix(folder_name))
            .make_in(parent, |path| change(|| private.create(path)))?;
        let path = made.into_parts().1.keep()?;
        let mut this = Self { path, lock: None };
        let locked = lock(&this.path)?;
        // A run that removes it holds the lock.
        this.lock = Some(locked.ok_or(io::ErrorKind::NotFound)?);
        change(|| fs::create_dir(this.new_files()))?;
        Ok(this)
    }

    /// Returns the path of the folder of new files.
    pub(super) fn new_files(&self) -> PathBuf {
        self.path.join(NEW)
    }

    /// Moves the workspace to another parent.
    pub(super) fn move_to(&mut self, parent: &Path) -> io::Result<()> {
        let path = parent.join(self.path.file_name().unwrap_or_default());
        if path != self.path {
            change(|| fs::rename(&self.path, &path))?;
            self.path = path;
        }
        Ok(())
    }

    /// Returns true if the folder of new files was exchanged.
    pub(super) fn was_exchanged(&self) -> bool {
        let new_files = self.new_files().metadata().ok();
        CommitPlan::read(&self.path)
            .zip(new_files)
            .is_some_and(|(plan, new_files)| number_of(&new_files) != plan.staged)
    }

    /// Concludes a commit: hands foreign files over after an exchange, or takes an unfinished
    /// replacement back. If this fails, it can be repeated.
    ///
    /// # Errors
    /// An I/O error, or a damaged plan.
    fn conclude(&self) -> io::Result<()> {
        let (path, parent) = (self.path.join(PLAN), self.path.parent());
        let parent = parent.unwrap_or(Path::new(""));
        match CommitPlan::read(&self.path) {
            Some(plan) if self.was_exchanged() => {
                hand_over(&self.new_files(), &parent.join(&plan.folder), &plan)?;
            }
            // Beside the folder, the workspace has nothing to take back.
            Some(plan) => one_by_one::take_back(parent, &self.path, &plan)?,
            None if path.exists() && self.path.join(OLD).exists() => {
                let why = "a run was killed while it replaced files, and its plan is damaged; old \
                           files are in the folder's `old`, new ones in `new`: save what you \
                           need, and remove it";
                return Err(io::Error::other(why));
            }
            _ => {}
        }
        // A repetition has nothing to do.
        if path.exists() {
            change(|| fs::remove_file(&path))?;
        }
        Ok(())
    }
}

impl Drop for Workspace {
    fn drop(&mut self) {
        // What fails here is left to the next run.
        if twice(|| self.conclude()).is_ok() {
            // Free a file descriptor, which reading the folder needs.
            self.lock = None;
            let _ = twice(|| remove(&self.path));
        }
    }
}

/// Runs `work` again if it fails, as it occasionally does on cluster file systems.
fn twice(work: impl Fn() -> io::Result<()>) -> io::Result<()> {
    work().or_else(|_| work())
}

/// Removes the workspaces of killed runs in and beside this folder, which must be locked.
///
/// # Errors
/// A replacement one by one that cannot be taken back; other errors are ignored.
pub(super) fn remove_left(folder: &Path) -> Result<(), WriteError> {
    for workspace in left_in(folder, PREFIX) {
        let concluded = workspace.conclude();
        concluded.map_err(|error| WriteError::new(&workspace.path, error))?;
    }
    if let (Some(parent), Some(name)) = (folder.parent(), folder.file_name()) {
        remove_left_of(parent, name);
    }
    Ok(())
}

/// Removes the workspaces in a folder of killed runs that were writing a file or folder with this
/// name.
pub(super) fn remove_left_of(folder: &Path, name: &OsStr) {
    left_in(folder, &prefix(name)).for_each(drop);
}

/// Returns true if the files of this folder are being replaced one by one, or were when a run was
/// killed.
pub(super) fn is_begun_in(folder: &Path) -> bool {
    paths_in(folder, PREFIX).any(|workspace| workspace.join(OLD).exists())
}

/// Returns the workspaces of killed runs in `parent`, locked.
fn left_in(parent: &Path, prefix: &str) -> impl Iterator<Item = Workspace> {
    paths_in(parent, prefix).filter_map(|path| {
        let lock = Some(lock(&path).ok()??);
        Some(Workspace { path, lock })
    })
}

/// Returns the folders in `parent` that are workspaces by name and content.
fn paths_in(parent: &Path, prefix: &str) -> impl Iterator<Item = PathBuf> {
    let entries = fs::read_dir(parent).into_iter().flatten().flatten();
    let is_ours = move |entry: &fs::DirEntry| {
        let name = entry.file_name();
        name.to_str().is_some_and(|name| name.starts_with(prefix))
            && entry.file_type().is_ok_and(|kind| kind.is_dir())
            && holds_nothing_else(&entry.path())
    };
    entries.filter(is_ours).map(|entry| entry.path())
}

fn holds_nothing_else(workspace: &Path) -> bool {
    let is_known = |entry: fs::DirEntry| {
        let name = entry.file_name();
        let name = name.to_str().unwrap_or_default();
        // A link could lead to the files of others.
        ([NEW, OLD, PLAN].contains(&name) || name.starts_with(PREFIX))
            && entry.file_type().is_ok_and(|kind| !kind.is_symlink())
    };
    fs::read_dir(workspace).is_ok_and(|mut entries| entries.all(|entry| entry.is_ok_and(is_known)))
}

/// Moves foreign files that appeared in the old folder just before the exchange to the new one.
fn hand_over(old: &Path, folder: &Path, plan: &CommitPlan) -> io::Result<()> {
    if folder.is_symlink() {
        return Err(io::ErrorKind::NotADirectory.into());
    }
    for entry in fs::read_dir(old)? {
        let entry = entry?;
        let name = entry.file_name();
        let is_in = |names: &[String]| names.iter().any(|known| name == known.as_str());
        if is_in(&plan.old) {
            continue;
        }
        let there = folder.join(&name);
        let is_newer = match fs::symlink_metadata(&there) {
            Ok(there) => entry.metadata()?.modified()? > there.modified()?,
            // A file that was in both folders has been removed since.
            Err(_) => !plan.kept.as_deref().is_some_and(is_in),
        };
        if is_newer {
            change(|| fs::rename(entry.path(), &there))?;
        }
    }
    Ok(())
}

/// Removes a workspace.
fn remove(workspace: &Path) -> io::Result<()> {
    for files in [NEW, OLD].map(|name| workspace.join(name)) {
        remove_files(&files);
        // An empty folder can be removed even if it cannot be read.
        let _ = change(|| fs::remove_dir(&files));
    }
    if workspace.exists() && change(|| fs::remove_dir(workspace)).is_err() {
        change(|| fs::remove_dir_all(workspace))?;
    }
    Ok(())
}

/// Removes all removable files, on the current thread pool if there is one, since freeing large
/// files takes the system long.
fn remove_files(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    let remove = |path: &PathBuf| drop(change(|| fs::remove_file(path)));
    if rayon::current_thread_index().is_some() {
        paths.par_iter().with_max_len(1).for_each(remove);
    } else {
        paths.iter().for_each(remove);
    }
}

fn prefix(folder_name: &OsStr) -> String {
    let hash = checksum(folder_name.as_encoded_bytes()).to_string();
    format!("{PREFIX}{}-", &hash[..16])
}
