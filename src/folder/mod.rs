//! The folder that files go to, changed as a whole or not at all.
//!
//! A run takes these steps, and may be killed between any two of them:
//!
//! 1. It locks the folder (`lock`): a second run is refused at once.
//! 2. It takes back what a killed run has begun (`journal`), and removes what
//!    it has left (`workspace`).
//! 3. It makes sure that each file that it will write or remove is raycost's
//!    own (`own`); a file of someone else's is refused before the first ray.
//! 4. It writes all files into a workspace (`staged`), each with its checksum.
//! 5. It commits them. Where the system can, the folder of new files and the
//!    output folder exchange their names (`exchange`): one step, before which
//!    all files are old, and after which all are new, for every reader.
//!    Elsewhere, or where the folder has folders of others in it, is a mount
//!    point or some process's current directory, files change one by one
//!    under a `journal`, by which the next command takes the change back if it
//!    was broken off. Commands that read wait for a journal, or take it back.
//! 6. It removes the old files: freeing a large one may take long.
//!
//! Files of others stay, as do the folder's permissions and those of each file
//! that is replaced. Nothing is forced onto the disk unless `sync` is asked for:
//! a power cut may lose the newest files or parts of them, and their lengths, run
//! IDs and checksums tell (see [`run`](super::run)).

mod disk;
mod error;
mod exchange;
mod journal;
mod lock;
mod own;
mod single;
mod staged;
mod staging;
mod workspace;
#[cfg(test)]
mod tests;

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

pub use error::WriteError;
pub(crate) use own::{Own, foreign as refuse_file};
pub(crate) use single::{Replace, target, write_file};
pub(crate) use staged::{FileWriter, StagedFile, checksum_of};
pub(crate) use staging::Staging;

use workspace::Workspace;

use crate::provenance::Checksum;
use crate::text::numbers;

/// The file that lists the others of its folder.
pub(crate) const SUMMARY: &str = "summary.json";

/// A file that was written.
#[derive(Debug, Clone)]
pub struct Written {
    /// Its name in the folder.
    pub file: &'static str,
    /// Its length.
    pub bytes: u64,
    /// Its checksum.
    pub checksum: Checksum,
    /// Time on the wall from the first byte to the last, in milliseconds, while
    /// other files were written, too.
    pub write_ms: f64,
}

/// A folder that files can be written to, locked for this run.
#[derive(Debug)]
pub struct OutputFolder {
    /// As the user named it, from the root on.
    path: PathBuf,
    /// Where it is, links followed.
    place: PathBuf,
    /// Whether files are forced onto the disk.
    sync: bool,
    /// On the folder that has its name.
    lock: Mutex<Option<File>>,
}

/// How long a reader waits for a commit of another run.
const PATIENCE: Duration = Duration::from_secs(5);

impl OutputFolder {
    /// Makes the folder if it is not there, locks it, ends what a killed run has
    /// left, and makes sure that files can be written to it and that `n_bytes`
    /// are free.
    ///
    /// # Errors
    /// What keeps files from being written.
    pub fn create(path: &Path, n_bytes: u64) -> Result<Self, WriteError> {
        let fail = |error| WriteError::new(path, error);
        refuse_unspeakable(path)?;
        fs::create_dir_all(path).map_err(fail)?;
        let place = fs::canonicalize(path).map_err(fail)?;
        let lock = lock_of(path, &place)?;
        journal::roll_back(&place)?;
        workspace::remove_left(&place);
        let this = Self {
            // Absolute, since ParaView may be started from anywhere.
            path: std::path::absolute(path).map_err(fail)?,
            place,
            sync: false,
            lock: Mutex::new(Some(lock)),
        };
        // Files of the kind that will be made: what is wrong shows now.
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

    /// The same, with files forced onto the disk before they take their places:
    /// they survive a power cut.
    pub fn synced(self, sync: bool) -> Self {
        Self { sync, ..self }
    }

    /// The absolute path of a file in the folder.
    pub fn path_of(&self, file: &str) -> PathBuf {
        self.path.join(file)
    }

    /// Makes sure that no file in the folder is someone else's of a name that a
    /// command writes.
    ///
    /// # Errors
    /// Such a file.
    pub(crate) fn refuse_foreign(&self, own: &Own) -> Result<(), WriteError> {
        own.find(&self.place).map(|_| ())
    }

    /// Begins to write files.
    ///
    /// # Errors
    /// What the system says.
    pub(crate) fn stage_files(&self) -> Result<Staging<'_>, WriteError> {
        let name = self.place.file_name().unwrap_or_default();
        let beside = exchange::parent_of(&self.place)
            .and_then(|parent| Workspace::create(&parent, name).ok());
        let fail = |error| WriteError::new(&self.path, error);
        let workspace = match beside {
            Some(workspace) => workspace,
            None => Workspace::create(&self.place, name).map_err(fail)?,
        };
        let lock = lock::lock(&workspace.new_files()).map_err(fail)?;
        Ok(Staging {
            folder: self,
            workspace,
            lock,
        })
    }
}

