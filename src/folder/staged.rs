//! A new file in a workspace.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::{Written, disk};
use crate::provenance::{Checksum, Hasher};
use crate::stop;
use crate::text::numbers::milliseconds;

/// Size of the write buffer in bytes: many rows, but within the cache.
const BUFFER: usize = 1 << 16;

/// A complete file in a workspace.
#[derive(Debug)]
pub(crate) struct StagedFile {
    name: &'static str,
    n_bytes: u64,
    checksum: Checksum,
    write_ms: f64,
}

impl StagedFile {
    /// Writes a file to a folder in which no file has this name.
    pub(super) fn write(
        folder: &Path,
        name: &'static str,
        write: impl FnOnce(&mut FileWriter) -> io::Result<()>,
    ) -> io::Result<Self> {
        let start = Instant::now();
        let file = HashedFile::create(folder.join(name))?;
        let mut out = BufWriter::with_capacity(BUFFER, file);
        write(&mut out)?;
        let file = out.into_inner().map_err(io::IntoInnerError::into_error)?;
        let n_bytes = file.end;
        Ok(Self {
            name,
            n_bytes,
            checksum: file.checksum()?,
            write_ms: milliseconds(start.elapsed()),
        })
    }

    /// Its name in the folder.
    pub(super) fn name(&self) -> &'static str {
        self.name
    }

    /// Name, length, checksum and time of writing.
    pub(crate) fn written(&self) -> Written {
        Written {
            file: self.name,
            bytes: self.n_bytes,
            checksum: self.checksum,
            write_ms: self.write_ms,
        }
    }
}

/// A new file that is being written.
pub(crate) type FileWriter = BufWriter<HashedFile>;

/// A file that computes its checksum while it is written. Writes fail after a signal
/// has requested the program to end.
#[derive(Debug)]
pub(crate) struct HashedFile {
    path: PathBuf,
    file: File,
    hasher: Hasher,
    /// Position of the next byte.
    position: u64,
    /// Length of the file in bytes.
    end: u64,
    /// Whether bytes were overwritten, which makes the checksum wrong.
    was_rewritten: bool,
}

impl HashedFile {
    pub(super) fn create(path: PathBuf) -> io::Result<Self> {
        Ok(Self {
            file: disk::create_file(&path)?,
            path,
            hasher: Hasher::new(),
            position: 0,
            end: 0,
            was_rewritten: false,
        })
    }

    fn checksum(self) -> io::Result<Checksum> {
        if self.was_rewritten {
            checksum_of(&self.path)
        } else {
            Ok(self.hasher.checksum())
        }
    }
}

impl Write for HashedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        stop::check().map_err(io::Error::other)?;
        let n = disk::write(&self.file, bytes)?;
        if self.position == self.end {
            self.hasher.add(&bytes[..n]);
        } else {
            self.was_rewritten = true;
        }
        self.position += n as u64;
        self.end = self.end.max(self.position);
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for HashedFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.position = self.file.seek(to)?;
        Ok(self.position)
    }
}

/// Computes the checksum of a file.
///
/// # Errors
/// An error of the system.
pub(crate) fn checksum_of(path: &Path) -> io::Result<Checksum> {
    let mut file = File::open(path)?;
    let mut hasher = Hasher::new();
    let mut buffer = vec![0; 4 * BUFFER];
    loop {
        stop::check().map_err(io::Error::other)?;
        match file.read(&mut buffer)? {
            0 => return Ok(hasher.checksum()),
            n => hasher.add(&buffer[..n]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checksum_is_that_of_the_file_however_it_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let straight = |out: &mut FileWriter| out.write_all(b"0123456789");
        let again = |out: &mut FileWriter| {
            out.write_all(b"xxxx")?;
            out.seek(SeekFrom::Start(0))?;
            out.write_all(b"0123")?;
            out.seek(SeekFrom::End(0))?;
            out.write_all(b"456789")
        };
        let straight = StagedFile::write(folder.path(), "straight", straight).unwrap();
        let again = StagedFile::write(folder.path(), "again", again).unwrap();
        for file in [&straight, &again] {
            assert_eq!(file.n_bytes, 10);
            let path = folder.path().join(file.name);
            assert_eq!(checksum_of(&path).unwrap(), file.checksum);
        }
        assert_eq!(straight.checksum, again.checksum);
    }
}
