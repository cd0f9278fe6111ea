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
    /// Writes a new file to a folder that has no file of this name.
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

    /// Writes a new file, with a function that creates it, to a folder that has no file of this
    /// name.
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

    /// Returns the name in the folder.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Returns name, length, checksum and writing time.
    pub fn written(&self) -> Written {
        Written {
            file: self.name.clone(),
            bytes: self.n_bytes,
            checksum: self.checksum,
            write_ms: self.write_ms,
        }
    }
}
