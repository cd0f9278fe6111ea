//! Writes new files and computes their checksums on the fly.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::disk::{self, change};
use crate::files;
use crate::provenance::{Checksum, Hasher};
use base::stop;

/// Bytes per write, rounded up to a multiple. Linux serves blocks of this size from lists of
/// recently freed pages; larger blocks take 30 % less system time natively, but up to ten times as
/// much in a virtual machine, whose host must find the memory.
const BUFFER: usize = 1 << 15;

/// Bytes per read.
const READ_BUFFER: usize = 1 << 18;

/// A buffered writer to a new file, which computes its checksum. Writes fail once a signal has asked
/// the program to end.
#[derive(Debug)]
pub struct FileWriter {
    path: PathBuf,
    file: File,
    buffer: Vec<u8>,
    hasher: Hasher,
    /// Position of the first byte in the buffer.
    position: u64,
    /// Length of the file in bytes, without the buffer.
    end: u64,
    /// True if bytes were overwritten, which makes the checksum wrong.
    was_rewritten: bool,
}

impl FileWriter {
    /// Creates the file; fails if it exists.
    pub(super) fn create(path: PathBuf) -> io::Result<Self> {
        Ok(Self {
            file: change(|| File::create_new(&path))?,
            path,
            buffer: Vec::with_capacity(BUFFER),
            hasher: Hasher::default(),
            position: 0,
            end: 0,
            was_rewritten: false,
        })
    }

    /// Asks the file system to reserve this many bytes, which makes writing faster; does nothing
    /// where that is not supported.
    pub fn reserve(&self, n_bytes: u64) {
        disk::reserve(&self.file, n_bytes);
    }

    /// Writes the rest; returns the length of the file and its checksum.
    pub(super) fn finish(mut self) -> io::Result<(u64, Checksum)> {
        self.flush()?;
        let checksum = if self.was_rewritten {
            checksum_of(&self.path)?
        } else {
            self.hasher.checksum()
        };
        Ok((self.end, checksum))
    }
}

impl Write for FileWriter {
    #[inline]
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let to_multiple = BUFFER - self.position as usize % BUFFER;
        let free = to_multiple - self.buffer.len();
        let n = bytes.len().min(free);
        self.buffer.extend_from_slice(&bytes[..n]);
        if n == free {
            self.flush()?;
        }
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.buffer.is_empty() {
            return Ok(());
        }
        stop::check().map_err(io::Error::other)?;
        change(|| self.file.write_all(&self.buffer))?;
        if self.position == self.end {
            self.hasher.add(&self.buffer);
        } else {
            self.was_rewritten = true;
        }
        self.position += self.buffer.len() as u64;
        self.end = self.end.max(self.position);
        self.buffer.clear();
        Ok(())
    }
}

impl Seek for FileWriter {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.flush()?;
        self.position = self.file.seek(to)?;
        Ok(self.position)
    }

    fn stream_position(&mut self) -> io::Result<u64> {
        Ok(self.position + self.buffer.len() as u64)
    }
}

/// Computes the checksum of a file.
///
/// # Errors
/// An I/O error.
pub fn checksum_of(path: &Path) -> io::Result<Checksum> {
    let mut file = files::open(path)?;
    let mut hasher = Hasher::default();
    let mut buffer = vec![0; READ_BUFFER];
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

    /// Writes a file; returns its length and its checksum.
    fn written(path: PathBuf, write: impl FnOnce(&mut FileWriter)) -> (u64, Checksum) {
        let mut out = FileWriter::create(path).unwrap();
        write(&mut out);
        out.finish().unwrap()
    }

    #[test]
    fn a_checksum_is_that_of_the_file_however_it_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let paths = ["straight", "again"].map(|name| folder.path().join(name));
        let straight = written(paths[0].clone(), |out| {
            out.write_all(b"0123456789").unwrap()
        });
        let again = written(paths[1].clone(), |out| {
            out.write_all(b"xxxx").unwrap();
            out.seek(SeekFrom::Start(0)).unwrap();
            out.write_all(b"0123").unwrap();
            out.seek(SeekFrom::End(0)).unwrap();
            out.write_all(b"456789").unwrap();
        });
        for (path, file) in paths.iter().zip([straight, again]) {
            assert_eq!(file, (10, checksum_of(path).unwrap()));
        }
        assert_eq!(straight, again);
    }

    #[test]
    fn parts_of_any_length_are_written_in_their_order() {
        let folder = tempfile::tempdir().unwrap();
        let bytes: Vec<u8> = (0..3 * BUFFER as u32 + 7)
            .map(|i| (i % 251) as u8)
            .collect();
        for part in [1000, BUFFER - 1, BUFFER, 2 * BUFFER + 1] {
            let path = folder.path().join(part.to_string());
            let (n, checksum) = written(path.clone(), |out| {
                out.reserve(2 * BUFFER as u64);
                for (i, bytes) in bytes.chunks(part).enumerate() {
                    assert_eq!(out.stream_position().unwrap(), (i * part) as u64);
                    out.write_all(bytes).unwrap();
                }
            });
            assert_eq!(n, bytes.len() as u64);
            assert_eq!(std::fs::read(&path).unwrap(), bytes);
            assert_eq!(checksum_of(&path).unwrap(), checksum);
        }
    }
}
