//! The children that wait while a ray is in another one.
#![expect(
    unsafe_code,
    reason = "to clear the stack would cost as much as some rays"
)]

use std::mem::MaybeUninit;

use crate::accel::build::MAX_DEPTH;
use crate::accel::layout::Word;
use crate::accel::simd::N_LANES;

/// A node leaves at most seven children behind, and the last one pushes all
/// of its eight lanes.
const CAPACITY: usize = (N_LANES - 1) * (MAX_DEPTH + 1) + N_LANES;

/// A stack of children, each with where the ray enters it.
pub(super) struct Stack {
    /// Entries in use: below this number both arrays are written.
    len: usize,
    words: [MaybeUninit<u32>; CAPACITY],
    enter: [MaybeUninit<f32>; CAPACITY],
}

impl Stack {
    /// Nothing waits.
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            len: 0,
            words: [MaybeUninit::uninit(); CAPACITY],
            enter: [MaybeUninit::uninit(); CAPACITY],
        }
    }

    /// Adds one child.
    #[inline(always)]
    pub(super) fn push(&mut self, word: u32, enter: f32) {
        self.words[self.len].write(word);
        self.enter[self.len].write(enter);
        self.len += 1;
    }

    /// Adds the first `n` children, at most eight; the last one will be taken
    /// first.
    #[inline(always)]
    pub(super) fn push_all(&mut self, words: [u32; N_LANES], enter: [f32; N_LANES], n: usize) {
        let all = self.len..self.len + N_LANES;
        for (slot, word) in self.words[all.clone()].iter_mut().zip(words) {
            slot.write(word);
        }
        for (slot, enter) in self.enter[all].iter_mut().zip(enter) {
            slot.write(enter);
        }
        self.len += n.min(N_LANES);
    }

    /// Takes the child that was added last.
    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<(Word, f32)> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: entries below `len` are written, and this one was.
        unsafe {
            let word = self.words[self.len].assume_init();
            Some((Word(word), self.enter[self.len].assume_init()))
        }
    }
}
