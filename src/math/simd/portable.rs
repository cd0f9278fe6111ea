//! Lanes as plain arrays, which the compiler vectorizes for the target: SSE2, NEON.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::lanes::{InstructionSet, Lanes, N_LANES, look_up, next_index};
use super::real::{Arithmetic, BitMask, Double, Integer, LookupTable, Real};
use super::wide::Sixteen;

/// Evaluates an expression for each lane. Loops would do the same, but compile times grow faster
/// than their number, and `array::map` is not always inlined.
macro_rules! eight {
    (|$i:ident| $value:expr) => {
        eight!(@ $i $value; 0 1 2 3 4 5 6 7)
    };
    (@ $i:ident $value:expr; $($lane:literal)*) => {
        [$({
            let $i = $lane;
            $value
        }),*]
    };
}

/// The instruction set that every target has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Portable;

impl InstructionSet for Portable {
    type Lanes = F32x8;
    type Wide = F32x8;

    #[inline(always)]
    fn splat_wide(self, value: f32) -> F32x8 {
        self.splat(value)
    }

    #[inline(always)]
    fn load_wide(self, numbers: &Sixteen, part: usize) -> F32x8 {
        self.load(&numbers[part % 2])
    }

    #[inline(always)]
    fn wide_mask(self, bits: u16) -> <F32x8 as Arithmetic>::Mask {
        self.mask(bits as u8)
    }

    #[inline(always)]
    fn splat(self, value: f32) -> F32x8 {
        F32x8([value; N_LANES])
    }

    #[inline(always)]
    fn load(self, values: &[f32; N_LANES]) -> F32x8 {
        F32x8(*values)
    }

    #[inline(always)]
    fn load_bits(self, bits: &[u32; N_LANES]) -> F32x8 {
        F32x8(bytemuck::cast(*bits))
    }

    #[inline(always)]
    fn splat_bits(self, bits: u32) -> F32x8 {
        F32x8([f32::from_bits(bits); N_LANES])
    }

    #[inline(always)]
    fn mask(self, bits: u8) -> BitMask<u8> {
        BitMask(bits)
    }

    #[inline(always)]
    fn add_to(self, counts: &mut [u32; N_LANES], bits: u8, n: u32) {
        for (lane, count) in counts.iter_mut().enumerate() {
            let is_set = u32::from(bits) >> lane & 1;
            *count += is_set.wrapping_neg() & n;
        }
    }

    /// Does nothing: left to the hardware prefetcher.
    #[inline(always)]
    fn prefetch<T>(self, _: *const T) {}
}

/// Eight numbers.
#[derive(Clone, Copy)]
pub struct F32x8([f32; N_LANES]);

