//! The file that serde-ply reads, with its current position.

use std::cell::Cell;
use std::io::{self, BufRead, Read};

use crate::import::GeometryFileReader;

/// The position of a [`Cursor`].
#[derive(Debug, Default)]
pub(super) struct Position {
    /// Number of newlines before the last byte that was read.
    n_lines: Cell<u64>,
    /// True if the last byte was a newline.
    at_line_end: Cell<bool>,
    ends_with_newline: Cell<bool>,
}

/// A file that updates its [`Position`].
#[derive(Debug)]
pub(super) struct Cursor<'a> {
    file: GeometryFileReader,
    position: &'a Position,
}

impl Position {
    /// Returns the line of the last byte that was read, counted from 1.
    pub(super) fn line(&self) -> u64 {
        self.n_lines.get() + 1
    }

    /// Sets whether to append a newline to the file's last byte.
    pub(super) fn end_with_newline(&self, yes: bool) {
        self.ends_with_newline.set(yes);
    }

    fn advance(&self, bytes: &[u8]) {
        for byte in bytes {
            let n_ended = u64::from(self.at_line_end.replace(*byte == b'\n'));
            self.n_lines.update(|n| n + n_ended);
        }
    }
}

impl<'a> Cursor<'a> {
    pub(super) fn new(file: GeometryFileReader, position: &'a Position) -> Self {
        Self { file, position }
    }

    /// Returns true if only whitespace follows.
    pub(super) fn is_at_end(&mut self) -> io::Result<bool> {
        loop {
            let bytes = self.file.fill_buf()?;
            let n = bytes.len();
            if n == 0 || !bytes.trim_ascii().is_empty() {
                return Ok(n == 0);
            }
            self.file.consume(n);
        }
    }
}

impl BufRead for Cursor<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        let bytes = self.file.fill_buf()?;
        if bytes.is_empty() && self.position.ends_with_newline.take() {
            Ok(b"\n")
        } else {
            Ok(bytes)
        }
    }

    fn consume(&mut self, n: usize) {
        // Past the end of the file, only the appended newline is left.
        let bytes = self.file.buffer();
        self.position.advance(&bytes[..n.min(bytes.len())]);
        self.file.consume(n);
    }
}

impl Read for Cursor<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let n = self.fill_buf()?.read(out)?;
        self.consume(n);
        Ok(n)
    }
}
