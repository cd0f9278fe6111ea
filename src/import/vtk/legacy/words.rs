//! The words of a legacy file.

use crate::fault::cut;
use crate::{FileFault, Result};

/// The words of a file; in binary files, with bytes between them.
pub(super) struct Words<'a> {
    /// The rest of the file, from which line feeds have not been counted.
    uncounted: &'a [u8],
    n_line_feeds: u64,
    pub(super) rest: &'a [u8],
    pub(super) is_binary: bool,
}

impl<'a> Words<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self {
            uncounted: bytes,
            n_line_feeds: 0,
            rest: bytes,
            is_binary: false,
        }
    }

    /// Returns the rest of the line.
    pub(super) fn line(&mut self) -> &'a [u8] {
        let end = memchr::memchr(b'\n', self.rest);
        let (line, rest) = self
            .rest
            .split_at(end.map_or(self.rest.len(), |end| end + 1));
        self.rest = rest;
        line
    }

    /// Returns the line number of the next word; in a binary file, the number of line feeds.
    pub(super) fn line_number(&mut self) -> u64 {
        let before = &self.uncounted[..self.uncounted.len() - self.rest.len()];
        self.n_line_feeds += memchr::memchr_iter(b'\n', before).count() as u64;
        self.uncounted = self.rest;
        self.n_line_feeds + 1
    }

    /// Returns the next word, or `None` at the end.
    pub(super) fn next_or_end(&mut self) -> Option<&'a str> {
        let rest = self.rest.trim_ascii_start();
        let end = rest.iter().position(u8::is_ascii_whitespace);
        let (word, rest) = rest.split_at(end.unwrap_or(rest.len()));
        self.rest = rest;
        // Other bytes are not a word of a VTK file.
        (!word.is_empty()).then(|| str::from_utf8(word).unwrap_or("\u{fffd}"))
    }

    pub(super) fn next(&mut self) -> Result<&'a str> {
        let ends = || FileFault::new("it ends early", "a whole file");
        self.next_or_end().ok_or_else(ends)
    }

    /// Skips the next word if it is this one; returns true if it was.
    pub(super) fn skip_word(&mut self, word: &str) -> bool {
        let before = self.rest;
        let is_it = self
            .next_or_end()
            .is_some_and(|next| next.eq_ignore_ascii_case(word));
        if !is_it {
            self.rest = before;
        }
        is_it
    }

    pub(super) fn expect(&mut self, word: &str) -> Result<()> {
        if self.skip_word(word) {
            return Ok(());
        }
        let found = self.next()?;
        Err(self.unexpected(found, &format!("`{word}`")))
    }

    pub(super) fn number<T: std::str::FromStr>(&mut self) -> Result<T> {
        let word = self.next()?;
        word.parse().map_err(|_| self.unexpected(word, "a number"))
    }

    pub(super) fn numbers<T: std::str::FromStr + Copy + Default, const N: usize>(
        &mut self,
    ) -> Result<[T; N]> {
        let mut numbers = [T::default(); N];
        for number in &mut numbers {
            *number = self.number()?;
        }
        Ok(numbers)
    }

    /// Returns the number before a word, or `default` if the word comes first. Skips the word.
    pub(super) fn number_or(&mut self, word: &str, default: usize) -> Result<usize> {
        if self.skip_word(word) {
            return Ok(default);
        }
        let number = self.number()?;
        self.expect(word).map(|()| number)
    }

    /// Returns the `n` bytes after the line feed.
    pub(super) fn bytes(&mut self, n: usize) -> Result<&'a [u8]> {
        self.line();
        let ends = || FileFault::new("it ends early", "a whole file");
        let (bytes, rest) = self.rest.split_at_checked(n).ok_or_else(ends)?;
        self.rest = rest;
        Ok(bytes)
    }

    /// Skips the lines up to a blank one.
    pub(super) fn skip_metadata(&mut self) {
        self.line();
        while !self.rest.is_empty() && !self.line().trim_ascii().is_empty() {}
    }

    /// Skips `n` strings if strings come next; returns true if they did.
    pub(super) fn skip_strings(&mut self, n: usize) -> Result<bool> {
        if !self.skip_word("string") {
            return Ok(false);
        }
        self.line();
        for _ in 0..n {
            if self.is_binary {
                // The two highest bits of the length give its number of bytes.
                let ends = || FileFault::new("it ends early", "a whole file");
                let first = *self.rest.first().ok_or_else(ends)?;
                let n_length = 1 << (3 - (first >> 6));
                let (length, rest) = self.rest.split_at_checked(n_length).ok_or_else(ends)?;
                let mask = u64::MAX >> (66 - 8 * n_length);
                let length = length
                    .iter()
                    .fold(0, |sum, byte| sum << 8 | u64::from(*byte))
                    & mask;
                self.rest = rest;
                let length = usize::try_from(length).map_err(|_| ends())?;
                self.rest = self.rest.get(length..).ok_or_else(ends)?;
            } else if self.rest.is_empty() {
                return Err(FileFault::new("it ends early", "a whole file"));
            } else {
                self.line();
            }
        }
        Ok(true)
    }

    pub(super) fn unexpected(&self, word: &str, expected: &str) -> FileFault {
        FileFault::new(format!("`{}` does not belong here", cut(word)), expected)
    }
}
