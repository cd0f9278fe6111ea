//! A folder for what is not finished.
//!
//! It is called `.raycost-<hash>-<random>`, where the hash is that of the output
//! folder's name, and holds `new/` with the files to come, a [`Plan`] once they
//! are about to take their places, and what the way of doing that needs. Who
//! makes it locks it: one that is not locked was left by a process that was
//! killed. It stands where others can look, and only its user may look into it.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::disk;
use super::lock::lock;
use crate::provenance::checksum;

/// How the names of all workspaces begin.
pub(super) const PREFIX: &str = ".raycost-";
/// New files; after an exchange the old folder.
const NEW: &str = "new";
/// Old files that a journal can bring back.
const OLD: &str = "old";
const PLAN: &str = "plan.json";

/// What a commit is about to do.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Plan {
    /// The version of raycost that made it.
    pub(super) raycost: String,
    /// The number of the folder of new files in its file system.
    pub(super) staged: u64,
    /// The files to come.
    pub(super) new: Vec<String>,
    /// Raycost's files that are there, which are replaced or go.
    pub(super) old: Vec<String>,
    /// Files of others, which stay; only where folders are exchanged.
    pub(super) kept: Vec<String>,
}

/// A folder for what is not finished, which goes with all that is in it when
/// dropped.
#[derive(Debug)]
pub(super) struct Workspace {
    pub(super) path: PathBuf,
    /// Held as long as it is in use.
    _lock: Option<File>,
}

impl Workspace {
    /// Makes one in `parent` for the files of a folder of this name.
    pub(super) fn create(parent: &Path, folder_name: &OsStr) -> io::Result<Self> {
        let mut builder = tempfile::Builder::new();
        let prefix = prefix(folder_name);
        let made = builder
            .prefix(&prefix)
            .make_in(parent, disk::create_private_dir)?;
        let path = made.into_parts().1.keep()?;
        let this = Self {
            _lock: lock(&path)?,
            path,
        };
        disk::create_dir(&this.new_files())?;
        Ok(this)
    }

    /// Where the files to come are.
    pub(super) fn new_files(&self) -> PathBuf {
        self.path.join(NEW)
    }

    /// Writes down what is about to be done.
    pub(super) fn write_plan(&self, plan: &Plan) -> io::Result<()> {
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

    /// Makes room for the old files.
    pub(super) fn create_old(&self) -> io::Result<()> {
        disk::create_dir(&old_files(&self.path))
    }

    /// Whether its folder of new files has been exchanged for another.
    pub(super) fn was_exchanged(&self) -> bool {
        was_exchanged(&self.path)
    }

    /// Ends the commit after the exchange, and removes what is left. What cannot
    /// be done now is done by the next run.
    pub(super) fn settle(self, folder: &Path) {
        let _ = settle(&self.path, folder);
    }
}

impl Drop for Workspace {
    fn drop(&mut self) {
        // After an exchange it holds what has to be looked through first.
        if !was_exchanged(&self.path) {
            let _ = remove(&self.path);
        }
    }
}

/// Where the new files of a workspace are.
pub(super) fn new_files(workspace: &Path) -> PathBuf {
    workspace.join(NEW)
}

/// Where the old files of a workspace are.
pub(super) fn old_files(workspace: &Path) -> PathBuf {
    workspace.join(OLD)
}

/// The plan of a workspace; `None` without one that is whole.
pub(super) fn plan(workspace: &Path) -> Option<Plan> {
    let text = fs::read(workspace.join(PLAN)).ok()?;
    serde_json::from_slice(&text).ok()
}

/// Removes what runs that were killed have left for this folder, which is
/// locked: in it, and beside it. What cannot be removed stays.
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

/// Removes what was left in a folder by runs that were killed while they wrote
/// a single file of this name.
pub(super) fn remove_left_of_file(folder: &Path, name: &OsStr) {
    for workspace in left_in(folder, &prefix(name)) {
        if let Ok(Some(_lock)) = lock(&workspace) {
            let _ = remove(&workspace);
        }
    }
}

/// The folders in `parent` that are workspaces by their names and by what is in
/// them.
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

/// Ends what a workspace was made for: after an exchange, files of others that
/// came into the old folder at the last moment go into the new one. Then it
/// goes.
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

/// Moves files of others from the old folder into the one that took its name.
fn hand_over(old: &Path, folder: &Path, plan: &Plan) -> io::Result<()> {
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
            // One that was in both has been removed since.
            Err(_) => !is_in(&plan.kept),
        };
        if is_newer {
            disk::rename(&entry.path(), &there)?;
        }
    }
    Ok(())
}

/// Removes a workspace, its plan last: it says what the rest is.
pub(super) fn remove(workspace: &Path) -> io::Result<()> {
    // A run that was to write into this one may have left its own.
    for nested in left_in(workspace, PREFIX) {
        remove(&nested)?;
    }
    for files in [new_files(workspace), old_files(workspace)] {
        let Ok(entries) = fs::read_dir(&files) else {
            continue;
        };
        for entry in entries {
            disk::remove_file(&entry?.path())?;
        }
        disk::remove_dir(&files)?;
    }
    let plan = workspace.join(PLAN);
    if plan.exists() {
        disk::remove_file(&plan)?;
    }
    match workspace.exists() {
        true => disk::remove_dir(workspace),
        false => Ok(()),
    }
}

fn prefix(folder_name: &OsStr) -> String {
    let hash = checksum(folder_name.as_encoded_bytes()).to_string();
    format!("{PREFIX}{}-", &hash[..16])
}

/// The number of a folder in its file system.
#[cfg(unix)]
pub(super) fn number_of(path: &Path) -> io::Result<u64> {
    Ok(std::os::unix::fs::MetadataExt::ino(&path.metadata()?))
}

#[cfg(not(unix))]
pub(super) fn number_of(_: &Path) -> io::Result<u64> {
    Ok(0)
}
