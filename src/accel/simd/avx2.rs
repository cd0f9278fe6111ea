//! AVX2: masks are registers too.
#![expect(unsafe_code, reason = "intrinsics, proved by `Avx2::detect`")]

use std::arch::x86_64::*;
use std::ops::BitAnd;

use super::x86::Registers;
use super::{Mask, Work};

/// Proof that the CPU has AVX2, and what every CPU with it has for bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Avx2(());

impl Avx2 {
    /// The proof, if it holds.
    pub(super) fn detect() -> Option<Self> {
        let is_there = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("popcnt");
        is_there.then_some(Self(()))
    }

    /// Does the work with these instructions.
    #[inline]
    pub(super) fn run<W: Work>(self, work: W) -> W::Output {
        #[target_feature(enable = "avx2,bmi1,bmi2,popcnt")]
        fn with_avx2<W: Work>(set: Avx2, work: W) -> W::Output {
            work.run(set)
        }
        // SAFETY: `self` proves AVX2, BMI1, BMI2 and POPCNT.
        unsafe { with_avx2(self, work) }
    }
}

/// Eight truths: all bits of a lane, or none.
#[derive(Clone, Copy)]
pub(in crate::accel) struct WideMask(__m256);

impl Mask for WideMask {
    #[inline(always)]
    fn bits(self) -> u8 {
        // SAFETY: masks come of lanes, which prove AVX2.
        unsafe { _mm256_movemask_ps(self.0) as u8 }
    }
}

impl BitAnd for WideMask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        // SAFETY: masks come of lanes, which prove AVX2.
        Self(unsafe { _mm256_and_ps(self.0, other.0) })
    }
}

impl Registers for Avx2 {
    type Mask = WideMask;

    #[inline(always)]
    fn lt(a: __m256, b: __m256) -> WideMask {
        // SAFETY: only lanes come here, which prove AVX2.
        WideMask(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(a, b) })
    }

    #[inline(always)]
    fn le(a: __m256, b: __m256) -> WideMask {
        // SAFETY: only lanes come here, which prove AVX2.
        WideMask(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(a, b) })
    }

    #[inline(always)]
    fn select(mask: WideMask, this: __m256, other: __m256) -> __m256 {
        // SAFETY: only lanes come here, which prove AVX2.
        unsafe { _mm256_blendv_ps(other, this, mask.0) }
    }

    #[inline(always)]
    fn compress(mask: WideMask, lanes: __m256) -> __m256 {
        let order = TRUE_LANES[usize::from(mask.bits())];
        // SAFETY: only lanes come here, which prove AVX2.
        unsafe {
            let order = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(order));
            _mm256_permutevar8x32_ps(lanes, order)
        }
    }
}

/// For each mask the numbers of its true lanes, a byte each, the first lowest.
static TRUE_LANES: [i64; 256] = {
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
