//! A file that was written.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::writer::{FileWriter, checksum_of};
use crate::provenance::Checksum;
use base::numbers::milliseconds;

/// A file that was written.
#[derive(Debug, Clone)]
pub struct Written {
    /// Name in the folder.
    pub file: String,
    /// Length in bytes.
    pub bytes: u64,
    /// Checksum.
    pub checksum: Checksum,
    /// Wall time from the first byte to the last, in milliseconds; other files were written
    /// concurrently.
    pub write_ms: f64,
}

impl Written {
    /// Writes a new file to a folder that has no file of this name.
    pub(super) fn write(
        folder: &Path,
        name: &str,
        write: impl FnOnce(&mut FileWriter) -> io::Result<()>,
    ) -> io::Result<Self> {
        Self::timed(folder, name, |path| {
            let mut out = FileWriter::create(path)?;
            write(&mut out)?;
            out.finish()
        })
    }

    /// Writes a new file, with a function that creates it, to a folder that has no file of this
    /// name.
    pub(super) fn write_at(
        folder: &Path,
        name: &str,
        write: impl FnOnce(&Path) -> io::Result<()>,
    ) -> io::Result<Self> {
        Self::timed(folder, name, |path| {
            write(&path)?;
            Ok((path.metadata()?.len(), checksum_of(&path)?))
        })
    }

    /// Times `write`, which returns the length and the checksum of the file.
    fn timed(
        folder: &Path,
        name: &str,
        write: impl FnOnce(PathBuf) -> io::Result<(u64, Checksum)>,
    ) -> io::Result<Self> {
        let start = Instant::now();
        let (bytes, checksum) = write(folder.join(name))?;
        Ok(Self {
            file: name.to_owned(),
            bytes,
            checksum,
            write_ms: milliseconds(start.elapsed()),
        })
    }
}
