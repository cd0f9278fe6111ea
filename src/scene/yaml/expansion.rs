//! The size of a text after alias expansion.
//!
//! An alias of two characters expands to the whole value of its anchor: nine
//! lines can expand to more values than fit into memory (the "billion laughs"
//! attack). This module counts values and bytes before anything is copied.

use std::collections::HashMap;

use saphyr_parser::Event;

/// Maximum number of values that all aliases of a text expand to together.
const MAX_VALUES: u64 = 1_000_000;
/// Maximum number of bytes of scalars in all aliases of a text together.
const MAX_BYTES: u64 = 16 << 20;

/// Number of values, and of bytes in scalars.
#[derive(Debug, Clone, Copy, Default)]
struct Size {
    n_values: u64,
    n_bytes: u64,
}

/// The sizes of all anchors, and of the text expanded so far.
#[derive(Debug, Default)]
pub(super) struct Expansion {
    of_anchor: HashMap<usize, Size>,
    /// For each open collection, its anchor (0 for none) and the size of the text before it.
    open: Vec<(usize, Size)>,
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
    /// Processes the next event; returns false once the aliases exceed a limit.
    pub(super) fn take(&mut self, event: &Event) -> bool {
        let before = self.all;
        match event {
            Event::Scalar(text, _, anchor, _) => {
                self.add(Size {
                    n_values: 1,
                    n_bytes: text.len() as u64,
                });
                self.end(*anchor, before);
            }
            Event::SequenceStart(anchor, _) | Event::MappingStart(anchor, _) => {
                self.add(Size {
                    n_values: 1,
                    n_bytes: 0,
                });
                self.open.push((*anchor, before));
            }
            Event::SequenceEnd | Event::MappingEnd => {
                if let Some((anchor, before)) = self.open.pop() {
                    self.end(anchor, before);
                }
            }
            Event::Alias(anchor) => {
                // An unknown anchor is reported elsewhere.
                let size = self.of_anchor.get(anchor).copied().unwrap_or_default();
                self.add(size);
                self.aliased = self.aliased.plus(size);
            }
            _ => {}
        }
        self.aliased.n_values <= MAX_VALUES && self.aliased.n_bytes <= MAX_BYTES
    }

    fn add(&mut self, size: Size) {
        self.all = self.all.plus(size);
    }

    /// Ends a value that began at size `before`.
    fn end(&mut self, anchor: usize, before: Size) {
        if anchor > 0 {
            self.of_anchor.insert(anchor, self.all.minus(before));
        }
    }
}
