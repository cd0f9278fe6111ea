//! Commits atomically: the folder of new files and the output folder exchange their names
//! (`renameat2` with `RENAME_EXCHANGE`).
//!
//! Before that, the new folder gets a hard link to each foreign file, so that none is ever missing.

use std::fs;
use std::io;
use std::path::Path;

use super::disk::{self, change};
use super::lock::is_same;
use super::plan::CommitPlan;
use super::workspace::Workspace;

/// Maximum number of foreign files that are linked.
const MAX_KEPT: usize = 1000;

/// Exchanges the folder with the workspace's new files.
///
/// # Errors
/// An I/O error, or the exchange is not supported; then the folder is unchanged.
pub(super) fn commit(
    folder: &Path,
    workspace: &Workspace,
    plan: &CommitPlan,
    sync: bool,
) -> io::Result<()> {
    let as_of = folder.metadata()?;
    let is_beside = workspace.path.parent() == folder.parent();
    // The run and the shell that started it would end up in a deleted folder.
    let is_current = fs::metadata(".").is_ok_and(|current| is_same(&current, &as_of));
    let Some(kept) = plan.kept.as_ref().filter(|_| is_beside && !is_current) else {
        return Err(io::ErrorKind::Unsupported.into());
    };
    let new_files = workspace.new_files();
    for name in kept {
        change(|| fs::hard_link(folder.join(name), new_files.join(name)))?;
    }
    #[cfg(unix)]
    disk::set_owner(&new_files, &as_of)?;
    change(|| fs::set_permissions(&new_files, as_of.permissions()))?;
    if sync {
        disk::sync(&new_files)?;
    }
    disk::exchange(&new_files, folder)
}

/// Returns the names of all foreign files; `None` if one of them cannot be linked.
pub(super) fn kept(folder: &Path, old: &[String]) -> io::Result<Option<Vec<String>>> {
    let mut kept = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let kind = entry.file_type()?;
        let Ok(name) = entry.file_name().into_string() else {
            return Ok(None);
        };
        if old.contains(&name) {
            continue;
        }
        if !(kind.is_file() || kind.is_symlink()) || kept.len() == MAX_KEPT {
            return Ok(None);
        }
        kept.push(name);
    }
    Ok(Some(kept))
}
