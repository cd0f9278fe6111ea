//! A file that is whole before it has its place.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::{Written, disk};
use crate::provenance::{Checksum, Summer};
use crate::stop;
use crate::text::numbers::milliseconds;

/// Bytes that go to the system at one go: many rows, and yet within the cache.
const BUFFER: usize = 1 << 16;

/// A whole file that waits for its place in the folder.
#[derive(Debug)]
pub(crate) struct StagedFile {
    name: &'static str,
    n_bytes: u64,
    checksum: Checksum,
    write_ms: f64,
}

impl StagedFile {
    /// Writes a file called `name` into a folder that has none of that name.
    pub(super) fn write(
        folder: &Path,
        name: &'static str,
        write: impl FnOnce(&mut FileWriter) -> io::Result<()>,
    ) -> io::Result<Self> {
        let start = Instant::now();
        let file = SummedFile::create(folder.join(name))?;
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

    /// What to say of it.
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
pub(crate) type FileWriter = BufWriter<SummedFile>;

/// A file that adds up its checksum while it is written. Writes fail once the
/// program is asked to end.
#[derive(Debug)]
pub(crate) struct SummedFile {
    path: PathBuf,
    file: File,
    summer: Summer,
    /// Where the next byte goes.
    position: u64,
    /// The bytes that the file has.
    end: u64,
    /// Whether bytes were written over: then the sum is none of the file.
    was_rewritten: bool,
}

impl SummedFile {
    pub(super) fn create(path: PathBuf) -> io::Result<Self> {
        Ok(Self {
            file: disk::create_file(&path)?,
            path,
            summer: Summer::new(),
            position: 0,
            end: 0,
            was_rewritten: false,
        })
    }

    fn checksum(self) -> io::Result<Checksum> {
        match self.was_rewritten {
            true => checksum_of(&self.path),
            false => Ok(self.summer.checksum()),
        }
    }
}

impl Write for SummedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        stop::check().map_err(io::Error::other)?;
        let n = disk::write(&self.file, bytes)?;
        match self.position == self.end {
            true => self.summer.add(&bytes[..n]),
            false => self.was_rewritten = true,
        }
        self.position += n as u64;
        self.end = self.end.max(self.position);
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for SummedFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.position = self.file.seek(to)?;
        Ok(self.position)
    }
}

/// The checksum of a file.
///
/// # Errors
/// What the system says.
pub(crate) fn checksum_of(path: &Path) -> io::Result<Checksum> {
    let mut file = File::open(path)?;
    let mut summer = Summer::new();
    let mut buffer = vec![0; 4 * BUFFER];
    loop {
        stop::check().map_err(io::Error::other)?;
        match file.read(&mut buffer)? {
            0 => return Ok(summer.checksum()),
            n => summer.add(&buffer[..n]),
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
