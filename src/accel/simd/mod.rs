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
    /// The magnitudes.
    fn abs(self) -> Self;
    /// Changes the sign where `other` is negative.
    fn flip_sign_by(self, other: Self) -> Self;
    /// `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`.
    fn le(self, other: Self) -> Self::Mask;
    /// `self` where `mask` is true, else `other`.
    fn select(mask: Self::Mask, this: Self, other: Self) -> Self;

    /// The lanes of `mask`, at least one, as (`words`, distances), the
    /// farthest first: by the distance without its last three bits, then by
    /// the lane. `self` is not negative. What follows the masked lanes has no
    /// meaning.
    fn far_to_near(
        self,
        mask: Self::Mask,
        words: &[u32; N_LANES],
    ) -> ([u32; N_LANES], [f32; N_LANES]);

    /// The words of the lanes of `mask`, in their order. What follows them has
    /// no meaning.
    fn compress(mask: Self::Mask, words: &[u32; N_LANES]) -> [u32; N_LANES];
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

    /// Orders the lanes whose distance is at most the limit.
    struct Order {
        limit: f32,
    }

    impl Work for Order {
        /// The words by distance, the distances, and the words by lane.
        type Output = (Vec<u32>, Vec<f32>, Vec<u32>);

        #[inline(always)]
        fn run<I: InstructionSet>(self, set: I) -> Self::Output {
            let distances = set.load(&DISTANCES);
            let mask = distances.le(set.splat(self.limit));
            let n = mask.bits().count_ones() as usize;
            let (words, distances) = distances.far_to_near(mask, &WORDS);
            let kept = I::Lanes::compress(mask, &WORDS);
            (
                words[..n].to_vec(),
                distances[..n].to_vec(),
                kept[..n].to_vec(),
            )
        }
    }

    #[test]
    fn all_sets_order_lanes_alike() {
        for simd in Simd::available() {
            let (words, distances, kept) = simd.run(Order { limit: 3.0 });
            assert_eq!(words, [13, 10, 16, 15, 17, 11], "{simd}");
            assert_eq!(distances, [3.0, 3.0, 2.0, 1e-30, 0.0, 0.0], "{simd}");
            assert_eq!(kept, [10, 11, 13, 15, 16, 17], "{simd}");
            let (words, _, _) = simd.run(Order {
                limit: f32::INFINITY,
            });
            assert_eq!(words, [14, 12, 13, 10, 16, 15, 17, 11], "{simd}");
        }
    }
}
