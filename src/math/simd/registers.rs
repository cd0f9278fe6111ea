//! Operations that differ between AVX2 and AVX-512 on 256-bit registers.

use std::arch::x86_64::__m256;

use super::real::{Arithmetic, Mask};
use super::wide::{Sixteen, Wide};

/// A set that has at least AVX2. A value proves that the CPU has the instructions, since only
/// `detect` makes one: therefore each method takes `self`.
pub trait Registers: Copy {
    /// One boolean per lane.
    type Mask: Mask;
    /// The register type for parts of a packet.
    type Wide: Wide;
    /// Returns the same number in all lanes of a part.
    fn wide_of(self, value: f32) -> Self::Wide;
    /// Loads one part of a packet's numbers.
    fn wide_from(self, numbers: &Sixteen, part: usize) -> Self::Wide;
    /// Returns the mask of a part with bit `i` for lane `i`.
    fn wide_mask_of(self, bits: u16) -> <Self::Wide as Arithmetic>::Mask;
    /// Returns `a < b`; `false` if one is NaN.
    fn lt(self, a: __m256, b: __m256) -> Self::Mask;
    /// Returns `a <= b`; `false` if one is NaN.
    fn le(self, a: __m256, b: __m256) -> Self::Mask;
    /// Returns `this` where `mask` is true, else `other`.
    fn select(self, mask: Self::Mask, this: __m256, other: __m256) -> __m256;
    /// Returns the mask with bit `i` for lane `i`.
    fn mask_of(self, bits: u8) -> Self::Mask;
    /// Moves the lanes of `mask` to the front.
    fn compress(self, mask: Self::Mask, lanes: __m256) -> __m256;
}
