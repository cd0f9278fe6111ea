//! Reads files: path → bytes. Every file of a scene and of an output folder is opened here, and only
//! regular files are: opening a FIFO would wait for its writer, and a device may be endless.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use base::numbers;

/// The first bytes of the text that Git LFS keeps in the place of a file.
pub const GIT_LFS: &[u8] = b"version https://git-lfs.github.com/spec/";

/// Opens a regular file for reading.
///
/// # Errors
/// An I/O error, or not a regular file.
pub fn open(path: &Path) -> io::Result<File> {
    open_with(OpenOptions::new().read(true), path, path.metadata())
}

/// Opens a regular file with these options, which may create and change it. Does not follow a
/// symbolic link in its place.
///
/// # Errors
/// As [`open`], or a symbolic link.
pub fn open_to_change(options: &mut OpenOptions, path: &Path) -> io::Result<File> {
    open_with(options, path, path.symlink_metadata())
}

fn open_with(
    options: &mut OpenOptions,
    path: &Path,
    found: io::Result<Metadata>,
) -> io::Result<File> {
    // Check first: merely opening some devices has side effects.
    if let Ok(found) = found {
        check(&found)?;
    }
    // Do not block if something else has replaced the file meanwhile.
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits() as i32);
    }
    let file = options.open(path)?;
    check(&file.metadata()?)?;
    Ok(file)
}

/// Reads a regular file.
///
/// # Errors
/// As [`open`], or the file is longer than `max_bytes`.
pub fn read(path: &Path, max_bytes: u64) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    let n_bytes = file.metadata()?.len();
    let mut bytes = Vec::new();
    if n_bytes <= max_bytes {
        // The file may grow while it is read.
        file.take(max_bytes.saturating_add(1))
            .read_to_end(&mut bytes)?;
    }
    if n_bytes.max(bytes.len() as u64) > max_bytes {
        let message = format!("it is longer than {}", numbers::bytes(max_bytes));
        return Err(io::Error::new(ErrorKind::InvalidData, message));
    }
    Ok(bytes)
}

/// Reads a regular file as text.
///
/// # Errors
/// As [`read`], or the file is not UTF-8.
pub fn read_text(path: &Path, max_bytes: u64) -> io::Result<String> {
    String::from_utf8(read(path, max_bytes)?)
        .map_err(|_| io::Error::new(ErrorKind::InvalidData, "it is not UTF-8 text"))
}

/// Reads a file from a position on. Other readers of the file have positions of their own, so that
/// threads can share it.
pub struct PositionedReader<'a> {
    /// The file.
    pub file: &'a File,
    /// Byte offset of the next byte to read.
    pub position: u64,
}

impl Read for PositionedReader<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        #[cfg(unix)]
        let n_bytes = std::os::unix::fs::FileExt::read_at(self.file, into, self.position)?;
        #[cfg(windows)]
        let n_bytes = std::os::windows::fs::FileExt::seek_read(self.file, into, self.position)?;
        self.position += n_bytes as u64;
        Ok(n_bytes)
    }
}

fn check(found: &Metadata) -> io::Result<()> {
    if found.is_file() {
        return Ok(());
    }
    #[cfg(unix)]
    if found.is_dir() {
        return Err(rustix::io::Errno::ISDIR.into());
    }
    let what = if found.is_symlink() {
        "it is a symbolic link"
    } else {
        "it is not a regular file"
    };
    Err(io::Error::new(ErrorKind::InvalidInput, what))
}
