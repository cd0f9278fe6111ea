//! New files of an output folder: written to a workspace, then committed.

use std::fs::File;
use std::io;
use std::path::Path;

use super::error::WriteError;
use super::own::{self, Own};
use super::staged::StagedFile;
use super::workspace::{self, CommitPlan, Workspace};
use super::writer::FileWriter;
use super::{OutputFolder, disk, exchange, journal};

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
    ) -> Result<StagedFile, WriteError> {
        let name = name.as_ref();
        let staged = StagedFile::write(&self.workspace.new_files(), name, write);
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
    ) -> Result<StagedFile, WriteError> {
        let staged = StagedFile::write_at(&self.workspace.new_files(), name, write);
        staged.map_err(|error| WriteError::new(self.folder.path_of(name), error))
    }

    /// Moves all files into the folder, and removes the files of `own` that are not among them.
    ///
    /// # Errors
    /// A file of another program, or an I/O error; then the folder is unchanged.
    pub fn commit(self, files: &[StagedFile], own: &Own) -> Result<(), WriteError> {
        let OutputFolder {
            path, place, sync, ..
        } = self.folder;
        // Check that no foreign file is in the way.
        let old = own.find(place)?;
        let new: Vec<String> = files.iter().map(|file| file.name().to_owned()).collect();
        let in_the_way =
            |name: &&String| !old.contains(name) && place.join(name).symlink_metadata().is_ok();
        if let Some(name) = new.iter().find(in_the_way) {
            return Err(own::foreign(&path.join(name)));
        }
        let fail = |error| WriteError::new(path, error);
        // Plan the commit, and prepare the new files.
        let plan = CommitPlan {
            raycost: env!("CARGO_PKG_VERSION").to_owned(),
            staged: workspace::number_of(&self.workspace.new_files()).map_err(fail)?,
            new,
            old,
            kept: Vec::new(),
        };
        self.prepare(&plan).map_err(fail)?;
        // Exchange the folders, or move the files with a journal.
        let exchanged = exchange::commit(place, &self.workspace, plan.clone(), *sync);
        if !matches!(exchanged, Ok(true)) && !self.workspace.was_exchanged() {
            journal::commit(place, &self.workspace, &plan, *sync).map_err(fail)?;
        }
        // Flush the folder, take over its lock, and remove the workspace.
        let synced = match place.parent().filter(|_| *sync) {
            Some(parent) => disk::sync(parent).and_then(|()| disk::sync(place)),
            None => Ok(()),
        };
        if self.workspace.was_exchanged()
            && let Ok(mut lock) = self.folder.lock.lock()
        {
            *lock = self.lock;
        }
        self.workspace.settle(place);
        synced.map_err(|_| {
            let why = "the new files are in their places, but may not survive a power cut";
            WriteError::refused(path, why, "look after the disk, and render again")
        })
    }

    /// Gives each new file the permissions of the old one, and flushes it to the disk
    /// if requested.
    fn prepare(&self, plan: &CommitPlan) -> io::Result<()> {
        let new_files = self.workspace.new_files();
        for name in &plan.new {
            let (old, new) = (self.folder.place.join(name), new_files.join(name));
            if plan.old.contains(name) {
                let permissions = old.metadata()?.permissions();
                if permissions != new.metadata()?.permissions() {
                    disk::set_permissions(&new, permissions)?;
                }
            }
            if self.folder.sync {
                disk::sync(&new)?;
            }
        }
        Ok(())
    }
}
