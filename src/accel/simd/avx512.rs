//! AVX-512 on 256-bit registers: masks are bits.
#![expect(unsafe_code, reason = "intrinsics, proved by `Avx512::detect`")]

use std::arch::x86_64::*;
use std::ops::BitAnd;

use super::avx2::Avx2;
use super::x86::Registers;
use super::{Mask, Work};

/// Proof that the CPU has AVX2 and AVX-512 with short registers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Avx512(());

impl Avx512 {
    /// The proof, if it holds.
    pub(super) fn detect() -> Option<Self> {
        let is_there = is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl");
        Avx2::detect().filter(|_| is_there).map(|_| Self(()))
    }

    /// Does the work with these instructions.
    #[inline]
    pub(super) fn run<W: Work>(self, work: W) -> W::Output {
        #[target_feature(enable = "avx2,bmi1,bmi2,popcnt,avx512f,avx512vl")]
        fn with_avx512<W: Work>(set: Avx512, work: W) -> W::Output {
            work.run(set)
        }
        // SAFETY: `self` proves what `Avx2` does, AVX-512F and AVX-512VL.
        unsafe { with_avx512(self, work) }
    }
}

/// Eight truths: bit `i` for lane `i`. A type of its own beside the portable
/// one: who has a value of it has the instructions.
#[derive(Clone, Copy)]
pub(in crate::accel) struct Bits(__mmask8);

impl Mask for Bits {
    #[inline(always)]
    fn bits(self) -> u8 {
        self.0
    }
}

impl BitAnd for Bits {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl Registers for Avx512 {
    type Mask = Bits;

    #[inline(always)]
    fn lt(a: __m256, b: __m256) -> Bits {
        // SAFETY: only lanes come here, which prove AVX-512.
        Bits(unsafe { _mm256_cmp_ps_mask::<_CMP_LT_OQ>(a, b) })
    }

    #[inline(always)]
    fn le(a: __m256, b: __m256) -> Bits {
        // SAFETY: only lanes come here, which prove AVX-512.
        Bits(unsafe { _mm256_cmp_ps_mask::<_CMP_LE_OQ>(a, b) })
    }

    #[inline(always)]
    fn select(mask: Bits, this: __m256, other: __m256) -> __m256 {
        // SAFETY: only lanes come here, which prove AVX-512.
        unsafe { _mm256_mask_blend_ps(mask.0, other, this) }
    }

    #[inline(always)]
    fn compress(mask: Bits, lanes: __m256) -> __m256 {
        // SAFETY: only lanes come here, which prove AVX-512.
        unsafe { _mm256_maskz_compress_ps(mask.0, lanes) }
    }
}
