//! The file that serde-ply reads, with its current position.

use std::cell::Cell;
use std::io::{self, BufRead, Chain, Read};

use crate::GeometryFileReader;
use crate::lines::BYTE_ORDER_MARK;

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
    file: Chain<io::Cursor<Vec<u8>>, GeometryFileReader>,
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
    /// Starts before the first line, whatever byte-order mark is before it.
    ///
    /// # Errors
    /// The file cannot be read.
    pub(super) fn new(mut file: GeometryFileReader, position: &'a Position) -> io::Result<Self> {
        if file.fill_buf()?.starts_with(BYTE_ORDER_MARK) {
            file.consume(BYTE_ORDER_MARK.len());
        }
        let start = read_lines_of_returns(&mut file)?;
        let file = io::Cursor::new(start).chain(file);
        Ok(Self { file, position })
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
        // Past the end of the file, only the appended newline is left. The buffer is full: this
        // reads nothing.
        let bytes = self.file.fill_buf().unwrap_or_default();
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

/// Reads the lines of a file that end with carriage returns alone, as old Macs write them, with line
/// feeds instead: all lines of a text, the header's of a binary file, and none of other files.
fn read_lines_of_returns(file: &mut GeometryFileReader) -> io::Result<Vec<u8>> {
    let mut lines = Vec::new();
    let mut ends = file.fill_buf()?.windows(2);
    let first = ends.find(|pair| matches!(pair[0], b'\n' | b'\r'));
    if first.is_none_or(|pair| pair[0] == b'\n' || pair[1] == b'\n') {
        return Ok(lines);
    }
    while !lines.ends_with(b"\rend_header\r") && file.read_until(b'\r', &mut lines)? > 0 {}
    if lines.windows(12).any(|words| words == b"format ascii") {
        file.read_to_end(&mut lines)?;
    }
    let returns = lines.iter_mut().filter(|byte| **byte == b'\r');
    returns.for_each(|byte| *byte = b'\n');
    Ok(lines)
}
