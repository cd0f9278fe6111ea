//! The output folder: a run replaces all of its files, or none.
//!
//! A run takes these steps, and may be killed between any two of them:
//!
//! 1. It locks the folder (`lock`); a second run is refused.
//! 2. It removes the temporary files of killed runs (`workspace`). These never say what to move, or
//!    what to remove elsewhere: a stranger may have made them.
//! 3. It checks that each file that it will write or remove was written by raycost (`own`). A file
//!    of another program is refused before the first ray.
//! 4. It writes all files into a workspace (`staging`), each with its checksum (`written`). The
//!    workspace is beside the folder if it can be renamed from the one to the other, else in it.
//! 5. It commits them (`commit`). If the system supports it, the folder of new files and the output
//!    folder exchange their names: a reader sees either all old files or all new ones. Otherwise, or
//!    if the output folder contains foreign folders or is the current directory of the run, it
//!    replaces the files one by one: a reader that comes in between, or after a kill, finds no
//!    summary, and the next run replaces what there is.
//! 6. It removes the old files last, because freeing a large file can be slow.
//!
//! After an exchange, another process whose current directory is the folder has the removed old
//! one: only a list of all processes could show that, and only for the user's own.
//!
//! Foreign files remain, and so do the permissions of the folder and of replaced files. Without
//! `sync`, a power cut may lose the newest files or parts of them; lengths, run IDs and checksums
//! reveal that (see [`provenance`](crate::provenance)).

mod commit;
mod disk;
mod error;
mod listing;
mod lock;
mod own;
mod single;
mod staging;
mod workspace;
mod writer;
mod written;
#[cfg(test)]
mod tests;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::thread::sleep;
use std::time::{Duration, Instant};

pub use error::WriteError;
pub use lock::Lock;
pub use own::{Own, foreign as refuse_file};
pub use single::{Replace, refuse_foreign_file, write_file, write_file_at};
pub use staging::Staging;
pub use writer::{FileWriter, checksum_of};
pub use written::Written;

use workspace::Workspace;

use base::numbers;

/// The name of the file that lists the other files of its folder.
pub const SUMMARY: &str = "summary.json";

/// An output folder, locked for this run.
#[derive(Debug)]
pub struct OutputFolder {
    /// The absolute path that the user gave.
    path: PathBuf,
    /// The canonical path, without symbolic links.
    place: PathBuf,
    /// True if files are flushed to the disk.
    sync: bool,
    /// The lock on the folder that currently has the name.
    lock: Mutex<Option<Lock>>,
}

/// Longest time that a reader waits while a run replaces files one by one.
const PATIENCE: Duration = Duration::from_secs(5);
/// Longest time that a run waits for its turn to write files.
const PATIENCE_OF_WRITERS: Duration = Duration::from_secs(60);

impl OutputFolder {
    /// Creates the folder if it does not exist, locks it, and checks that it is writable and that
    /// `n_bytes` are free.
    ///
    /// # Errors
    /// The folder cannot be written, or is not raycost's to write.
    pub fn create(path: &Path, n_bytes: u64) -> Result<Self, WriteError> {
        let fail = |error| WriteError::new(path, error);
        let (place, lock) = locked(path, Duration::ZERO)?;
        let this = Self {
            // Absolute, because ParaView may be started in any folder.
            path: std::path::absolute(path).map_err(fail)?,
            place,
            sync: false,
            lock: Mutex::new(Some(lock)),
        };
        // Create a temporary file as the run will, so that errors show now.
        this.stage_files()?;
        let free = fs4::available_space(&this.place).map_err(fail)?;
        if free < n_bytes {
            let message = format!(
                "{} are free, {} or more are needed",
                numbers::bytes(free),
                numbers::bytes(n_bytes)
            );
            return Err(fail(io::Error::new(io::ErrorKind::StorageFull, message)));
        }
        Ok(this)
    }

    /// Sets whether files are flushed to the disk before the commit, so that they
    /// survive a power cut.
    pub fn synced(self, sync: bool) -> Self {
        Self { sync, ..self }
    }

    /// The absolute path of a file in the folder.
    pub fn path_of(&self, file: &str) -> PathBuf {
        self.path.join(file)
    }

    /// Checks that a command would not overwrite a file of another program.
    ///
    /// # Errors
    /// The first file of another program.
    pub fn refuse_foreign(&self, own: &Own) -> Result<(), WriteError> {
        own.find(&self.place).map(|_| ())
    }

    /// Creates a workspace for new files.
    ///
    /// # Errors
    /// An I/O error.
    pub fn stage_files(&self) -> Result<Staging<'_>, WriteError> {
        let fail = |error| WriteError::new(&self.path, error);
        let name = self.place.file_name().unwrap_or_default();
        let mut workspace = Workspace::create(&self.place, name).map_err(fail)?;
        // It stays in a folder of another file system than its parent's, and in a mount point.
        let _ = self.place.parent().map(|parent| workspace.move_to(parent));
        let lock = lock::lock(&workspace.place.new_files()).map_err(fail)?;
        Ok(Staging {
            folder: self,
            workspace,
            lock,
        })
    }
}

