//! The size and the depth of a text after alias expansion.
//!
//! An alias of two characters expands to the whole value of its anchor: nine
//! lines can expand to more values than fit into memory (the "billion laughs"
//! attack). Whatever reads, copies or frees a value calls itself for the values within it: a few
//! kilobytes can nest more of them than fit onto a stack. This module counts values, bytes and
//! levels before anything is copied.

use std::collections::HashMap;

use saphyr_parser::Event;

/// Maximum number of values that all aliases of a text expand to together.
const MAX_VALUES: u64 = 1_000_000;
/// Maximum number of bytes of scalars in all aliases of a text together.
const MAX_BYTES: u64 = 16 << 20;

/// Maximum number of lists and mappings within each other, which is serde_yaml's, too.
pub(super) const MAX_LEVELS: usize = 128;

/// A limit that a text exceeds.
#[derive(Debug, PartialEq)]
pub(super) enum Excess {
    /// The aliases expand to too many values or bytes.
    Aliases,
    /// More than [`MAX_LEVELS`] lists and mappings are within each other.
    Levels,
}

/// Number of values, and of bytes in scalars.
#[derive(Debug, Clone, Copy, Default)]
struct Size {
    n_values: u64,
    n_bytes: u64,
}

/// A list or mapping that has not ended yet.
#[derive(Debug)]
struct OpenCollection {
    /// Its anchor; 0 for none.
    anchor: usize,
    /// The size of the text before it.
    before: Size,
    /// The number of levels within it so far.
    n_levels: usize,
}

/// The sizes of all anchors, and of the text expanded so far.
#[derive(Debug, Default)]
pub(super) struct Expansion {
    /// The size of each anchor's value, and its number of levels: 0 for a scalar.
    of_anchor: HashMap<usize, (Size, usize)>,
    /// The number of levels around the text.
    n_levels_above: usize,
    open: Vec<OpenCollection>,
    /// The text so far, with all aliases expanded.
    all: Size,
    /// The values that the aliases so far expand to.
    aliased: Size,
}

impl Size {
    fn plus(self, other: Self) -> Self {
        Self {
            n_values: self.n_values.saturating_add(other.n_values),
            n_bytes: self.n_bytes.saturating_add(other.n_bytes),
        }
    }

    fn minus(self, other: Self) -> Self {
        Self {
            n_values: self.n_values.saturating_sub(other.n_values),
            n_bytes: self.n_bytes.saturating_sub(other.n_bytes),
        }
    }
}

impl Expansion {
    /// Starts with a text that is the value of a path of `n_levels_above` steps.
    pub(super) fn below(n_levels_above: usize) -> Self {
        Self {
            n_levels_above,
            ..Self::default()
        }
    }

    /// Processes the next event.
    ///
    /// # Errors
    /// The first limit that the text up to here exceeds.
    pub(super) fn take(&mut self, event: &Event) -> Result<(), Excess> {
        let before = self.all;
        match event {
            Event::Scalar(text, _, anchor, _) => {
                self.add(1, text.len());
                self.end(*anchor, before, 0)?;
            }
            Event::SequenceStart(anchor, _) | Event::MappingStart(anchor, _) => {
                self.add(1, 0);
                self.open.push(OpenCollection {
                    anchor: *anchor,
                    before,
                    n_levels: 0,
                });
                self.check_levels(0)?;
            }
            Event::SequenceEnd | Event::MappingEnd => {
                if let Some(ended) = self.open.pop() {
                    self.end(ended.anchor, ended.before, 1 + ended.n_levels)?;
                }
            }
            Event::Alias(anchor) => {
                // An unknown anchor is reported elsewhere.
                let (size, n_levels) = self.of_anchor.get(anchor).copied().unwrap_or_default();
                self.all = self.all.plus(size);
                self.aliased = self.aliased.plus(size);
                self.end(0, before, n_levels)?;
            }
            _ => {}
        }
        if self.aliased.n_values > MAX_VALUES || self.aliased.n_bytes > MAX_BYTES {
            return Err(Excess::Aliases);
        }
        Ok(())
    }

    fn add(&mut self, n_values: u64, n_bytes: usize) {
        self.all = self.all.plus(Size {
            n_values,
            n_bytes: n_bytes as u64,
        });
    }

    /// Ends a value of this many levels that began at size `before`.
    fn end(&mut self, anchor: usize, before: Size, n_levels: usize) -> Result<(), Excess> {
        if anchor > 0 {
            let size = self.all.minus(before);
            self.of_anchor.insert(anchor, (size, n_levels));
        }
        if let Some(around) = self.open.last_mut() {
            around.n_levels = around.n_levels.max(n_levels);
        }
        self.check_levels(n_levels)
    }

    /// Checks the number of levels around and of a value.
    fn check_levels(&self, n_levels: usize) -> Result<(), Excess> {
        if self.n_levels_above + self.open.len() + n_levels > MAX_LEVELS {
            return Err(Excess::Levels);
        }
        Ok(())
    }
}
