//! Operations that differ between AVX2 and AVX-512 in 256-bit registers.

use std::arch::x86_64::__m256;

use super::real::Mask;
use super::wide::{Arithmetic, Sixteen, Wide};

/// A set that has AVX2 at least. A value of it proves that the CPU has the
/// instructions: only `detect` makes one. So each method takes `self`.
pub trait Registers: Copy {
    /// One boolean per lane.
    type Mask: Mask;
    /// A part of the numbers of a packet.
    type Wide: Wide;
    /// The same number in all lanes of a part.
    fn wide_of(self, value: f32) -> Self::Wide;
    /// This part of the numbers of a packet.
    fn wide_from(self, numbers: &Sixteen, part: usize) -> Self::Wide;
    /// The mask of a part with bit `i` for lane `i`.
    fn wide_mask_of(self, bits: u16) -> <Self::Wide as Arithmetic>::Mask;
    /// `a < b`, `false` if one is NaN.
    fn lt(self, a: __m256, b: __m256) -> Self::Mask;
    /// `a <= b`, `false` if one is NaN.
    fn le(self, a: __m256, b: __m256) -> Self::Mask;
    /// `this` where `mask` is true, else `other`.
    fn select(self, mask: Self::Mask, this: __m256, other: __m256) -> __m256;
    /// The mask with bit `i` for lane `i`.
    fn mask_of(self, bits: u8) -> Self::Mask;
    /// The lanes of `mask` first.
    fn compress(self, mask: Self::Mask, lanes: __m256) -> __m256;
}
