//! Lines of text with their numbers.

use std::borrow::Cow;
use std::io::{BufRead, Cursor, Read};
use std::mem::take;

use memchr::memchr2;

use super::{GeometryFileReader, Result};

/// The byte-order mark that some editors write before UTF-8 text.
pub(super) const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// Reads a text line by line into one buffer.
#[derive(Debug)]
pub(super) struct Lines<R> {
    text: R,
    line: Vec<u8>,
    number: u64,
    /// True if the last line ended with a carriage return: a line feed after it belongs to the same
    /// line end.
    after_return: bool,
}

impl Lines<Box<dyn BufRead>> {
    /// Starts before the first line of a file in UTF-8, or in UTF-16 with a byte-order mark,
    /// as some editors of Windows write it.
    pub(super) fn of_file(mut file: GeometryFileReader) -> Result<Self> {
        let start = file.fill_buf()?;
        let unit_of: fn([u8; 2]) -> u16 = match start.first_chunk() {
            Some(b"\xff\xfe") => u16::from_le_bytes,
            Some(b"\xfe\xff") => u16::from_be_bytes,
            _ => return Ok(Self::new(Box::new(file))),
        };
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        let units = bytes.as_chunks().0.iter().map(|unit| unit_of(*unit));
        let letters = char::decode_utf16(units);
        let text: String = letters.map(|letter| letter.unwrap_or('\u{fffd}')).collect();
        Ok(Self::new(Box::new(Cursor::new(text))))
    }
}

impl<R: BufRead> Lines<R> {
    /// Starts before the first line of `text`.
    pub(super) fn new(text: R) -> Self {
        Self {
            text,
            line: Vec::new(),
            number: 0,
            after_return: false,
        }
    }

    /// Returns the next line and its number, without its end, joined with the following line
    /// after a backslash; `None` at the end of the text. A line ends with a line
    /// feed, a carriage return or both. Bytes that are not UTF-8, such as in an
    /// old comment, become U+FFFD.
    pub(super) fn next(&mut self) -> Result<Option<(u64, Cow<'_, str>)>> {
        self.line.clear();
        while self.append_line()? {
            self.number += 1;
            if self.number == 1 && self.line.starts_with(BYTE_ORDER_MARK) {
                self.line.drain(..BYTE_ORDER_MARK.len());
            }
            let n = self.line.trim_ascii_end().len();
            self.line.truncate(n);
            match self.line.pop_if(|byte| *byte == b'\\') {
                Some(_) => self.line.push(b' '),
                None => return Ok(Some((self.number, String::from_utf8_lossy(&self.line)))),
            }
        }
        let joined_to_the_end = !self.line.is_empty();
        Ok(joined_to_the_end.then(|| (self.number, String::from_utf8_lossy(&self.line))))
    }

    /// Reads up to the end of a line, which is omitted; returns false if there is no further line.
    fn append_line(&mut self) -> Result<bool> {
        let mut has_begun = false;
        loop {
            let mut bytes = self.text.fill_buf()?;
            if bytes.is_empty() {
                return Ok(has_begun);
            }
            let n_skipped = usize::from(take(&mut self.after_return) && bytes[0] == b'\n');
            bytes = &bytes[n_skipped..];
            let end = memchr2(b'\n', b'\r', bytes);
            self.line
                .extend_from_slice(&bytes[..end.unwrap_or(bytes.len())]);
            has_begun |= !bytes.is_empty();
            let n_read = match end {
                Some(end) => {
                    self.after_return = bytes[end] == b'\r';
                    end + 1
                }
                None => bytes.len(),
            };
            self.text.consume(n_skipped + n_read);
            if end.is_some() {
                return Ok(true);
            }
        }
    }

    /// Returns the number of the last line that was read, counted from 1.
    pub(super) fn number(&self) -> u64 {
        self.number
    }
}

#[cfg(test)]
mod tests {
    use std::io::BufReader;

    use super::*;

    fn lines(text: &[u8], capacity: usize) -> Vec<(u64, String)> {
        let mut lines = Lines::new(BufReader::with_capacity(capacity, text));
        let mut found = Vec::new();
        while let Some((number, line)) = lines.next().unwrap() {
            found.push((number, line.into_owned()));
        }
        found
    }

    #[test]
    fn lines_end_as_on_any_system() {
        let expected = [(1, "a"), (2, ""), (3, "b c"), (5, "d  e"), (6, "f")];
        let expected = expected.map(|(number, line)| (number, line.to_owned()));
        for end in ["\n", "\r\n", "\r"] {
            let text = ["a", "", "b c ", "d \\", "e", "f"].join(end);
            for mark in ["", "\u{feff}"] {
                let text = format!("{mark}{text}");
                // Buffers of various sizes.
                for capacity in [1, 2, 3, 100] {
                    assert_eq!(lines(text.as_bytes(), capacity), expected, "{text:?}");
                }
            }
        }
    }

    #[test]
    fn the_end_of_a_text_is_no_line() {
        for text in ["a\n", "a\r", "a\r\n", "a"] {
            assert_eq!(lines(text.as_bytes(), 1).len(), 1, "{text:?}");
        }
        assert_eq!(lines(b"", 1), []);
        assert_eq!(lines(b"a\\", 1), [(1, "a ".to_owned())]);
    }
}
