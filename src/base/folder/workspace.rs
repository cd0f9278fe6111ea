//! A temporary folder for new files.
//!
//! Its name is `.raycost-<hash>-<random>`, with a hash of the output folder's name. It contains
//! `new/` with the new files and, during a commit, a [`CommitPlan`] and the commit's own files. The
//! process that creates a workspace locks it: a workspace that is not locked belongs to a killed
//! process. Only its user may open it.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::disk;
use super::lock::lock;
use crate::files;
use crate::provenance::checksum;

/// The prefix of the names of all workspaces.
pub(super) const PREFIX: &str = ".raycost-";
/// The folder of new files; after an exchange, the old folder.
const NEW: &str = "new";
/// The folder of old files, which a rollback restores.
const OLD: &str = "old";
const PLAN: &str = "plan.json";
/// Longest plan that is read, in bytes: room for the names of several thousand files.
const MAX_PLAN: u64 = 64 << 20;

/// Maximum number of attempts to create a workspace.
const N_TRIES: usize = 100;

/// The steps of a commit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct CommitPlan {
    /// The version of raycost that commits.
    pub(super) raycost: String,
    /// The inode number of the folder of new files.
    pub(super) staged: u64,
    /// The names of the new files.
    pub(super) new: Vec<String>,
    /// The names of raycost's old files, which are replaced or removed.
    pub(super) old: Vec<String>,
    /// The names of foreign files, which remain; for an exchange only.
    pub(super) kept: Vec<String>,
}

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
        let mut builder = tempfile::Builder::new();
        let prefix = prefix(folder_name);
        let made = builder
            .prefix(&prefix)
            .make_in(parent, disk::create_private_dir)?;
        let path = made.into_parts().1.keep()?;
        let mut this = Self { path, lock: None };
        let locked = lock(&this.path)?;
        // A run that removes it holds the lock.
        this.lock = Some(locked.ok_or(io::ErrorKind::NotFound)?);
        disk::create_dir(&this.new_files())?;
        Ok(this)
    }

    /// Returns the path of the folder of new files.
    pub(super) fn new_files(&self) -> PathBuf {
        self.path.join(NEW)
    }

    /// Writes the plan of a commit.
    pub(super) fn write_plan(&self, plan: &CommitPlan) -> io::Result<()> {
        let path = self.path.join(PLAN);
        if path.exists() {
            disk::remove_file(&path)?;
        }
        let text = serde_json::to_vec(plan)?;
        let file = disk::create_file(&path)?;
        let mut rest = &text[..];
        while !rest.is_empty() {
            let n = disk::write(&file, rest)?;
            rest = &rest[n..];
        }
        Ok(())
    }

    /// Creates the folder of old files.
    pub(super) fn create_old(&self) -> io::Result<()> {
        disk::create_dir(&old_files(&self.path))
    }

    /// Returns true if the folder of new files was exchanged.
    pub(super) fn was_exchanged(&self) -> bool {
        was_exchanged(&self.path)
    }

    /// Finishes the commit after an exchange, and removes the workspace. If this fails, the next
    /// run repeats it.
    pub(super) fn settle(self, folder: &Path) {
        let _ = twice(|| settle(&self.path, folder));
    }
}

impl Drop for Workspace {
    fn drop(&mut self) {
        // Free a file descriptor, which reading the folder needs.
        self.lock = None;
        // After an exchange it may contain foreign files.
        if !was_exchanged(&self.path) {
            let _ = twice(|| remove(&self.path));
        }
    }
}

/// Runs `work` again if it fails, as it occasionally does on cluster file systems.
fn twice(work: impl Fn() -> io::Result<()>) -> io::Result<()> {
    work().or_else(|_| work())
}

/// Returns the path of a workspace's new files.
pub(super) fn new_files(workspace: &Path) -> PathBuf {
    workspace.join(NEW)
}

/// Returns the path of a workspace's old files.
pub(super) fn old_files(workspace: &Path) -> PathBuf {
    workspace.join(OLD)
}

/// Reads the plan of a workspace; `None` if it is missing or incomplete.
pub(super) fn plan(workspace: &Path) -> Option<CommitPlan> {
    let text = files::read(&workspace.join(PLAN), MAX_PLAN).ok()?;
    serde_json::from_slice(&text).ok()
}

