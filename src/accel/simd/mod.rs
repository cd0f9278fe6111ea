//! Eight `f32` at a time, on whatever this machine has.
//!
//! The kernels are generic over [`Lanes`], of which there are three kinds:
//! plain arrays, AVX2 and AVX-512. All do the same IEEE operations in the same
//! order and never contract a product and a sum into one rounding, so that
//! hits and counters agree to the last bit on every path.
//!
//! A [`Simd`] is made only after the CPU was asked, once; it is the proof that
//! the unsafe code below rests on.

mod portable;
mod vector;
mod sum;
#[cfg(target_arch = "x86_64")]
mod x86;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;

use std::fmt;
use std::ops::{Add, BitAnd, Div, Mul, Sub};

#[cfg(target_arch = "x86_64")]
use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
use avx512::Avx512;
use portable::Portable;
pub(super) use vector::Vec3Lanes;

/// How many lanes there are.
pub(super) const N_LANES: usize = 8;

/// An instruction set that this machine has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Simd(Set);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Set {
    Portable(Portable),
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
}

impl Simd {
    /// All that this machine has, the fastest one last, at least one.
    pub fn available() -> Vec<Self> {
        #[cfg_attr(not(target_arch = "x86_64"), expect(unused_mut))]
        let mut sets = vec![Set::Portable(Portable)];
        #[cfg(target_arch = "x86_64")]
        {
            sets.extend(Avx2::detect().map(Set::Avx2));
            sets.extend(Avx512::detect().map(Set::Avx512));
        }
        sets.into_iter().map(Self).collect()
    }

    /// The fastest one that this machine has.
    pub fn best() -> Self {
        *Self::available().last().expect("the portable set is there")
    }

    /// Does the work with this instruction set.
    #[inline]
    pub(super) fn run<W: Work>(self, work: W) -> W::Output {
        match self.0 {
            Set::Portable(portable) => work.run(portable),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2(avx2) => avx2.run(work),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512(avx512) => avx512.run(work),
        }
    }
}

impl fmt::Display for Simd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.0 {
            Set::Portable(_) => "portable",
            #[cfg(target_arch = "x86_64")]
            Set::Avx2(_) => "avx2",
            #[cfg(target_arch = "x86_64")]
            Set::Avx512(_) => "avx512",
        })
    }
}

/// Something to do with an instruction set that is chosen at run time.
pub(super) trait Work {
    /// What comes of it.
    type Output;
    /// Does it. Implementations are `#[inline(always)]`, so that they compile
    /// into a function that may use the instructions.
    fn run<I: InstructionSet>(self, set: I) -> Self::Output;
}

/// The source of [`Lanes`]: who has it may use its instructions.
pub(super) trait InstructionSet: Copy {
    /// Its eight lanes.
    type Lanes: Lanes;
    /// The same number in all lanes.
    fn splat(self, value: f32) -> Self::Lanes;
    /// One number a lane.
    fn load(self, values: &[f32; N_LANES]) -> Self::Lanes;
    /// One bit pattern a lane, to be moved about and not to be reckoned with.
    fn load_bits(self, bits: &[u32; N_LANES]) -> Self::Lanes;
    /// The same bit pattern in all lanes.
    fn splat_bits(self, bits: u32) -> Self::Lanes;
    /// Adds a number to the counts whose bits are set.
    fn add_to(self, counts: &mut [u32; N_LANES], bits: u8, n: u32);
    /// Asks for the cache line at this address, if there is one, to be at hand
    /// soon.
    fn prefetch<T>(self, address: *const T);
}

/// Eight numbers. Comparisons with NaN are false.
pub(super) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Eight truths.
    type Mask: Mask;

    /// The numbers, lane by lane.
    fn to_array(self) -> [f32; N_LANES];
    /// `self` where it is less than `other`, else `other`.
    fn min(self, other: Self) -> Self;
    /// `self` where it is greater than `other`, else `other`.
    fn max(self, other: Self) -> Self;
    /// The square roots.
    fn sqrt(self) -> Self;
    /// Changes the sign where `other` is negative.
    fn flip_sign_by(self, other: Self) -> Self;
    /// Bit `i` where lane `i` has the sign of numbers below zero.
    fn signs(self) -> u8;
    /// `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`.
    fn le(self, other: Self) -> Self::Mask;
    /// `self` where `mask` is true, else `other`.
    fn select(mask: Self::Mask, this: Self, other: Self) -> Self;

    /// The bit patterns, lane by lane.
    fn to_bits(self) -> [u32; N_LANES];
    /// At place `i` the lane whose number the last three bits of
    /// `order[i] >> shift[i]` tell, shifts being bit patterns less than 32.
    fn permute(self, order: &[u32; N_LANES], shift: Self) -> Self;
    /// The lanes of `mask` first, in their order. What follows them has no
    /// meaning.
    fn compress(self, mask: Self::Mask) -> Self;
}

/// Eight truths.
pub(super) trait Mask: Copy + BitAnd<Output = Self> {
    /// Bit `i` for lane `i`.
    fn bits(self) -> u8;
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORDS: [u32; N_LANES] = [10, 11, 12, 13, 14, 15, 16, 17];
    const DISTANCES: [f32; N_LANES] = [3.0, 0.0, 7.5, 3.0, f32::INFINITY, 1e-30, 2.0, 0.0];

    /// The words of the lanes whose distance is at most 3, as they stand and
    /// from the last to the first.
    struct Pack;

    impl Work for Pack {
        type Output = [Vec<u32>; 2];

        #[inline(always)]
        fn run<I: InstructionSet>(self, set: I) -> Self::Output {
            let reversed = [7, 6, 5, 4, 3, 2, 1, 0].map(|lane: u32| lane << 6 | 0b101);
            let (words, distances) = (set.load_bits(&WORDS), set.load(&DISTANCES));
            let limit = set.splat(3.0);
            let kept = words.compress(distances.le(limit));
            let last_first = distances.permute(&reversed, set.splat_bits(6)).le(limit);
            let kept_last_first = words
                .permute(&reversed, set.splat_bits(6))
                .compress(last_first);
            let n = last_first.bits().count_ones() as usize;
            [kept, kept_last_first].map(|words| words.to_bits()[..n].to_vec())
        }
    }

    #[test]
    fn all_sets_pack_lanes_alike() {
        for simd in Simd::available() {
            let [kept, kept_last_first] = simd.run(Pack);
            assert_eq!(kept, [10, 11, 13, 15, 16, 17], "{simd}");
            assert_eq!(kept_last_first, [17, 16, 15, 13, 11, 10], "{simd}");
        }
    }
}
