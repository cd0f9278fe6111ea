//! Reads files: path → bytes. Every file of a scene and of an output folder is opened here, and
//! only [regular](open) files are.
//!
//! A single process reads its files from disk as it needs them. Ranks [`share`] theirs: the leader
//! reads each file whole and broadcasts it, so that only the leader needs the files, and the file
//! system serves one reader.

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
    /// A file on disk, read on demand.
    OnDisk(File),
    /// The whole file in memory, as the leader broadcast it.
    InMemory(Cursor<Vec<u8>>),
}

impl InputFile {
    /// Opens a file.
    ///
    /// # Errors
    /// An I/O error, or not a regular file. A shared file also fails if the leader cannot read it
    /// to its end, or if it is longer than the free memory.
    pub fn open(path: &Path) -> io::Result<Self> {
        if !shared::is_active() {
            return Ok(Self::OnDisk(open(path)?));
        }
        let bytes = shared::contents(path)?;
        Ok(Self::InMemory(Cursor::new(bytes)))
    }

    /// Returns the length in bytes.
    ///
    /// # Errors
    /// An I/O error.
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

/// Returns the length of a regular file in bytes; `None` for a folder, a device and the like.
///
/// # Errors
/// The path does not exist, or cannot be inspected.
pub fn length_of(path: &Path) -> io::Result<Option<u64>> {
    shared::found(path, |path| {
        let metadata = path.metadata()?;
        Ok(metadata.is_file().then_some(metadata.len()))
    })
}

/// Returns true if the path is a regular file.
pub fn is_file(path: &Path) -> bool {
    matches!(length_of(path), Ok(Some(_)))
}

/// Returns the canonical path of a file, without symbolic links.
///
/// # Errors
/// The path does not exist, or cannot be resolved.
pub fn canonical(path: &Path) -> io::Result<PathBuf> {
    let text = shared::found(path, |path| {
        let canonical = path.canonicalize()?;
        Ok(canonical.to_string_lossy().into_owned())
    });
    text.map(PathBuf::from)
}
