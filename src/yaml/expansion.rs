//! What a text stands for once its aliases are written out.
//!
//! An alias takes two characters and stands for all of its anchor: nine lines
//! can stand for more values than memory holds, and one long text under an
//! anchor for as many copies as it has aliases. Both are counted before
//! anything is copied.

use std::collections::HashMap;

use saphyr_parser::Event;

/// Most values that all aliases of a text stand for together.
const MAX_VALUES: u64 = 1_000_000;
/// Most bytes of text that they stand for.
const MAX_BYTES: u64 = 16 << 20;

/// Values and bytes of text.
#[derive(Debug, Clone, Copy, Default)]
struct Size {
    n_values: u64,
    n_bytes: u64,
}

/// The sizes of all anchors, and of what was expanded so far.
#[derive(Debug, Default)]
pub(super) struct Expansion {
    of_anchor: HashMap<usize, Size>,
    /// The anchor of each collection that is open, 0 for none, and the size of
    /// all before it.
    open: Vec<(usize, Size)>,
    /// Of all so far, aliases written out.
    all: Size,
    /// Of what aliases stand for.
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
    /// Takes the next event in; gives whether the aliases so far stand for no
    /// more than a scene may.
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
                // An unknown anchor is another mistake.
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

    /// A value ends that began after `before`.
    fn end(&mut self, anchor: usize, before: Size) {
        if anchor > 0 {
            self.of_anchor.insert(anchor, self.all.minus(before));
        }
    }
}
