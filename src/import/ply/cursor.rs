//! A file on its way to serde-ply, with the place that was reached.

use std::cell::Cell;
use std::io::{self, BufRead, Read};

use crate::import::Input;

/// Where a [`Cursor`] stands.
#[derive(Debug, Default)]
pub(super) struct Position {
    /// Line ends before the last byte that was read.
    n_lines: Cell<u64>,
    /// Whether that byte was one more.
    at_line_end: Cell<bool>,
    ends_with_a_line: Cell<bool>,
}

/// A file that tells its [`Position`].
#[derive(Debug)]
pub(super) struct Cursor<'a> {
    file: Input,
    position: &'a Position,
}

impl Position {
    /// The line of the last byte that was read, 1 is the first.
    pub(super) fn line(&self) -> u64 {
        self.n_lines.get() + 1
    }

    /// Whether to put a line end behind the file's last byte.
    pub(super) fn end_with_a_line(&self, yes: bool) {
        self.ends_with_a_line.set(yes);
    }

    fn advance(&self, bytes: &[u8]) {
        for byte in bytes {
            let n_ended = u64::from(self.at_line_end.replace(*byte == b'\n'));
            self.n_lines.update(|n| n + n_ended);
        }
    }
}

impl<'a> Cursor<'a> {
    pub(super) fn new(file: Input, position: &'a Position) -> Self {
        Self { file, position }
    }

    /// Whether nothing but blanks and line ends follows.
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
        match bytes.is_empty() && self.position.ends_with_a_line.take() {
            true => Ok(b"\n"),
            false => Ok(bytes),
        }
    }

    fn consume(&mut self, n: usize) {
        // Nothing is left behind the file's end but the line end of ours.
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