/// A folder in a folder for what does not stay, such as the output of a run that
/// only its numbers are wanted of.
#[derive(Debug)]
pub(crate) struct Scratch(Workspace);

impl Scratch {
    /// Makes one.
    ///
    /// # Errors
    /// What the system says.
    pub(crate) fn create(folder: &Path) -> Result<Self, WriteError> {
        let workspace = Workspace::create(folder, folder.file_name().unwrap_or_default());
        Ok(Self(
            workspace.map_err(|error| WriteError::new(folder, error))?,
        ))
    }

    /// Where it is; empty at first.
    pub(crate) fn path(&self) -> PathBuf {
        self.0.new_files()
    }
}

/// Makes a folder for files that are written to it one by one, locks it as long
/// as what is given back lives, and removes what killed runs have left in it.
///
/// # Errors
/// Another run that has locked it, or what the system says.
pub(crate) fn lock_folder(path: &Path) -> Result<File, WriteError> {
    refuse_unspeakable(path)?;
    let fail = |error| WriteError::new(path, error);
    fs::create_dir_all(path).map_err(fail)?;
    let place = fs::canonicalize(path).map_err(fail)?;
    let lock = lock_of(path, &place)?;
    workspace::remove_left(&place);
    Ok(lock)
}

fn lock_of(path: &Path, place: &Path) -> Result<File, WriteError> {
    let lock = lock::lock(place).map_err(|error| WriteError::new(path, error))?;
    lock.ok_or_else(|| {
        let why = "another run is writing to this folder";
        let help = "wait for it, or choose another folder with `--out`";
        WriteError::refused(path, why, help)
    })
}

/// For who is about to read a folder: waits until another run has put its files
/// in place, and takes back what a killed one has begun.
///
/// # Errors
/// A run that does not end it, or what the system says.
pub(crate) fn settle(folder: &Path) -> Result<(), WriteError> {
    let begin = Instant::now();
    while journal::is_in(folder) {
        let lock = lock::lock(folder).map_err(|error| WriteError::new(folder, error))?;
        if let Some(_lock) = lock {
            return journal::roll_back(folder);
        }
        if begin.elapsed() > PATIENCE {
            let why = "another run is putting its files in place";
            return Err(WriteError::refused(
                folder,
                why,
                "try again when it has ended",
            ));
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    Ok(())
}

/// Makes sure that states can hold the path of the folder: they are XML.
fn refuse_unspeakable(path: &Path) -> Result<(), WriteError> {
    let path = std::path::absolute(path).map_err(|error| WriteError::new(path, error))?;
    let is_speakable = |c: char| !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}');
    let why = match path.to_str() {
        None => "its path is not UTF-8, and ParaView's states have to hold it",
        Some(text) if text.chars().all(is_speakable) => return Ok(()),
        Some(_) => "its path has a control character, and ParaView's states have to hold it",
    };
    Err(WriteError::refused(
        path,
        why,
        "choose a folder of another name with `--out`",
    ))
}
