//! Sixteen lanes in one 512-bit register.
#![expect(
    unsafe_code,
    reason = "intrinsics; each value proves that the CPU has them"
)]

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

use super::real::{Arithmetic, BitMask};
use super::wide::{Sixteen, Wide};

/// A set that has AVX-512F. A value proves that the CPU has the instructions.
pub(super) trait WideRegisters: Copy {}

/// Sixteen numbers in a register, with the set that made them as proof that the CPU has such
/// registers.
#[derive(Clone, Copy)]
pub struct Zmm<R>(__m512, R);

impl<R: WideRegisters> Zmm<R> {
    /// Returns the same number in all lanes.
    #[inline(always)]
    pub(super) fn splat(set: R, value: f32) -> Self {
        // SAFETY: `set` proves AVX-512.
        Self(unsafe { _mm512_set1_ps(value) }, set)
    }

    /// Loads one number per lane.
    #[inline(always)]
    pub(super) fn load(set: R, numbers: &Sixteen) -> Self {
        // SAFETY: `set` proves AVX-512; the pointer is to sixteen numbers, at any
        // alignment.
        Self(unsafe { _mm512_loadu_ps(numbers.as_ptr().cast()) }, set)
    }
}

/// Defines a method or an operator by one intrinsic.
macro_rules! binary {
    ($method:ident, $intrinsic:ident) => {
        #[inline(always)]
        fn $method(self, other: Self) -> Self {
            // SAFETY: the set in `self` proves AVX-512.
            Self(unsafe { $intrinsic(self.0, other.0) }, self.1)
        }
    };
    ($trait:ident: $method:ident, $intrinsic:ident) => {
        impl<R: WideRegisters> $trait for Zmm<R> {
            type Output = Self;
            binary!($method, $intrinsic);
        }
    };
}

binary!(Add: add, _mm512_add_ps);
binary!(Sub: sub, _mm512_sub_ps);
binary!(Mul: mul, _mm512_mul_ps);
binary!(Div: div, _mm512_div_ps);

impl<R: WideRegisters> Arithmetic for Zmm<R> {
    type Mask = BitMask<u16>;

    #[inline(always)]
    fn splat(self, value: f32) -> Self {
        Self::splat(self.1, value)
    }

    binary!(min, _mm512_min_ps);
    binary!(max, _mm512_max_ps);

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: the set in `self` proves AVX-512.
        Self(unsafe { _mm512_abs_ps(self.0) }, self.1)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: the set in `self` proves AVX-512.
        Self(unsafe { _mm512_sqrt_ps(self.0) }, self.1)
    }

    #[inline(always)]
    fn flip_sign_by(self, other: Self) -> Self {
        // SAFETY: the set in `self` proves AVX-512.
        let flipped = unsafe {
            let sign = _mm512_and_si512(_mm512_castps_si512(other.0), _mm512_set1_epi32(i32::MIN));
            _mm512_xor_si512(_mm512_castps_si512(self.0), sign)
        };
        // SAFETY: as above.
        Self(unsafe { _mm512_castsi512_ps(flipped) }, self.1)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> BitMask<u16> {
        // SAFETY: the set in `self` proves AVX-512.
        BitMask(unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn le(self, other: Self) -> BitMask<u16> {
        // SAFETY: the set in `self` proves AVX-512.
        BitMask(unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn select(mask: BitMask<u16>, this: Self, other: Self) -> Self {
        // SAFETY: the set in `this` proves AVX-512.
        Self(
            unsafe { _mm512_mask_blend_ps(mask.0, other.0, this.0) },
            this.1,
        )
    }
}

impl<R: WideRegisters> Wide for Zmm<R> {
    const N_PARTS: usize = 1;

    #[inline(always)]
    fn bits(mask: BitMask<u16>) -> u16 {
        mask.0
    }

    #[inline(always)]
    fn next_up(self) -> Self {
        // SAFETY: the set in `self` proves AVX-512.
        let next = unsafe {
            let bits = _mm512_castps_si512(self.0);
            _mm512_castsi512_ps(_mm512_add_epi32(bits, _mm512_set1_epi32(1)))
        };
        Self(next, self.1)
    }

    #[inline(always)]
    fn to_arrays(self) -> Sixteen {
        // SAFETY: both are sixteen times 32 bits.
        unsafe { std::mem::transmute(self.0) }
    }
}