impl F32x8 {
    #[inline(always)]
    fn zip(self, other: Self, op: impl Fn(f32, f32) -> f32) -> Self {
        Self(eight!(|i| op(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn compare(self, other: Self, op: impl Fn(&f32, &f32) -> bool) -> BitMask<u8> {
        let [a, b, c, d, e, f, g, h] = eight!(|i| u8::from(op(&self.0[i], &other.0[i])) << i);
        BitMask((a | b | c | d) | (e | f | g | h))
    }
}

impl Arithmetic for F32x8 {
    type Mask = BitMask<u8>;

    #[inline(always)]
    fn splat(self, value: f32) -> Self {
        Self([value; N_LANES])
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, Arithmetic::min)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, Arithmetic::max)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.zip(self, |a, _| a.sqrt())
    }

    #[inline(always)]
    fn flip_sign_by(self, other: Self) -> Self {
        self.zip(other, Arithmetic::flip_sign_by)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> BitMask<u8> {
        self.compare(other, PartialOrd::lt)
    }

    #[inline(always)]
    fn le(self, other: Self) -> BitMask<u8> {
        self.compare(other, PartialOrd::le)
    }

    #[inline(always)]
    fn select(mask: BitMask<u8>, this: Self, other: Self) -> Self {
        Self(eight!(|i| if mask.0 >> i & 1 != 0 {
            this.0[i]
        } else {
            other.0[i]
        }))
    }
}

impl Real for F32x8 {
    type Integer = U32x8;
    type Double = F64x8;

    #[inline(always)]
    fn floor(self) -> Self {
        self.zip(self, |a, _| Real::floor(a))
    }

    #[inline(always)]
    fn trunc(self) -> Self {
        self.zip(self, |a, _| Real::trunc(a))
    }

    #[inline(always)]
    fn to_integer_bits(self) -> U32x8 {
        U32x8(bytemuck::cast(self.0))
    }

    #[inline(always)]
    fn to_integer(self) -> U32x8 {
        U32x8(eight!(|i| Real::to_integer(self.0[i])))
    }

    #[inline(always)]
    fn to_double(self) -> F64x8 {
        F64x8(eight!(|i| self.0[i].into()))
    }

    #[inline(always)]
    fn from_integer(integers: U32x8) -> Self {
        Self(eight!(|i| Real::from_integer(integers.0[i])))
    }

    #[inline(always)]
    fn from_integer_bits(bits: U32x8) -> Self {
        Self(bytemuck::cast(bits.0))
    }

    #[inline(always)]
    fn from_double(doubles: F64x8) -> Self {
        Self(eight!(|i| doubles.0[i] as f32))
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

impl Lanes for F32x8 {
    #[inline(always)]
    fn to_array(self) -> [f32; N_LANES] {
        self.0
    }

    #[inline(always)]
    fn with_numbers(self, numbers: &[f32; N_LANES]) -> Self {
        Self(*numbers)
    }

    #[inline(always)]
    fn signs(self) -> u8 {
        self.compare(self, |a, _| a.is_sign_negative()).0
    }

    #[inline(always)]
    fn to_bits(self) -> [u32; N_LANES] {
        bytemuck::cast(self.0)
    }

    #[inline(always)]
    fn swap_halves(self) -> Self {
        let [a, b, c, d, e, f, g, h] = self.0;
        Self([e, f, g, h, a, b, c, d])
    }

    #[inline(always)]
    fn permute(self, order: &[u32; N_LANES], shift: Self) -> Self {
        let mut permuted = self;
        for ((lane, order), shift) in permuted.0.iter_mut().zip(order).zip(shift.to_bits()) {
            *lane = self.0[(order >> (shift % 32)) as usize % N_LANES];
        }
        permuted
    }

    #[inline(always)]
    fn compress(self, mask: BitMask<u8>) -> Self {
        let mut kept = self;
        let mut bits = mask.0;
        for slot in kept.0.iter_mut().take(bits.count_ones() as usize) {
            *slot = self.0[bits.trailing_zeros() as usize % N_LANES];
            bits &= bits.wrapping_sub(1);
        }
        kept
    }
}

/// Eight integers.
#[derive(Clone, Copy)]
pub struct U32x8([u32; N_LANES]);

impl U32x8 {
    #[inline(always)]
    fn zip(self, other: Self, op: impl Fn(u32, u32) -> u32) -> Self {
        Self(eight!(|i| op(self.0[i], other.0[i])))
    }
}

impl Integer for U32x8 {
    #[inline(always)]
    fn splat(self, value: u32) -> Self {
        Self([value; N_LANES])
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.zip(other, u32::wrapping_add)
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        self.zip(other, u32::wrapping_mul)
    }

    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self.zip(other, |a, b| a & b)
    }

    #[inline(always)]
    fn xor(self, other: Self) -> Self {
        self.zip(other, |a, b| a ^ b)
    }

    #[inline(always)]
    fn shift_left<const N: i32>(self) -> Self {
        self.zip(self, |a, _| a << N)
    }

    #[inline(always)]
    fn shift_right<const N: i32>(self) -> Self {
        self.zip(self, |a, _| a >> N)
    }
}

/// Eight numbers in double precision.
#[derive(Clone, Copy)]
pub struct F64x8([f64; N_LANES]);

impl Double for F64x8 {
    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        Self([value; N_LANES])
    }

    #[inline(always)]
    fn zero_below(self, limit: f64) -> Self {
        Self(eight!(|i| self.0[i].zero_below(limit)))
    }
}

impl Mul for F64x8 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(eight!(|i| self.0[i] * other.0[i]))
    }
}

impl Neg for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.zip(self, |a, _| -a)
    }
}

/// Implements an operator, lane by lane.
macro_rules! operator {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for F32x8 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $op b)
            }
        }
    };
}

operator!(Add, add, +);
operator!(Sub, sub, -);
operator!(Mul, mul, *);
operator!(Div, div, /);
