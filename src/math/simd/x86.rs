//! Eight lanes in one 256-bit register: the code shared by AVX2 and AVX-512.
//!
//! All functions here are inlined into the one that has the target features, the `run` of a set:
//! none of them is ever called.
#![expect(
    unsafe_code,
    reason = "intrinsics; each value proves that the CPU has them"
)]

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::lanes::{InstructionSet, Lanes, N_LANES, look_up, next_index};
use super::real::{Arithmetic, LookupTable, Real};
use super::registers::Registers;
use super::wide::Sixteen;
use super::x86_wide::{YmmDoubles, YmmIntegers};

/// Eight numbers in a register, with the set that made them as proof that the CPU has such
/// registers.
#[derive(Clone, Copy)]
pub struct Ymm<R>(__m256, R);

impl<R: Registers> InstructionSet for R {
    type Lanes = Ymm<R>;
    type Wide = R::Wide;

    #[inline(always)]
    fn splat_wide(self, value: f32) -> R::Wide {
        self.wide_of(value)
    }

    #[inline(always)]
    fn load_wide(self, numbers: &Sixteen, part: usize) -> R::Wide {
        self.wide_from(numbers, part)
    }

    #[inline(always)]
    fn wide_mask(self, bits: u16) -> <R::Wide as Arithmetic>::Mask {
        self.wide_mask_of(bits)
    }

    #[inline(always)]
    fn splat(self, value: f32) -> Ymm<R> {
        // SAFETY: `self` proves AVX2.
        Ymm(unsafe { _mm256_set1_ps(value) }, self)
    }

    #[inline(always)]
    fn load(self, values: &[f32; N_LANES]) -> Ymm<R> {
        // SAFETY: `self` proves AVX2; the pointer is to eight numbers, at any
        // alignment.
        Ymm(unsafe { _mm256_loadu_ps(values.as_ptr()) }, self)
    }

    #[inline(always)]
    fn load_bits(self, bits: &[u32; N_LANES]) -> Ymm<R> {
        // SAFETY: as in `load`.
        Ymm(unsafe { _mm256_loadu_ps(bits.as_ptr().cast()) }, self)
    }

    #[inline(always)]
    fn splat_bits(self, bits: u32) -> Ymm<R> {
        // SAFETY: `self` proves AVX2.
        let bits = unsafe { _mm256_castsi256_ps(_mm256_set1_epi32(bits as i32)) };
        Ymm(bits, self)
    }

    #[inline(always)]
    fn mask(self, bits: u8) -> R::Mask {
        self.mask_of(bits)
    }

    #[inline(always)]
    fn add_to(self, counts: &mut [u32; N_LANES], bits: u8, n: u32) {
        let counts: *mut __m256i = counts.as_mut_ptr().cast();
        // SAFETY: `self` proves AVX2; the pointer is to eight integers, at any
        // alignment.
        unsafe {
            let lanes = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let bits = _mm256_and_si256(_mm256_set1_epi32(bits.into()), lanes);
            let is_set = _mm256_cmpeq_epi32(bits, lanes);
            let added = _mm256_and_si256(is_set, _mm256_set1_epi32(n as i32));
            let sum = _mm256_add_epi32(_mm256_loadu_si256(counts), added);
            _mm256_storeu_si256(counts, sum);
        }
    }

    #[inline(always)]
    fn prefetch<T>(self, address: *const T) {
        // SAFETY: every x86-64 CPU has SSE. A prefetch has no effect on the
        // program's state and ignores invalid addresses.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(address.cast()) }
    }
}

