//! Replaces the old files of an output folder by new ones.
//!
//! If the system supports it, the folder of new files and the output folder exchange their names
//! (`renameat2` with `RENAME_EXCHANGE`). Before that, the new folder gets a hard link to each foreign
//! file, so that none is ever missing; foreign files that appear at the last moment follow at once.
//!
//! Otherwise files are replaced one by one: the workspace moves into the output folder, the old files
//! move to its `old-…`, the summary first, and the new files to their places, the summary last. The
//! folder never has files of both runs, and has no summary unless it has all of a run.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::SUMMARY;
use super::disk::{self, change};
use super::error::WriteError;
use super::lock::is_same;
use super::own::{self, Own};
use super::workspace::{self, Workspace, remove_files, twice};
use super::written::Written;

/// Maximum number of foreign files that are linked.
const MAX_KEPT: usize = 1000;

/// The files of a commit.
#[derive(Debug)]
pub(super) struct Commit<'a> {
    /// The output folder.
    folder: &'a Path,
    /// The names of the new files.
    new: Vec<String>,
    /// The names of raycost's old files, which are replaced or removed.
    old: Vec<String>,
    /// The names of foreign files, which remain; `None` if they prevent an exchange.
    kept: Option<Vec<String>>,
}

impl<'a> Commit<'a> {
    /// Plans the commit of these files, and checks that no foreign file is in the way.
    ///
    /// # Errors
    /// A file of another program, or an I/O error.
    pub(super) fn new(folder: &'a Path, files: &[Written], own: &Own) -> Result<Self, WriteError> {
        let mut old = own.find(folder)?;
        let mut new: Vec<String> = files.iter().map(|file| file.file.clone()).collect();
        let in_the_way =
            |name: &&String| !old.contains(name) && folder.join(name).symlink_metadata().is_ok();
        if let Some(name) = new.iter().find(in_the_way) {
            return Err(own::foreign(&folder.join(name)));
        }
        old.sort_by_key(|name| name != SUMMARY);
        new.sort_by_key(|name| name == SUMMARY);
        Ok(Self {
            kept: kept(folder, &old).map_err(|error| WriteError::new(folder, error))?,
            folder,
            new,
            old,
        })
    }

    /// Gives each new file the permissions of the old one, and flushes all to the disk if `sync`.
    pub(super) fn prepare(&self, workspace: &Workspace, sync: bool) -> io::Result<()> {
        let new_files = workspace.place.new_files();
        for name in &self.new {
            let (old, new) = (self.folder.join(name), new_files.join(name));
            if self.old.contains(name) {
                let permissions = old.metadata()?.permissions();
                if permissions != new.metadata()?.permissions() {
                    change(|| fs::set_permissions(&new, permissions))?;
                }
            }
            if sync {
                disk::sync(&new)?;
            }
        }
        Ok(())
    }

    /// Exchanges the folder with the folder of new files.
    ///
    /// # Errors
    /// An I/O error, or the exchange is not supported; then the folder is unchanged.
    pub(super) fn exchange(&self, workspace: &Workspace, sync: bool) -> io::Result<()> {
        let as_of = self.folder.metadata()?;
        let is_beside = workspace.place.path.parent() == self.folder.parent();
        // The run and the shell that started it would end up in a deleted folder.
        let is_current = fs::metadata(".").is_ok_and(|current| is_same(&current, &as_of));
        let Some(kept) = self.kept.as_ref().filter(|_| is_beside && !is_current) else {
            return Err(io::ErrorKind::Unsupported.into());
        };
        let (new, old) = (workspace.place.new_files(), workspace.place.exchanged());
        for name in kept {
            change(|| fs::hard_link(self.folder.join(name), new.join(name)))?;
        }
        #[cfg(unix)]
        disk::set_owner(&new, &as_of)?;
        change(|| fs::set_permissions(&new, as_of.permissions()))?;
        if sync {
            disk::sync(&new)?;
        }
        // After a kill, not all files in it are known to be raycost's.
        change(|| fs::rename(&new, &old))?;
        if let Err(error) = disk::exchange(&old, self.folder) {
            twice(|| change(|| fs::rename(&old, &new)))?;
            return Err(error);
        }
        // What fails here remains in the workspace.
        let _ = twice(|| self.hand_over(&old, kept));
        Ok(())
    }

    /// Removes raycost's files from the exchanged folder.
    pub(super) fn remove_old(&self, workspace: &Workspace) {
        remove_files(&workspace.place.exchanged(), |path| self.is_old(path));
    }

    /// Moves foreign files that appeared in the old folder just before the exchange to the new one.
    fn hand_over(&self, old: &Path, kept: &[String]) -> io::Result<()> {
        for entry in fs::read_dir(old)? {
            let entry = entry?;
            if self.is_old(&entry.path()) {
                continue;
            }
            let name = entry.file_name();
            let there = self.folder.join(&name);
            let is_newer = match fs::symlink_metadata(&there) {
                Ok(there) => entry.metadata()?.modified()? > there.modified()?,
                // A file that was in both folders has been removed since.
                Err(_) => !kept.iter().any(|known| name == known.as_str()),
            };
            if is_newer {
                change(|| fs::rename(entry.path(), &there))?;
            } else {
                change(|| fs::remove_file(entry.path()))?;
            }
        }
        Ok(())
    }

    /// Replaces the old files with the new ones one by one. If a file cannot be moved, all moves are
    /// taken back.
    ///
    /// # Errors
    /// An I/O error.
    pub(super) fn replace_one_by_one(&self, workspace: &mut Workspace) -> io::Result<()> {
        workspace.move_to(self.folder)?;
        let (new, old) = (workspace.place.new_files(), workspace.place.old_files());
        change(|| fs::create_dir(&old))?;
        let away = |name| (self.folder.join(name), old.join(name));
        let into_place = |name| (new.join(name), self.folder.join(name));
        let away = self.old.iter().map(away);
        let moves: Vec<(PathBuf, PathBuf)> = away.chain(self.new.iter().map(into_place)).collect();
        for (n_done, (from, to)) in moves.iter().enumerate() {
            if let Err(error) = change(|| fs::rename(from, to)) {
                let mut back = moves[..n_done].iter().rev();
                let taken_back =
                    back.try_for_each(|(from, to)| twice(|| change(|| fs::rename(to, from))));
                // The old files stay where they are.
                workspace.remains = taken_back.is_err();
                return Err(error);
            }
        }
        Ok(())
    }

    fn is_old(&self, path: &Path) -> bool {
        let name = path.file_name().unwrap_or_default();
        self.old.iter().any(|old| name == old.as_str())
    }
}

/// Returns the names of all foreign files; `None` if one of them cannot be linked.
fn kept(folder: &Path, old: &[String]) -> io::Result<Option<Vec<String>>> {
    let mut kept = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let kind = entry.file_type()?;
        let Ok(name) = entry.file_name().into_string() else {
            return Ok(None);
        };
        // The workspaces of other commands follow.
        if old.contains(&name) || workspace::is_name(&name) && kind.is_dir() {
            continue;
        }
        if !(kind.is_file() || kind.is_symlink()) || kept.len() == MAX_KEPT {
            return Ok(None);
        }
        kept.push(name);
    }
    Ok(Some(kept))
}
