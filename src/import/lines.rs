//! Lines of a text, with their numbers.

use std::borrow::Cow;
use std::io::BufRead;

use super::Result;

/// Reads a text line by line into one buffer.
#[derive(Debug)]
pub(super) struct Lines<R> {
    text: R,
    line: Vec<u8>,
    number: u64,
}

impl<R: BufRead> Lines<R> {
    /// Before the first line of `text`.
    pub(super) fn new(text: R) -> Self {
        Self {
            text,
            line: Vec::new(),
            number: 0,
        }
    }

    /// The next line without its end, together with those that backslashes at
    /// the end of a line join to it; `None` at the end of the text. Bytes that
    /// are no UTF-8 (in an old comment, say) become U+FFFD.
    pub(super) fn next(&mut self) -> Result<Option<Cow<'_, str>>> {
        self.line.clear();
        while self.text.read_until(b'\n', &mut self.line)? > 0 {
            self.number += 1;
            let n = self.line.trim_ascii_end().len();
            self.line.truncate(n);
            match self.line.pop_if(|byte| *byte == b'\\') {
                Some(_) => self.line.push(b' '),
                None => return Ok(Some(String::from_utf8_lossy(&self.line))),
            }
        }
        let joined_to_the_end = !self.line.is_empty();
        Ok(joined_to_the_end.then(|| String::from_utf8_lossy(&self.line)))
    }

    /// The number of the last line that was read, 1 is the first.
    pub(super) fn number(&self) -> u64 {
        self.number
    }
}
