//! Paths of the files that are read → their bytes. All files of a scene and of an output folder
//! are opened here, and only [regular](open) ones are.
//!
//! A process alone reads its files from disk as it needs them. Several ranks [`share`] them:
//! one of them, the leader, reads each file whole and broadcasts it, so that only the leader
//! needs the files, and a file system serves one reader.

mod regular;
mod shared;
#[cfg(test)]
mod tests;

use std::fs::File;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

pub use regular::{open, open_with, read, read_text};
pub use shared::{Broadcast, SharedFiles, share};

/// An open file.
#[derive(Debug)]
pub enum InputFile {
    /// One that is read as it is needed.
    OnDisk(File),
    /// One of the leader, whole.
    InMemory(Cursor<Vec<u8>>),
}

impl InputFile {
    /// Opens a file.
    ///
    /// # Errors
    /// The errors of the system, and that it is not a regular file; of a shared file also that it
    /// cannot be read to its end, or that it is longer than the free memory.
    pub fn open(path: &Path) -> io::Result<Self> {
        if !shared::is_active() {
            return Ok(Self::OnDisk(open(path)?));
        }
        let bytes = shared::contents(path)?;
        Ok(Self::InMemory(Cursor::new(bytes)))
    }

    /// Its length in bytes.
    ///
    /// # Errors
    /// The errors of the system.
    pub fn length(&self) -> io::Result<u64> {
        match self {
            Self::OnDisk(file) => file.metadata().map(|metadata| metadata.len()),
            Self::InMemory(bytes) => Ok(bytes.get_ref().len() as u64),
        }
    }
}

impl Read for InputFile {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::OnDisk(file) => file.read(bytes),
            Self::InMemory(file) => file.read(bytes),
        }
    }
}

impl Seek for InputFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match self {
            Self::OnDisk(file) => file.seek(to),
            Self::InMemory(file) => file.seek(to),
        }
    }
}

/// The length of a regular file in bytes; `None` for a folder, a device and the like.
///
/// # Errors
/// There is nothing at the path, or the system refuses to say what.
pub fn length_of(path: &Path) -> io::Result<Option<u64>> {
    shared::found(path, |path| {
        let metadata = path.metadata()?;
        Ok(metadata.is_file().then_some(metadata.len()))
    })
}

/// Whether there is a regular file at a path.
pub fn is_file(path: &Path) -> bool {
    matches!(length_of(path), Ok(Some(_)))
}

/// The one path of a file that may have several.
///
/// # Errors
/// There is nothing at the path, or the system refuses to say where.
pub fn canonical(path: &Path) -> io::Result<PathBuf> {
    let text = shared::found(path, |path| {
        let canonical = path.canonicalize()?;
        Ok(canonical.to_string_lossy().into_owned())
    });
    text.map(PathBuf::from)
}
