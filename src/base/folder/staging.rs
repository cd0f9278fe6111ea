//! New files of an output folder: written to a workspace, then committed.

use std::fs::{self, File};
use std::io;
use std::path::Path;

use super::disk::{self, change};
use super::error::WriteError;
use super::lock::number_of;
use super::own::{self, Own};
use super::plan::CommitPlan;
use super::workspace::Workspace;
use super::writer::FileWriter;
use super::written::Written;
use super::{OutputFolder, SUMMARY, exchange, one_by_one};

/// New files of an output folder. Dropping them without a commit removes them.
#[derive(Debug)]
pub struct Staging<'a> {
    pub(super) folder: &'a OutputFolder,
    pub(super) workspace: Workspace,
    /// The lock on the folder of new files, which may become the output folder.
    pub(super) lock: Option<File>,
}

impl Staging<'_> {
    /// Writes the new file `name`.
    ///
    /// # Errors
    /// The errors of `write`, or an I/O error.
    pub fn stage(
        &self,
        name: impl AsRef<str>,
        write: impl FnOnce(&mut FileWriter) -> io::Result<()>,
    ) -> Result<Written, WriteError> {
        let name = name.as_ref();
        let staged = Written::write(&self.workspace.new_files(), name, write);
        staged.map_err(|error| WriteError::new(self.folder.path_of(name), error))
    }

    /// Writes the new file `name` with a function that creates it.
    ///
    /// # Errors
    /// The errors of `write`, or an I/O error.
    pub fn stage_at(
        &self,
        name: &str,
        write: impl FnOnce(&Path) -> io::Result<()>,
    ) -> Result<Written, WriteError> {
        let staged = Written::write_at(&self.workspace.new_files(), name, write);
        staged.map_err(|error| WriteError::new(self.folder.path_of(name), error))
    }

    /// Moves all files into the folder, and removes the files of `own` that are not among them.
    ///
    /// # Errors
    /// A file of another program, or an I/O error; then the folder is unchanged, or the next run
    /// takes the commit back.
    pub fn commit(mut self, files: &[Written], own: &Own) -> Result<(), WriteError> {
        let OutputFolder {
            path, place, sync, ..
        } = self.folder;
        let fail = |error| WriteError::new(path, error);
        let plan = self.plan(files, own)?;
        self.prepare(&plan).map_err(fail)?;
        // Exchange the folders, or replace the files one by one.
        let exchanged = exchange::commit(place, &self.workspace, &plan, *sync);
        let is_exchanged = exchanged.is_ok() || self.workspace.was_exchanged();
        let replaced = if is_exchanged {
            Ok(())
        } else {
            let moved = self.workspace.move_to(place);
            moved.and_then(|()| one_by_one::commit(place, &self.workspace.path, &plan))
        };
        // Flush the folder, and take over its lock.
        let synced = match place.parent().filter(|_| *sync) {
            Some(parent) => disk::sync(parent).and_then(|()| disk::sync(place)),
            None => Ok(()),
        };
        if is_exchanged && let Ok(mut lock) = self.folder.lock.lock() {
            *lock = self.lock;
        }
        replaced.map_err(fail)?;
        synced.map_err(|_| {
            let why = "the new files are in their places, but may not survive a power cut";
            WriteError::refused(path, why, "look after the disk, and render again")
        })
    }

    /// Plans the commit, and checks that no foreign file is in the way.
    fn plan(&self, files: &[Written], own: &Own) -> Result<CommitPlan, WriteError> {
        let OutputFolder { path, place, .. } = self.folder;
        let fail = |error| WriteError::new(path, error);
        let mut old = own.find(place)?;
        let mut new: Vec<String> = files.iter().map(|file| file.file.clone()).collect();
        let in_the_way =
            |name: &&String| !old.contains(name) && place.join(name).symlink_metadata().is_ok();
        if let Some(name) = new.iter().find(in_the_way) {
            return Err(own::foreign(&path.join(name)));
        }
        old.sort_by_key(|name| name != SUMMARY);
        new.sort_by_key(|name| name == SUMMARY);
        let folder = place.file_name().unwrap_or_default().to_string_lossy();
        Ok(CommitPlan {
            folder: folder.into_owned(),
            staged: number_of(&self.workspace.new_files().metadata().map_err(fail)?),
            kept: exchange::kept(place, &old).map_err(fail)?,
            new,
            old,
        })
    }

    /// Gives each new file the permissions of the old one, writes the plan, and flushes all to the
    /// disk if requested.
    fn prepare(&self, plan: &CommitPlan) -> io::Result<()> {
        let new_files = self.workspace.new_files();
        for name in &plan.new {
            let (old, new) = (self.folder.place.join(name), new_files.join(name));
            if plan.old.contains(name) {
                let permissions = old.metadata()?.permissions();
                if permissions != new.metadata()?.permissions() {
                    change(|| fs::set_permissions(&new, permissions))?;
                }
            }
            if self.folder.sync {
                disk::sync(&new)?;
            }
        }
        plan.write(&self.workspace.path, self.folder.sync)
    }
}
