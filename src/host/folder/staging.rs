//! New files of an output folder: written to a workspace, then committed.

use std::io;
use std::path::Path;

use super::OutputFolder;
use super::commit::Commit;
use super::disk;
use super::error::WriteError;
use super::lock::Lock;
use super::own::Own;
use super::workspace::{self, Workspace};
use super::writer::FileWriter;
use super::written::Written;

/// New files of an output folder. Dropping them without a commit removes them.
#[derive(Debug)]
pub struct Staging<'a> {
    pub(super) folder: &'a OutputFolder,
    pub(super) workspace: Workspace,
    /// The lock on the folder of new files, which may become the output folder.
    pub(super) lock: Option<Lock>,
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
        let staged = Written::write(&self.workspace.place.new_files(), name, write);
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
        let staged = Written::write_at(&self.workspace.place.new_files(), name, write);
        staged.map_err(|error| WriteError::new(self.folder.path_of(name), error))
    }

    /// Moves all files into the folder, and removes the files of `own` that are not among them.
    ///
    /// # Errors
    /// A file of another program, or an I/O error; then the folder is unchanged, or has no summary.
    pub fn commit(mut self, files: &[Written], own: &Own) -> Result<(), WriteError> {
        let OutputFolder {
            path, place, sync, ..
        } = self.folder;
        let fail = |error| WriteError::new(path, error);
        let commit = Commit::new(place, files, own)?;
        commit.prepare(&self.workspace, *sync).map_err(fail)?;
        let exchanged = commit.exchange(&self.workspace, *sync);
        // Flush the folder, and take over its lock.
        let is_exchanged = exchanged.is_ok();
        let replaced = exchanged.or_else(|_| commit.replace_one_by_one(&mut self.workspace));
        let synced = match place.parent().filter(|_| *sync) {
            Some(parent) => disk::sync(parent).and_then(|()| disk::sync(place)),
            None => Ok(()),
        };
        if is_exchanged && let Ok(mut lock) = self.folder.lock.lock() {
            *lock = self.lock;
        }
        replaced.map_err(fail)?;
        commit.remove_old(&self.workspace);
        workspace::remove_left(place);
        synced.map_err(|_| {
            let why = "the new files are in their places, but may not survive a power cut";
            WriteError::refused(path, why, "look after the disk, and render again")
        })
    }
}