/// A temporary folder inside another one, such as for the output of a study's run. Dropping it
/// removes all that is in it.
#[derive(Debug)]
pub struct Scratch(Workspace);

impl Scratch {
    /// Creates a scratch folder.
    ///
    /// # Errors
    /// An I/O error.
    pub fn create(folder: &Path) -> Result<Self, WriteError> {
        let workspace = Workspace::create(folder, folder.file_name().unwrap_or_default());
        Ok(Self(
            workspace.map_err(|error| WriteError::new(folder, error))?,
        ))
    }

    /// Returns the path; the folder is initially empty.
    pub fn path(&self) -> PathBuf {
        self.0.place.new_files()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0.place.path);
    }
}

/// Creates a folder within an output folder. A link in the place of one of its parts is not
/// followed.
///
/// # Errors
/// A link, a file of this name, or an error of the system.
pub fn create_within(folder: &Path, inner: &Path) -> Result<PathBuf, WriteError> {
    let path = folder.join(inner);
    let mut parts = path.ancestors().take(inner.components().count());
    if let Some(link) = parts.find(|part| part.is_symlink()) {
        return Err(own::foreign(link));
    }
    fs::create_dir_all(&path).map_err(|error| WriteError::new(&path, error))?;
    Ok(path)
}

/// Creates a folder for files that are written one by one, locks it for the lifetime
/// of the returned file, and removes temporary files of killed runs.
///
/// # Errors
/// The folder is locked by another run, or an error of the system.
pub fn lock_folder(path: &Path) -> Result<Lock, WriteError> {
    Ok(locked(path, Duration::ZERO)?.1)
}

/// Locks a folder as [`lock_folder`] does, but waits while another run has locked it.
///
/// # Errors
/// Another run holds the lock for a minute, or an error of the system.
pub fn lock_folder_in_turn(path: &Path) -> Result<Lock, WriteError> {
    Ok(locked(path, PATIENCE_OF_WRITERS)?.1)
}

/// Creates a folder if it does not exist, locks it, and cleans up after killed runs; returns its
/// canonical path and the lock.
fn locked(path: &Path, patience: Duration) -> Result<(PathBuf, Lock), WriteError> {
    let fail = |error| WriteError::new(path, error);
    refuse_unprintable(path)?;
    refuse_root(path)?;
    fs::create_dir_all(path).map_err(fail)?;
    let place = fs::canonicalize(path).map_err(fail)?;
    let begin = Instant::now();
    let lock = loop {
        match lock::lock(&place).map_err(fail)? {
            Some(lock) => break lock,
            None if begin.elapsed() < patience => sleep(Duration::from_millis(20)),
            None => {
                let why = "another run is writing to this folder";
                let help = "wait for it, or choose another folder with `--out`";
                return Err(WriteError::refused(path, why, help));
            }
        }
    };
    workspace::remove_left(&place);
    Ok((place, lock))
}

/// Refuses the root of the file system as an output folder.
///
/// # Errors
/// The path is the root.
pub fn refuse_root(path: &Path) -> Result<(), WriteError> {
    match fs::canonicalize(path) {
        Ok(place) if place.parent().is_none() => {
            let why = "it is the root of the file system";
            let help = "name a folder for the output with `--out`";
            Err(WriteError::refused(path, why, help))
        }
        _ => Ok(()),
    }
}

/// Returns true if this folder lacks its summary because a run that replaced its files one by one
/// was killed, or goes on; waits a few seconds for the end.
pub fn is_unfinished(folder: &Path) -> bool {
    let begin = Instant::now();
    while !folder.join(SUMMARY).exists() && workspace::summaries_in(folder).next().is_some() {
        let is_live = matches!(lock::lock(folder), Ok(None));
        if !is_live || begin.elapsed() > PATIENCE {
            return true;
        }
        sleep(Duration::from_millis(5));
    }
    false
}

/// Refuses a path that ParaView states, which are XML, cannot hold.
fn refuse_unprintable(path: &Path) -> Result<(), WriteError> {
    let path = std::path::absolute(path).map_err(|error| WriteError::new(path, error))?;
    let is_printable = |c: char| !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}');
    let why = match path.to_str() {
        None => "its path is not UTF-8, and ParaView's states have to hold it",
        Some(text) if text.chars().all(is_printable) => return Ok(()),
        Some(_) => "its path has a control character, and ParaView's states have to hold it",
    };
    Err(WriteError::refused(
        path,
        why,
        "choose a folder of another name with `--out`",
    ))
}
