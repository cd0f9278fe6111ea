//! Eight or sixteen `f32` at a time, with the instruction sets of the CPU.
//!
//! The kernels are generic over `Lanes`, which come as plain arrays, AVX2 and AVX-512. All do the
//! same IEEE operations in the same order and never fuse a multiplication with an addition, so that
//! hits and counters agree to the last bit on every path.
//!
//! [`Simd::available`] detects the instruction sets of the CPU. A value of a set proves that
//! detection, lanes carry it along, and the unsafe code of this folder relies on it.

mod real;
mod lanes;
mod portable;
mod turns;
mod vector;
mod column;
mod wide;
mod sum;
#[cfg(target_arch = "x86_64")]
mod registers;
#[cfg(target_arch = "x86_64")]
mod x86;
#[cfg(target_arch = "x86_64")]
mod x86_wide;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod zmm;

use std::fmt;

#[cfg(target_arch = "x86_64")]
use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
use avx512::Avx512;
pub use column::{
    VectorColumn, ascending, bits_of, gather, grow, lane_of, lanes, lanes_mut, set_lane, to_arrays,
};
pub use lanes::{InstructionSet, Lanes, N_LANES, SimdKernel};
use portable::Portable;
pub use real::{Arithmetic, DeviceTable, Double, Integer, LookupTable, Mask, Real};
pub use turns::{cos_sin, cos_sin_of_eighths, turns_of};
pub use vector::Vector;
pub use wide::Wide;

/// An instruction set that the CPU has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Simd(DetectedSet);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum DetectedSet {
    Portable(Portable),
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
}

impl Simd {
    /// Returns all instruction sets that the CPU has, at least one, the fastest last.
    pub fn available() -> Vec<Self> {
        #[cfg_attr(not(target_arch = "x86_64"), expect(unused_mut))]
        let mut sets = vec![DetectedSet::Portable(Portable)];
        #[cfg(target_arch = "x86_64")]
        {
            sets.extend(Avx2::detect().map(DetectedSet::Avx2));
            sets.extend(Avx512::detect().map(DetectedSet::Avx512));
        }
        sets.into_iter().map(Self).collect()
    }

    /// Returns the fastest instruction set that the CPU has.
    pub fn best() -> Self {
        *Self::available()
            .last()
            .expect("the portable set is always available")
    }

    /// Runs the kernel with this instruction set.
    #[inline]
    pub fn run<K: SimdKernel>(self, kernel: K) -> K::Output {
        match self.0 {
            DetectedSet::Portable(portable) => kernel.run(portable),
            #[cfg(target_arch = "x86_64")]
            DetectedSet::Avx2(avx2) => avx2.run(kernel),
            #[cfg(target_arch = "x86_64")]
            DetectedSet::Avx512(avx512) => avx512.run(kernel),
        }
    }
}

impl fmt::Display for Simd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.0 {
            DetectedSet::Portable(_) => "portable",
            #[cfg(target_arch = "x86_64")]
            DetectedSet::Avx2(_) => "avx2",
            #[cfg(target_arch = "x86_64")]
            DetectedSet::Avx512(_) => "avx512",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Arithmetic, InstructionSet, Lanes, Mask, N_LANES, Simd, SimdKernel};

    const BITS: [u32; N_LANES] = [10, 11, 12, 13, 14, 15, 16, 17];
    const DISTANCES: [f32; N_LANES] = [3.0, 0.0, 7.5, 3.0, f32::INFINITY, 1e-30, 2.0, 0.0];

    /// The bit patterns of the lanes whose distance is at most 3, first to last and last to first.
    struct Compress;

    impl SimdKernel for Compress {
        type Output = [Vec<u32>; 2];

        #[inline(always)]
        fn run<I: InstructionSet>(self, set: I) -> Self::Output {
            let reversed = [7, 6, 5, 4, 3, 2, 1, 0].map(|lane: u32| lane << 6 | 0b101);
            let (bits, distances) = (set.load_bits(&BITS), set.load(&DISTANCES));
            let limit = set.splat(3.0);
            let kept = bits.compress(distances.le(limit));
            let last_first = distances.permute(&reversed, set.splat_bits(6)).le(limit);
            let kept_last_first = bits
                .permute(&reversed, set.splat_bits(6))
                .compress(last_first);
            let n = last_first.bits().count_ones() as usize;
            [kept, kept_last_first].map(|lanes| lanes.to_bits()[..n].to_vec())
        }
    }

    #[test]
    fn every_set_compresses_lanes_in_the_same_way() {
        for simd in Simd::available() {
            let [kept, kept_last_first] = simd.run(Compress);
            assert_eq!(kept, [10, 11, 13, 15, 16, 17], "{simd}");
            assert_eq!(kept_last_first, [17, 16, 15, 13, 11, 10], "{simd}");
        }
    }
}
