//! Opening of regular files only: a FIFO would make whoever opens it wait for its writer, and
//! a device may have no end.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use crate::text::numbers;

/// Opens a regular file for reading.
///
/// # Errors
/// The errors of the system, and that it is not a regular file.
pub fn open(path: &Path) -> io::Result<File> {
    open_with(OpenOptions::new().read(true), path)
}

/// Opens a regular file as the options say, which may create it.
///
/// # Errors
/// The errors of [`open`].
pub fn open_with(options: &mut OpenOptions, path: &Path) -> io::Result<File> {
    // Before it is opened: that alone has effects on some devices.
    if let Ok(found) = path.metadata() {
        check(&found)?;
    }
    // What takes its place meanwhile is opened without waiting.
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits() as i32);
    }
    let file = options.open(path)?;
    check(&file.metadata()?)?;
    Ok(file)
}

/// All bytes of a regular file.
///
/// # Errors
/// The errors of [`open`], and that it is longer than `max_bytes`.
pub fn read(path: &Path, max_bytes: u64) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    let n_bytes = file.metadata()?.len();
    let mut bytes = Vec::new();
    if n_bytes <= max_bytes {
        // It may grow while it is read.
        file.take(max_bytes.saturating_add(1))
            .read_to_end(&mut bytes)?;
    }
    if n_bytes.max(bytes.len() as u64) > max_bytes {
        let message = format!("it is longer than {}", numbers::bytes(max_bytes));
        return Err(io::Error::new(ErrorKind::InvalidData, message));
    }
    Ok(bytes)
}

/// The text of a regular file.
///
/// # Errors
/// The errors of [`read`], and that it is not UTF-8.
pub fn read_text(path: &Path, max_bytes: u64) -> io::Result<String> {
    String::from_utf8(read(path, max_bytes)?)
        .map_err(|_| io::Error::new(ErrorKind::InvalidData, "it is not UTF-8 text"))
}

fn check(found: &Metadata) -> io::Result<()> {
    if found.is_file() {
        return Ok(());
    }
    #[cfg(unix)]
    if found.is_dir() {
        return Err(rustix::io::Errno::ISDIR.into());
    }
    Err(io::Error::new(
        ErrorKind::InvalidInput,
        "it is not a regular file",
    ))
}
