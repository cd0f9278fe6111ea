//! What an instruction set gives to kernels: eight lanes, and masks of them.

use std::ops::{Add, BitAnd, Div, Mul, Sub};

/// Number of lanes.
pub(crate) const N_LANES: usize = 8;

/// A computation that is compiled once for each instruction set.
pub(crate) trait SimdKernel {
    /// Its result.
    type Output;
    /// Runs it. Implementations are `#[inline(always)]`: they must be inlined
    /// into the function that has the target features.
    fn run<I: InstructionSet>(self, set: I) -> Self::Output;
}

/// The source of [`Lanes`]. A value of it is the proof that the CPU has the
/// instructions.
pub(crate) trait InstructionSet: Copy {
    /// Its eight lanes.
    type Lanes: Lanes;
    /// The same number in all lanes.
    fn splat(self, value: f32) -> Self::Lanes;
    /// One number per lane.
    fn load(self, values: &[f32; N_LANES]) -> Self::Lanes;
    /// One bit pattern per lane: to be permuted, not to be computed with.
    fn load_bits(self, bits: &[u32; N_LANES]) -> Self::Lanes;
    /// The same bit pattern in all lanes.
    fn splat_bits(self, bits: u32) -> Self::Lanes;
    /// Adds `n` to those counts whose bits are set.
    fn add_to(self, counts: &mut [u32; N_LANES], bits: u8, n: u32);
    /// Prefetches the cache line at this address, which need not be valid, into
    /// all levels of the cache.
    fn prefetch<T>(self, address: *const T);
}

/// Eight numbers. Comparisons with NaN are false.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// One boolean per lane.
    type Mask: Mask;

    /// The numbers, lane by lane.
    fn to_array(self) -> [f32; N_LANES];
    /// `self` where it is less than `other`, else `other`.
    fn min(self, other: Self) -> Self;
    /// `self` where it is greater than `other`, else `other`.
    fn max(self, other: Self) -> Self;
    /// The square roots.
    fn sqrt(self) -> Self;
    /// Flips the sign where the sign bit of `other` is set.
    fn flip_sign_by(self, other: Self) -> Self;
    /// The magnitudes.
    #[inline(always)]
    fn abs(self) -> Self {
        self.flip_sign_by(self)
    }
    /// The sign bits: bit `i` for lane `i`.
    fn signs(self) -> u8;
    /// `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`.
    fn le(self, other: Self) -> Self::Mask;
    /// `this` where `mask` is true, else `other`.
    fn select(mask: Self::Mask, this: Self, other: Self) -> Self;

    /// The bit patterns, lane by lane.
    fn to_bits(self) -> [u32; N_LANES];
    /// Lane `i` of the result is lane `(order[i] >> shift[i]) % 8`; the shifts
    /// are bit patterns less than 32.
    fn permute(self, order: &[u32; N_LANES], shift: Self) -> Self;
    /// Moves the lanes of `mask` to the front, in their order. The lanes behind
    /// them have no meaning.
    fn compress(self, mask: Self::Mask) -> Self;
}

/// One boolean per lane.
pub(crate) trait Mask: Copy + BitAnd<Output = Self> {
    /// Bit `i` for lane `i`.
    fn bits(self) -> u8;
}