/// Removes the workspaces of killed runs in and beside this folder, which must be
/// locked. Ignores errors.
pub(super) fn remove_left(folder: &Path) {
    let name = folder.file_name().unwrap_or_default();
    let beside = folder.parent().map(|parent| left_in(parent, &prefix(name)));
    let left = beside.into_iter().flatten().chain(left_in(folder, PREFIX));
    for workspace in left {
        if let Ok(Some(_lock)) = lock(&workspace) {
            let _ = settle(&workspace, folder);
        }
    }
}

/// Removes the workspaces in a folder of killed runs that were writing a single file
/// with this name.
pub(super) fn remove_left_of_file(folder: &Path, name: &OsStr) {
    for workspace in left_in(folder, &prefix(name)) {
        if let Ok(Some(_lock)) = lock(&workspace) {
            let _ = remove(&workspace);
        }
    }
}

/// Returns the folders in `parent` that are workspaces by name and content.
fn left_in(parent: &Path, prefix: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(parent).into_iter().flatten().flatten();
    let is_ours = |entry: &fs::DirEntry| {
        let name = entry.file_name();
        name.to_str().is_some_and(|name| name.starts_with(prefix))
            && entry.file_type().is_ok_and(|kind| kind.is_dir())
            && holds_nothing_else(&entry.path())
    };
    entries.filter(is_ours).map(|entry| entry.path()).collect()
}

fn holds_nothing_else(workspace: &Path) -> bool {
    let is_known = |name: OsString| {
        let name = name.to_str().unwrap_or_default();
        [NEW, OLD, PLAN].contains(&name) || name.starts_with(PREFIX)
    };
    fs::read_dir(workspace).is_ok_and(|mut entries| {
        entries.all(|entry| entry.is_ok_and(|entry| is_known(entry.file_name())))
    })
}

/// Finishes and removes a workspace. Foreign files that appeared in the old folder just before the
/// exchange move to the new one.
fn settle(workspace: &Path, folder: &Path) -> io::Result<()> {
    if was_exchanged(workspace)
        && let Some(plan) = plan(workspace)
    {
        hand_over(&new_files(workspace), folder, &plan)?;
    }
    remove(workspace)
}

fn was_exchanged(workspace: &Path) -> bool {
    let number = number_of(&new_files(workspace));
    match (number, plan(workspace)) {
        (Ok(number), Some(plan)) => number != plan.staged,
        _ => false,
    }
}

/// Moves foreign files from the old folder to the new one.
fn hand_over(old: &Path, folder: &Path, plan: &CommitPlan) -> io::Result<()> {
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
            Err(_) => !is_in(&plan.kept),
        };
        if is_newer {
            disk::rename(&entry.path(), &there)?;
        }
    }
    Ok(())
}

/// Removes a workspace: its plan last, because it identifies the rest.
pub(super) fn remove(workspace: &Path) -> io::Result<()> {
    // It may contain the workspace of a run that wrote into it.
    for nested in left_in(workspace, PREFIX) {
        remove(&nested)?;
    }
    for files in [new_files(workspace), old_files(workspace)] {
        if !files.exists() {
            continue;
        }
        // An empty folder can be removed even if it cannot be read.
        if let Ok(entries) = fs::read_dir(&files) {
            let paths = entries.map(|entry| Ok(entry?.path()));
            remove_files(&paths.collect::<io::Result<Vec<_>>>()?)?;
        }
        disk::remove_dir(&files)?;
    }
    let plan = workspace.join(PLAN);
    if plan.exists() {
        disk::remove_file(&plan)?;
    }
    if workspace.exists() {
        disk::remove_dir(workspace)
    } else {
        Ok(())
    }
}

/// Removes all removable files, on the current thread pool if there is one, since freeing large
/// files takes the system long.
fn remove_files(paths: &[PathBuf]) -> io::Result<()> {
    if rayon::current_thread_index().is_some() {
        let each = paths.par_iter().with_max_len(1);
        each.map(|path| disk::remove_file(path))
            .reduce(|| Ok(()), Result::and)
    } else {
        let each = paths.iter().map(|path| disk::remove_file(path));
        each.fold(Ok(()), Result::and)
    }
}

fn prefix(folder_name: &OsStr) -> String {
    let hash = checksum(folder_name.as_encoded_bytes()).to_string();
    format!("{PREFIX}{}-", &hash[..16])
}

/// Returns the inode number of a folder.
#[cfg(unix)]
pub(super) fn number_of(path: &Path) -> io::Result<u64> {
    Ok(std::os::unix::fs::MetadataExt::ino(&path.metadata()?))
}

#[cfg(not(unix))]
pub(super) fn number_of(_: &Path) -> io::Result<u64> {
    Ok(0)
}
