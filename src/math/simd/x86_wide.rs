//! Integers and double precision in 256-bit registers.
//!
//! As in `x86`, all functions are inlined into the one that has the target features.
#![expect(
    unsafe_code,
    reason = "intrinsics; each value proves that the CPU has them"
)]

use std::arch::x86_64::*;
use std::ops::Mul;

use super::real::{Double, Integer};
use super::registers::Registers;

/// Eight integers in a register.
#[derive(Clone, Copy)]
pub struct YmmIntegers<R>(pub(super) __m256i, pub(super) R);

/// Defines a method by one intrinsic.
macro_rules! binary {
    ($method:ident, $intrinsic:ident) => {
        #[inline(always)]
        fn $method(self, other: Self) -> Self {
            // SAFETY: the set in `self` proves AVX2.
            Self(unsafe { $intrinsic(self.0, other.0) }, self.1)
        }
    };
}

impl<R: Registers> Integer for YmmIntegers<R> {
    #[inline(always)]
    fn splat(self, value: u32) -> Self {
        // SAFETY: the set in `self` proves AVX2.
        Self(unsafe { _mm256_set1_epi32(value as i32) }, self.1)
    }

    binary!(plus, _mm256_add_epi32);
    binary!(times, _mm256_mullo_epi32);
    binary!(and, _mm256_and_si256);
    binary!(xor, _mm256_xor_si256);

    #[inline(always)]
    fn shift_left<const N: i32>(self) -> Self {
        // SAFETY: the set in `self` proves AVX2.
        Self(unsafe { _mm256_slli_epi32::<N>(self.0) }, self.1)
    }

    #[inline(always)]
    fn shift_right<const N: i32>(self) -> Self {
        // SAFETY: the set in `self` proves AVX2.
        Self(unsafe { _mm256_srli_epi32::<N>(self.0) }, self.1)
    }
}

/// Eight numbers in double precision: the first four and the last four.
#[derive(Clone, Copy)]
pub struct YmmDoubles<R>(pub(super) [__m256d; 2], pub(super) R);

impl<R: Registers> Double for YmmDoubles<R> {
    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        // SAFETY: the set in `self` proves AVX2.
        Self([unsafe { _mm256_set1_pd(value) }; 2], self.1)
    }

    #[inline(always)]
    fn zero_below(self, limit: f64) -> Self {
        let [low, high] = self.0;
        // SAFETY: the set in `self` proves AVX2.
        let kept = unsafe {
            let limit = _mm256_set1_pd(limit);
            // Not-less-than, so that NaN is kept.
            [
                _mm256_and_pd(_mm256_cmp_pd::<_CMP_NLT_UQ>(low, limit), low),
                _mm256_and_pd(_mm256_cmp_pd::<_CMP_NLT_UQ>(high, limit), high),
            ]
        };
        Self(kept, self.1)
    }
}

impl<R: Registers> Mul for YmmDoubles<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: the set in `self` proves AVX2.
        Self(
            unsafe { [_mm256_mul_pd(a, c), _mm256_mul_pd(b, d)] },
            self.1,
        )
    }
}
