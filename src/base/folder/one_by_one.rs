//! Replaces files one by one, where folders cannot be exchanged.
//!
//! 1. The workspace moves into the output folder.
//! 2. The old files move to its `old/`, the summary first.
//! 3. The new files move to their places, the summary last.
//! 4. The workspace is removed.
//!
//! The folder never has files of both runs, and has no summary unless it has all of a run: a reader
//! does not take it for whole. If a move fails, or the run is killed and the next one finds its
//! workspace, all moves are taken back in reverse order.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::disk::change;
use super::plan::{CommitPlan, NEW, OLD};

/// Replaces the plan's old files with its new ones. The workspace must be in the folder.
///
/// # Errors
/// An I/O error; then the moves have to be [taken back](take_back).
pub(super) fn commit(folder: &Path, workspace: &Path, plan: &CommitPlan) -> io::Result<()> {
    change(|| fs::create_dir(workspace.join(OLD)))?;
    let mut moves = moves(folder, workspace, plan).into_iter();
    moves.try_for_each(|(from, to)| change(|| fs::rename(from, to)))
}

/// Takes an unfinished replacement back. Interrupted, this can be repeated.
///
/// # Errors
/// An I/O error.
pub(super) fn take_back(folder: &Path, workspace: &Path, plan: &CommitPlan) -> io::Result<()> {
    let is_there = |path: &Path| path.symlink_metadata().is_ok();
    let moves = moves(folder, workspace, plan);
    if moves.last().is_none_or(|(from, _)| !is_there(from)) {
        return Ok(());
    }
    for (from, to) in moves.iter().rev() {
        if is_there(to) && !is_there(from) {
            change(|| fs::rename(to, from))?;
        }
    }
    Ok(())
}

/// Returns the origin and the destination of each move.
fn moves(folder: &Path, workspace: &Path, plan: &CommitPlan) -> Vec<(PathBuf, PathBuf)> {
    let (old, new) = (workspace.join(OLD), workspace.join(NEW));
    let away = |name| (folder.join(name), old.join(name));
    let into_place = |name| (new.join(name), folder.join(name));
    let away = plan.old.iter().map(away);
    away.chain(plan.new.iter().map(into_place)).collect()
}