/// Defines a method or an operator by one intrinsic.
macro_rules! binary {
    ($(#[$doc:meta])* $method:ident, $intrinsic:ident) => {
        #[inline(always)]
        fn $method(self, other: Self) -> Self {
            // SAFETY: the set in `self` proves AVX2.
            Self(unsafe { $intrinsic(self.0, other.0) }, self.1)
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

impl<R: Registers> Neg for Ymm<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.flip_sign_by(self.splat(-0.0))
    }
}

impl<R: Registers> Arithmetic for Ymm<R> {
    type Mask = R::Mask;

    #[inline(always)]
    fn splat(self, value: f32) -> Self {
        InstructionSet::splat(self.1, value)
    }

    binary!(min, _mm256_min_ps);

    binary!(max, _mm256_max_ps);

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: the set in `self` proves AVX2.
        Self(unsafe { _mm256_sqrt_ps(self.0) }, self.1)
    }

    #[inline(always)]
    fn flip_sign_by(self, other: Self) -> Self {
        // SAFETY: the set in `self` proves AVX2.
        let flipped = unsafe {
            let sign = _mm256_and_ps(_mm256_set1_ps(-0.0), other.0);
            _mm256_xor_ps(self.0, sign)
        };
        Self(flipped, self.1)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> R::Mask {
        self.1.lt(self.0, other.0)
    }

    #[inline(always)]
    fn le(self, other: Self) -> R::Mask {
        self.1.le(self.0, other.0)
    }

    #[inline(always)]
    fn select(mask: R::Mask, this: Self, other: Self) -> Self {
        Self(this.1.select(mask, this.0, other.0), this.1)
    }
}

impl<R: Registers> Real for Ymm<R> {
    type Integer = YmmIntegers<R>;
    type Double = YmmDoubles<R>;

    #[inline(always)]
    fn floor(self) -> Self {
        // SAFETY: the set in `self` proves AVX2.
        Self(unsafe { _mm256_floor_ps(self.0) }, self.1)
    }

    #[inline(always)]
    fn trunc(self) -> Self {
        const TOWARD_ZERO: i32 = _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC;
        // SAFETY: the set in `self` proves AVX2.
        Self(unsafe { _mm256_round_ps::<TOWARD_ZERO>(self.0) }, self.1)
    }

    #[inline(always)]
    fn to_integer_bits(self) -> YmmIntegers<R> {
        // SAFETY: the set in `self` proves AVX2.
        YmmIntegers(unsafe { _mm256_castps_si256(self.0) }, self.1)
    }

    #[inline(always)]
    fn to_integer(self) -> YmmIntegers<R> {
        // SAFETY: the set in `self` proves AVX2.
        YmmIntegers(unsafe { _mm256_cvttps_epi32(self.0) }, self.1)
    }

    #[inline(always)]
    fn to_double(self) -> YmmDoubles<R> {
        // SAFETY: the set in `self` proves AVX2.
        let halves = unsafe {
            [
                _mm256_cvtps_pd(_mm256_castps256_ps128(self.0)),
                _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(self.0)),
            ]
        };
        YmmDoubles(halves, self.1)
    }

    #[inline(always)]
    fn from_integer(integers: YmmIntegers<R>) -> Self {
        // SAFETY: the set in `integers` proves AVX2.
        Self(unsafe { _mm256_cvtepi32_ps(integers.0) }, integers.1)
    }

    #[inline(always)]
    fn from_integer_bits(bits: YmmIntegers<R>) -> Self {
        // SAFETY: the set in `bits` proves AVX2.
        Self(unsafe { _mm256_castsi256_ps(bits.0) }, bits.1)
    }

    #[inline(always)]
    fn from_double(YmmDoubles([low, high], set): YmmDoubles<R>) -> Self {
        // SAFETY: `set` proves AVX2.
        let lanes = unsafe { _mm256_set_m128(_mm256_cvtpd_ps(high), _mm256_cvtpd_ps(low)) };
        Self(lanes, set)
    }

    #[inline(always)]
    fn next_index(self, left: Self::Mask, _: usize) -> Option<usize> {
        next_index(self, left)
    }

    #[inline(always)]
    fn look_up<const N: usize, const M: usize, T: LookupTable<N, M> + ?Sized>(
        table: &T,
        at: [Self; N],
    ) -> [Self; M] {
        look_up(table, at)
    }
}

impl<R: Registers> Lanes for Ymm<R> {
    #[inline(always)]
    fn to_array(self) -> [f32; N_LANES] {
        // SAFETY: both are eight times 32 bits.
        unsafe { std::mem::transmute(self.0) }
    }

    #[inline(always)]
    fn with_numbers(self, numbers: &[f32; N_LANES]) -> Self {
        InstructionSet::load(self.1, numbers)
    }

    #[inline(always)]
    fn signs(self) -> u8 {
        // SAFETY: the set in `self` proves AVX2.
        unsafe { _mm256_movemask_ps(self.0) as u8 }
    }

    #[inline(always)]
    fn to_bits(self) -> [u32; N_LANES] {
        // SAFETY: both are eight times 32 bits.
        unsafe { std::mem::transmute(self.0) }
    }

    #[inline(always)]
    fn swap_halves(self) -> Self {
        // SAFETY: the set in `self` proves AVX2.
        let swapped = unsafe { _mm256_permute2f128_ps::<1>(self.0, self.0) };
        Self(swapped, self.1)
    }

    #[inline(always)]
    fn permute(self, order: &[u32; N_LANES], shift: Self) -> Self {
        // SAFETY: the set in `self` proves AVX2; the pointer is to eight
        // integers, at any alignment.
        let permuted = unsafe {
            let order = _mm256_loadu_si256(order.as_ptr().cast());
            let order = _mm256_srlv_epi32(order, _mm256_castps_si256(shift.0));
            // Reads the low three bits of each index.
            _mm256_permutevar8x32_ps(self.0, order)
        };
        Self(permuted, self.1)
    }

    #[inline(always)]
    fn compress(self, mask: R::Mask) -> Self {
        Self(self.1.compress(mask, self.0), self.1)
    }
}
