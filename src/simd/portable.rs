//! Lanes as plain arrays, which the compiler vectorizes for the target: SSE2,
//! NEON.

use std::ops::{Add, BitAnd, Div, Mul, Sub};

use super::lanes::{InstructionSet, Lanes, Mask, N_LANES};

/// The set that needs no instructions beyond the target's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Portable;

impl InstructionSet for Portable {
    type Lanes = F32x8;

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
    fn add_to(self, counts: &mut [u32; N_LANES], bits: u8, n: u32) {
        for (lane, count) in counts.iter_mut().enumerate() {
            let is_set = u32::from(bits) >> lane & 1;
            *count += is_set.wrapping_neg() & n;
        }
    }

    /// Left to the hardware prefetcher.
    #[inline(always)]
    fn prefetch<T>(self, _: *const T) {}
}

/// Eight numbers.
#[derive(Clone, Copy)]
pub(crate) struct F32x8([f32; N_LANES]);

/// One boolean per lane: bit `i` for lane `i`.
#[derive(Clone, Copy)]
pub(crate) struct BitMask(u8);

impl Mask for BitMask {
    #[inline(always)]
    fn bits(self) -> u8 {
        self.0
    }
}

impl BitAnd for BitMask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl F32x8 {
    #[inline(always)]
    fn zip(mut self, other: Self, op: impl Fn(f32, f32) -> f32) -> Self {
        // A loop: `array::map` and `from_fn` are not always inlined.
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a = op(*a, b);
        }
        self
    }

    #[inline(always)]
    fn compare(self, other: Self, op: impl Fn(&f32, &f32) -> bool) -> BitMask {
        let mut bits = 0;
        for i in 0..N_LANES {
            bits |= u8::from(op(&self.0[i], &other.0[i])) << i;
        }
        BitMask(bits)
    }
}

impl Lanes for F32x8 {
    type Mask = BitMask;

    #[inline(always)]
    fn to_array(self) -> [f32; N_LANES] {
        self.0
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.zip(self, |a, _| a.sqrt())
    }

    #[inline(always)]
    fn flip_sign_by(self, other: Self) -> Self {
        let sign = |x: f32| x.to_bits() & (1 << 31);
        self.zip(other, |a, b| f32::from_bits(a.to_bits() ^ sign(b)))
    }

    #[inline(always)]
    fn signs(self) -> u8 {
        self.compare(self, |a, _| a.is_sign_negative()).0
    }

    #[inline(always)]
    fn lt(self, other: Self) -> BitMask {
        self.compare(other, f32::lt)
    }

    #[inline(always)]
    fn le(self, other: Self) -> BitMask {
        self.compare(other, f32::le)
    }

    #[inline(always)]
    fn select(mask: BitMask, this: Self, other: Self) -> Self {
        let mut selected = other;
        for i in 0..N_LANES {
            if mask.0 >> i & 1 != 0 {
                selected.0[i] = this.0[i];
            }
        }
        selected
    }

    #[inline(always)]
    fn to_bits(self) -> [u32; N_LANES] {
        bytemuck::cast(self.0)
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
    fn compress(self, mask: BitMask) -> Self {
        let mut kept = self;
        let mut bits = mask.0;
        for slot in kept.0.iter_mut().take(bits.count_ones() as usize) {
            *slot = self.0[bits.trailing_zeros() as usize % N_LANES];
            bits &= bits.wrapping_sub(1);
        }
        kept
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
