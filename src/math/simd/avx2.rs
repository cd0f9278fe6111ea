//! AVX2: eight lanes, with masks in registers.
#![expect(unsafe_code, reason = "intrinsics, proved by `Avx2::detect`")]

use std::arch::x86_64::*;
use std::ops::{BitAnd, BitOr, Not};

use super::lanes::{InstructionSet, SimdKernel};
use super::real::Mask;
use super::registers::Registers;
use super::wide::Sixteen;
use super::x86::Ymm;

/// Proof that the CPU has AVX2 and the bit instructions that come with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Avx2(());

impl Avx2 {
    /// Returns the proof if the CPU has the instructions.
    pub fn detect() -> Option<Self> {
        let is_available = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("popcnt");
        is_available.then_some(Self(()))
    }

    /// Runs the kernel with these instructions.
    #[inline]
    pub fn run<K: SimdKernel>(self, kernel: K) -> K::Output {
        #[target_feature(enable = "avx2,bmi1,bmi2,popcnt")]
        fn with_avx2<K: SimdKernel>(set: Avx2, kernel: K) -> K::Output {
            kernel.run(set)
        }
        // SAFETY: `self` proves AVX2, BMI1, BMI2 and POPCNT.
        unsafe { with_avx2(self, kernel) }
    }
}

/// One boolean per lane: all bits of the lane set, or none. Made only by comparisons of lanes, so
/// that it proves AVX2 as they do.
#[derive(Clone, Copy)]
pub struct WideMask(__m256);

impl Mask for WideMask {
    #[inline(always)]
    fn all(self) -> bool {
        self.bits() == u8::MAX
    }

    #[inline(always)]
    fn bits(self) -> u8 {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_movemask_ps(self.0) as u8 }
    }
}

impl BitAnd for WideMask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        // SAFETY: `self` proves AVX2.
        Self(unsafe { _mm256_and_ps(self.0, other.0) })
    }
}

impl BitOr for WideMask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        // SAFETY: `self` proves AVX2.
        Self(unsafe { _mm256_or_ps(self.0, other.0) })
    }
}

impl Not for WideMask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        // SAFETY: `self` proves AVX2.
        Self(unsafe { _mm256_xor_ps(self.0, _mm256_castsi256_ps(_mm256_set1_epi32(-1))) })
    }
}

impl Registers for Avx2 {
    type Mask = WideMask;
    type Wide = Ymm<Self>;

    #[inline(always)]
    fn wide_of(self, value: f32) -> Ymm<Self> {
        self.splat(value)
    }

    #[inline(always)]
    fn wide_from(self, numbers: &Sixteen, part: usize) -> Ymm<Self> {
        self.load(&numbers[part % 2])
    }

    #[inline(always)]
    fn wide_mask_of(self, bits: u16) -> WideMask {
        self.mask_of(bits as u8)
    }

    #[inline(always)]
    fn mask_of(self, bits: u8) -> WideMask {
        // SAFETY: `self` proves AVX2.
        unsafe {
            let lanes = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let bits = _mm256_and_si256(_mm256_set1_epi32(bits.into()), lanes);
            WideMask(_mm256_castsi256_ps(_mm256_cmpeq_epi32(bits, lanes)))
        }
    }

    #[inline(always)]
    fn lt(self, a: __m256, b: __m256) -> WideMask {
        // SAFETY: `self` proves AVX2.
        WideMask(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(a, b) })
    }

    #[inline(always)]
    fn le(self, a: __m256, b: __m256) -> WideMask {
        // SAFETY: `self` proves AVX2.
        WideMask(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(a, b) })
    }

    #[inline(always)]
    fn select(self, mask: WideMask, this: __m256, other: __m256) -> __m256 {
        // SAFETY: `self` proves AVX2.
        unsafe { _mm256_blendv_ps(other, this, mask.0) }
    }

    #[inline(always)]
    fn compress(self, mask: WideMask, lanes: __m256) -> __m256 {
        let order = LANES_OF_MASK[usize::from(mask.bits())];
        // SAFETY: `self` proves AVX2.
        unsafe {
            let order = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(order));
            _mm256_permutevar8x32_ps(lanes, order)
        }
    }
}

/// For each mask, the indices of its lanes, one per byte, the first in the lowest byte.
static LANES_OF_MASK: [i64; 256] = {
    let mut table = [0; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut shift) = (0, 0);
        while lane < 8 {
            if mask >> lane & 1 != 0 {
                table[mask] |= lane << shift;
                shift += 8;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};
