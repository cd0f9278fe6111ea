//! Writes new files and computes their checksums on the fly.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::disk;
use crate::files;
use crate::provenance::{Checksum, Hasher};
use crate::stop;

/// Bytes per write, rounded up to a multiple. Linux serves blocks of this size from lists of
/// recently freed pages; larger blocks take 30 % less system time natively, but up to ten times as
/// much in a virtual machine, whose host must find the memory.
const BUFFER: usize = 1 << 15;

/// Bytes per read.
const READ_BUFFER: usize = 1 << 18;

/// A buffered writer to a new file. Writes fail once a signal has asked the program to end.
#[derive(Debug)]
pub struct FileWriter {
    file: HashedFile,
    buffer: Vec<u8>,
}

impl FileWriter {
    /// Creates the file; fails if it exists.
    pub(super) fn create(path: PathBuf) -> io::Result<Self> {
        Ok(Self {
            file: HashedFile::create(path)?,
            buffer: Vec::with_capacity(BUFFER),
        })
    }

    /// Asks the file system to reserve this many bytes, which makes writing faster; does nothing
    /// where that is not supported.
    pub fn reserve(&self, n_bytes: u64) {
        disk::reserve(&self.file.file, n_bytes);
    }

    /// Writes the rest; returns the length of the file and its checksum.
    pub(super) fn finish(mut self) -> io::Result<(u64, Checksum)> {
        self.write_buffer()?;
        let n_bytes = self.file.end;
        Ok((n_bytes, self.file.checksum()?))
    }

    fn write_buffer(&mut self) -> io::Result<()> {
        self.file.write_all(&self.buffer)?;
        self.buffer.clear();
        Ok(())
    }
}

impl Write for FileWriter {
    #[inline]
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let to_multiple = BUFFER - self.file.position as usize % BUFFER;
        let free = to_multiple - self.buffer.len();
        let n = bytes.len().min(free);
        self.buffer.extend_from_slice(&bytes[..n]);
        if n == free {
            self.write_buffer()?;
        }
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.write_buffer()
    }
}

impl Seek for FileWriter {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.write_buffer()?;
        self.file.position = self.file.file.seek(to)?;
        Ok(self.file.position)
    }

    fn stream_position(&mut self) -> io::Result<u64> {
        Ok(self.file.position + self.buffer.len() as u64)
    }
}

/// A file that computes its checksum while it is written.
#[derive(Debug)]
struct HashedFile {
    path: PathBuf,
    file: File,
    hasher: Hasher,
    /// Position of the next byte.
    position: u64,
    /// Length of the file in bytes.
    end: u64,
    /// True if bytes were overwritten, which makes the checksum wrong.
    was_rewritten: bool,
}

impl HashedFile {
    fn create(path: PathBuf) -> io::Result<Self> {
        Ok(Self {
            file: disk::create_file(&path)?,
            path,
            hasher: Hasher::default(),
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
