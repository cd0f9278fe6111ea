//! Measures the length of output.

use std::io::{self, Seek, SeekFrom, Write};

/// A writer that counts bytes and discards them.
#[derive(Debug, Default)]
pub(super) struct Length {
    position: u64,
    length: u64,
}

impl Length {
    /// Returns the length that a function writes; 0 if it fails.
    pub(super) fn measure(write: impl FnOnce(&mut Self) -> io::Result<()>) -> u64 {
        let mut out = Self::default();
        match write(&mut out) {
            Ok(()) => out.length,
            Err(_) => 0,
        }
    }
}

impl Write for Length {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.position += bytes.len() as u64;
        self.length = self.length.max(self.position);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Length {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let from = |base: u64, offset: i64| base.checked_add_signed(offset);
        let position = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::End(offset) => from(self.length, offset),
            SeekFrom::Current(offset) => from(self.position, offset),
        };
        self.position = position.ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.position)
    }
}
