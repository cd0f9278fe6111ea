//! Eight lanes in one 256-bit register: what AVX2 and AVX-512 have in common.
//!
//! The functions here are no functions in the end: all are inlined into the
//! one that has the target features, [`InstructionSet`]'s `run`.
#![expect(unsafe_code, reason = "intrinsics, proved by the set that makes lanes")]

use std::arch::x86_64::*;
use std::marker::PhantomData;
use std::ops::{Add, Div, Mul, Sub};

use super::{InstructionSet, Lanes, Mask, N_LANES};

/// A set that has AVX2 at least. Its values prove that the CPU has it: they
/// are made by `detect` alone.
pub(in crate::accel) trait Registers: Copy {
    /// Eight truths.
    type Mask: Mask;
    /// `a < b`, `false` if one is NaN.
    fn lt(a: __m256, b: __m256) -> Self::Mask;
    /// `a <= b`, `false` if one is NaN.
    fn le(a: __m256, b: __m256) -> Self::Mask;
    /// `this` where `mask` is true, else `other`.
    fn select(mask: Self::Mask, this: __m256, other: __m256) -> __m256;
    /// `words` where `mask` is true, else 0.
    fn keep(mask: Self::Mask, words: __m256i) -> __m256i;
    /// The words of the true lanes first.
    fn compress(mask: Self::Mask, words: __m256i) -> __m256i;
}

/// Eight numbers in a register of the set `R`.
#[derive(Clone, Copy)]
pub(in crate::accel) struct Ymm<R>(__m256, PhantomData<R>);

impl<R: Registers> InstructionSet for R {
    type Lanes = Ymm<R>;

    #[inline(always)]
    fn splat(self, value: f32) -> Ymm<R> {
        // SAFETY: `self` proves AVX2.
        Ymm::of(unsafe { _mm256_set1_ps(value) })
    }

    #[inline(always)]
    fn load(self, values: &[f32; N_LANES]) -> Ymm<R> {
        // SAFETY: `self` proves AVX2; the pointer is to eight numbers, at any
        // alignment.
        Ymm::of(unsafe { _mm256_loadu_ps(values.as_ptr()) })
    }
}

impl<R> Ymm<R> {
    #[inline(always)]
    fn of(register: __m256) -> Self {
        Self(register, PhantomData)
    }
}

/// One intrinsic as a method or an operator.
macro_rules! binary {
    ($(#[$doc:meta])* $method:ident, $intrinsic:ident) => {
        #[inline(always)]
        fn $method(self, other: Self) -> Self {
            // SAFETY: lanes are made by a set that proves AVX2.
            Self::of(unsafe { $intrinsic(self.0, other.0) })
        }
    };
    ($trait:ident: $method:ident, $intrinsic:ident) => {
        impl<R: Registers> $trait for Ymm<R> {
            type Output = Self;
            binary!($method, $intrinsic);
        }
    };
}

binary!(Add: add, _mm256_add_ps);
binary!(Sub: sub, _mm256_sub_ps);
binary!(Mul: mul, _mm256_mul_ps);
binary!(Div: div, _mm256_div_ps);

impl<R: Registers> Lanes for Ymm<R> {
    type Mask = R::Mask;

    #[inline(always)]
    fn to_array(self) -> [f32; N_LANES] {
        // SAFETY: both are eight numbers.
        unsafe { std::mem::transmute(self.0) }
    }

    binary!(min, _mm256_min_ps);
    binary!(max, _mm256_max_ps);

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: lanes are made by a set that proves AVX2.
        Self::of(unsafe { _mm256_sqrt_ps(self.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: lanes are made by a set that proves AVX2.
        Self::of(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }

    #[inline(always)]
    fn flip_sign_by(self, other: Self) -> Self {
        // SAFETY: lanes are made by a set that proves AVX2.
        Self::of(unsafe {
            let sign = _mm256_and_ps(_mm256_set1_ps(-0.0), other.0);
            _mm256_xor_ps(self.0, sign)
        })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> R::Mask {
        R::lt(self.0, other.0)
    }

    #[inline(always)]
    fn le(self, other: Self) -> R::Mask {
        R::le(self.0, other.0)
    }

    #[inline(always)]
    fn select(mask: R::Mask, this: Self, other: Self) -> Self {
        Self::of(R::select(mask, this.0, other.0))
    }

    #[inline(always)]
    fn far_to_near(
        self,
        mask: R::Mask,
        words: &[u32; N_LANES],
    ) -> ([u32; N_LANES], [f32; N_LANES]) {
        // SAFETY: lanes are made by a set that proves AVX2; arrays and
        // registers are eight words each.
        unsafe {
            let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
            let without_last_bits =
                _mm256_andnot_si256(_mm256_set1_epi32(7), _mm256_castps_si256(self.0));
            // Above 0, which stands for the other lanes and so comes last.
            let keys = _mm256_or_si256(without_last_bits, lanes);
            let keys = _mm256_add_epi32(keys, _mm256_set1_epi32(8));
            let order = descending(R::keep(mask, keys));
            let words = _mm256_loadu_si256(words.as_ptr().cast());
            (
                std::mem::transmute::<__m256i, [u32; 8]>(_mm256_permutevar8x32_epi32(words, order)),
                Self::of(_mm256_permutevar8x32_ps(self.0, order)).to_array(),
            )
        }
    }

    #[inline(always)]
    fn compress(mask: R::Mask, words: &[u32; N_LANES]) -> [u32; N_LANES] {
        // SAFETY: masks come of lanes; arrays and registers are eight words.
        unsafe {
            let words = _mm256_loadu_si256(words.as_ptr().cast());
            std::mem::transmute(R::compress(mask, words))
        }
    }
}

/// One step of the network: each lane keeps the lesser of itself and its
/// partner where `LESSER` has a bit, else the greater.
macro_rules! step {
    ($keys:expr, $partners:expr, $lesser:expr) => {{
        let (keys, partners) = ($keys, $partners);
        let lesser = _mm256_min_epu32(keys, partners);
        let greater = _mm256_max_epu32(keys, partners);
        _mm256_blend_epi32::<$lesser>(greater, lesser)
    }};
}

/// Sorts by Batcher's bitonic network (AFIPS 1968), the greatest first.
///
/// # Safety
/// The CPU has AVX2.
#[inline(always)]
unsafe fn descending(keys: __m256i) -> __m256i {
    const BY_1: i32 = 0b10_11_00_01;
    const BY_2: i32 = 0b01_00_11_10;
    // SAFETY: the caller's promise.
    unsafe {
        let keys = step!(keys, _mm256_shuffle_epi32::<BY_1>(keys), 0b0110_0110);
        let keys = step!(keys, _mm256_shuffle_epi32::<BY_2>(keys), 0b0011_1100);
        let keys = step!(keys, _mm256_shuffle_epi32::<BY_1>(keys), 0b0101_1010);
        let by_4 = _mm256_permute2x128_si256::<1>(keys, keys);
        let keys = step!(keys, by_4, 0b1111_0000);
        let keys = step!(keys, _mm256_shuffle_epi32::<BY_2>(keys), 0b1100_1100);
        step!(keys, _mm256_shuffle_epi32::<BY_1>(keys), 0b1010_1010)
    }
}
