//! A new file in a workspace.

use std::io;
use std::path::Path;
use std::time::Instant;

use super::Written;
use super::writer::{FileWriter, checksum_of};
use crate::provenance::Checksum;
use crate::text::numbers::milliseconds;

/// A complete file in a workspace.
#[derive(Debug)]
pub struct StagedFile {
    name: String,
    n_bytes: u64,
    checksum: Checksum,
    write_ms: f64,
}

impl StagedFile {
    /// Writes a file to a folder in which no file has this name.
    pub(super) fn write(
        folder: &Path,
        name: &str,
        write: impl FnOnce(&mut FileWriter) -> io::Result<()>,
    ) -> io::Result<Self> {
        let start = Instant::now();
        let mut out = FileWriter::create(folder.join(name))?;
        write(&mut out)?;
        let (n_bytes, checksum) = out.finish()?;
        Ok(Self {
            name: name.to_owned(),
            n_bytes,
            checksum,
            write_ms: milliseconds(start.elapsed()),
        })
    }

    /// Creates a file by a function in a folder in which no file has this name.
    pub(super) fn write_at(
        folder: &Path,
        name: &str,
        write: impl FnOnce(&Path) -> io::Result<()>,
    ) -> io::Result<Self> {
        let start = Instant::now();
        let path = folder.join(name);
        write(&path)?;
        Ok(Self {
            name: name.to_owned(),
            n_bytes: path.metadata()?.len(),
            checksum: checksum_of(&path)?,
            write_ms: milliseconds(start.elapsed()),
        })
    }

    /// Its name in the folder.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Name, length, checksum and time of writing.
    pub fn written(&self) -> Written {
        Written {
            file: self.name.clone(),
            bytes: self.n_bytes,
            checksum: self.checksum,
            write_ms: self.write_ms,
        }
    }
}
