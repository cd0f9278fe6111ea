//! Commits atomically: the folder of new files and the output folder exchange their names
//! (`renameat2` with `RENAME_EXCHANGE`).
//!
//! Before that, the new folder gets a hard link to each foreign file, so that none is ever missing.
//! Where that is impossible, the [`journal`](super::journal) commits.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use super::disk;
use super::lock::is_same;
use super::workspace::{CommitPlan, Workspace};

/// Maximum number of foreign files that are linked.
const MAX_KEPT: usize = 1000;

/// Returns the parent of this folder if it is on the same file system: the two folders can then be
/// exchanged.
pub(super) fn parent_of(folder: &Path) -> Option<PathBuf> {
    let parent = folder.parent()?;
    let is_one_system = device(folder).ok()? == device(parent).ok()?;
    (is_one_system && !is_mount_point(folder)).then(|| parent.to_owned())
}

/// Exchanges the folder with the workspace's new files. Returns `false` if that is impossible;
/// then, and after an error, the folder is unchanged.
///
/// # Errors
/// An I/O error.
pub(super) fn commit(
    folder: &Path,
    workspace: &Workspace,
    mut plan: CommitPlan,
    sync: bool,
) -> io::Result<bool> {
    let Some(kept) = kept(folder, &plan.old)? else {
        return Ok(false);
    };
    if Some(folder.parent()) != Some(workspace.path.parent()) || is_in_use(folder) {
        return Ok(false);
    }
    let new_files = workspace.new_files();
    plan.kept = kept;
    workspace.write_plan(&plan)?;
    for name in &plan.kept {
        disk::hard_link(&folder.join(name), &new_files.join(name))?;
    }
    let as_of = folder.metadata()?;
    disk::set_owner(&new_files, &as_of)?;
    disk::set_permissions(&new_files, as_of.permissions())?;
    if sync {
        disk::sync(&new_files)?;
        disk::sync(&workspace.path)?;
    }
    disk::exchange(&new_files, folder)?;
    Ok(true)
}

/// Hard-links all foreign files and returns their names; `None` if one cannot be linked.
fn kept(folder: &Path, old: &[String]) -> io::Result<Option<Vec<String>>> {
    let mut kept = Vec::new();
    if has_attributes(folder) {
        return Ok(None);
    }
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

/// Returns true if the folder has access control lists or other attributes that a new folder lacks.
#[cfg(any(target_os = "linux", target_vendor = "apple"))]
fn has_attributes(folder: &Path) -> bool {
    let mut names = [0_u8; 4096];
    match rustix::fs::listxattr(folder, &mut names[..]) {
        Ok(n) => names[..n]
            .split(|byte| *byte == 0)
            .any(|name| !name.is_empty() && !name.starts_with(b"security.")),
        Err(rustix::io::Errno::NOTSUP) => false,
        Err(_) => true,
    }
}

#[cfg(not(any(target_os = "linux", target_vendor = "apple")))]
fn has_attributes(_: &Path) -> bool {
    false
}

/// Returns true if the folder is the current directory of a process, which would end up in a
/// deleted folder. Only Linux reports it, for the user's own processes.
fn is_in_use(folder: &Path) -> bool {
    let Ok(folder) = folder.metadata() else {
        return true;
    };
    let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
    let mut at_work = processes
        .filter(|entry| entry.file_name().as_encoded_bytes()[0].is_ascii_digit())
        .filter_map(|entry| entry.path().join("cwd").metadata().ok());
    at_work.any(|at_work| is_same(&at_work, &folder))
        || fs::metadata(".").is_ok_and(|own| is_same(&own, &folder))
}

/// Returns true if the folder is a mount point, as far as Linux reports it.
fn is_mount_point(folder: &Path) -> bool {
    let Ok(mounts) = File::open("/proc/self/mountinfo").and_then(io::read_to_string) else {
        return false;
    };
    let escaped = |path: &str| {
        path.replace('\\', "\\134")
            .replace(' ', "\\040")
            .replace('\t', "\\011")
            .replace('\n', "\\012")
    };
    let folder = folder.to_str().map(escaped);
    mounts
        .lines()
        .any(|line| line.split(' ').nth(4) == folder.as_deref())
}

#[cfg(unix)]
fn device(path: &Path) -> io::Result<u64> {
    Ok(std::os::unix::fs::MetadataExt::dev(&path.metadata()?))
}

#[cfg(not(unix))]
fn device(_: &Path) -> io::Result<u64> {
    Err(io::ErrorKind::Unsupported.into())
}
