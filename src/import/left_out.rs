//! Counts of what a reader leaves out of a file.

use std::fmt::{Display, Write};

/// The parts of a file that a reader leaves out, by kind.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LeftOut(Vec<PartsLeftOut>);

/// The parts of one kind.
#[derive(Debug, Clone, PartialEq)]
struct PartsLeftOut {
    kind: &'static str,
    n: u64,
    /// The place of the first one.
    first: String,
}

impl LeftOut {
    /// Counts a part of a kind at a place such as `line 7`.
    pub(super) fn add(&mut self, kind: &'static str, place: impl Display) {
        match self.0.iter_mut().find(|parts| parts.kind == kind) {
            Some(parts) => parts.n += 1,
            None => self.0.push(PartsLeftOut {
                kind,
                n: 1,
                first: place.to_string(),
            }),
        }
    }

    /// Returns a sentence with the number of each kind and the first place; `None` if nothing was
    /// left out.
    pub(super) fn note(&self) -> Option<String> {
        let mut note = "left out: ".to_owned();
        for (i, PartsLeftOut { kind, n, first }) in self.0.iter().enumerate() {
            let comma = if i == 0 { "" } else { ", " };
            let from = if *n == 1 { "" } else { "from " };
            // Writing to a string does not fail.
            let _ = write!(note, "{comma}{kind} ({n}, {from}{first})");
        }
        (!self.0.is_empty()).then_some(note)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_counted_from_their_first_place() {
        let mut left_out = LeftOut::default();
        assert_eq!(left_out.note(), None);
        for (kind, line) in [("curves", 3), ("faces", 5), ("curves", 7)] {
            left_out.add(kind, format_args!("line {line}"));
        }
        let expected = "left out: curves (2, from line 3), faces (1, line 5)";
        assert_eq!(left_out.note().as_deref(), Some(expected));
    }
}
