//! Commits file by file, with a rollback at any time.
//!
//! The workspace is renamed to `.raycost-journal` in the output folder. Then each old file is moved
//! to the journal's `old/`, and each new file to its final name. The commit is done when the
//! journal is renamed back to the workspace. A journal in a folder that is not locked belongs to a
//! killed run: its old files are moved back. An interrupted rollback can be repeated.

use std::io;
use std::path::Path;

use super::disk;
use super::error::WriteError;
use super::workspace::{self, CommitPlan, Workspace};

/// The name of the journal during a commit.
const NAME: &str = ".raycost-journal";
/// The name of the journal after a rollback.
const TAKEN_BACK: &str = ".raycost-taken-back";

/// Moves all new files of the workspace into the folder, and removes the old files that no new file
/// replaces.
///
/// # Errors
/// An I/O error; then the folder is unchanged.
pub(super) fn commit(
    folder: &Path,
    workspace: &Workspace,
    plan: &CommitPlan,
    sync: bool,
) -> io::Result<()> {
    let journal = folder.join(NAME);
    workspace.write_plan(plan)?;
    workspace.create_old()?;
    if sync {
        disk::sync(&workspace.path)?;
    }
    disk::rename(&workspace.path, &journal)?;
    let moved = move_files(folder, &journal, plan, sync)
        .and_then(|()| disk::rename(&journal, &workspace.path));
    if let Err(error) = moved {
        // If this fails too, the next command rolls back.
        let _ = roll_back(folder);
        return Err(error);
    }
    Ok(())
}

fn move_files(folder: &Path, journal: &Path, plan: &CommitPlan, sync: bool) -> io::Result<()> {
    let (new, old) = (workspace::new_files(journal), workspace::old_files(journal));
    for name in &plan.new {
        let (at, saved) = (folder.join(name), old.join(name));
        if plan.old.contains(name) && disk::hard_link(&at, &saved).is_err() {
            disk::rename(&at, &saved)?;
        }
        disk::rename(&new.join(name), &at)?;
    }
    for name in plan.old.iter().filter(|name| !plan.new.contains(name)) {
        disk::rename(&folder.join(name), &old.join(name))?;
    }
    if sync {
        disk::sync(folder)?;
    }
    Ok(())
}

/// Returns true if the folder has an unfinished commit.
pub(super) fn is_in(folder: &Path) -> bool {
    folder.join(NAME).symlink_metadata().is_ok()
}

/// Rolls back an unfinished commit, if there is one. The folder must be locked.
///
/// # Errors
/// An I/O error, or an unreadable journal.
pub(super) fn roll_back(folder: &Path) -> Result<(), WriteError> {
    let journal = folder.join(NAME);
    if !is_in(folder) {
        return Ok(());
    }
    let Some(plan) = workspace::plan(&journal) else {
        return Err(WriteError::refused(
            journal,
            "a commit was broken off, and its plan is damaged",
            "old files are in its folder `old`, new ones in `new`: save what you need, and \
             remove it",
        ));
    };
    put_back(folder, &journal, &plan).map_err(|error| WriteError::new(&journal, error))
}

fn put_back(folder: &Path, journal: &Path, plan: &CommitPlan) -> io::Result<()> {
    let (new, old) = (workspace::new_files(journal), workspace::old_files(journal));
    for name in &plan.old {
        if old.join(name).symlink_metadata().is_ok() {
            disk::rename(&old.join(name), &folder.join(name))?;
        }
    }
    for name in plan.new.iter().filter(|name| !plan.old.contains(name)) {
        let at = folder.join(name);
        let was_moved = new.join(name).symlink_metadata().is_err();
        if was_moved && at.symlink_metadata().is_ok() {
            disk::remove_file(&at)?;
        }
    }
    let taken_back = folder.join(TAKEN_BACK);
    workspace::remove(&taken_back)?;
    disk::rename(journal, &taken_back)?;
    // The folder is restored: the next run removes the rest.
    let _ = workspace::remove(&taken_back);
    Ok(())
}
