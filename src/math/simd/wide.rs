//! Registers for packets: sixteen lanes where the CPU has them, else eight.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Not, Sub};

use super::real::Real;

/// The numbers of a packet of sixteen rays, in two halves.
pub type Sixteen = [[f32; 8]; 2];

/// The arithmetic that packets share with other numbers.
pub trait Arithmetic:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// One boolean per number.
    type Mask: Copy
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;
    /// Returns the same number in all lanes of `self`.
    fn splat(self, value: f32) -> Self;
    /// Returns `self` where it is less than `other`, else `other`.
    fn min(self, other: Self) -> Self;
    /// Returns `self` where it is greater than `other`, else `other`.
    fn max(self, other: Self) -> Self;
    /// Returns the magnitude.
    fn abs(self) -> Self;
    /// Returns the square root.
    fn sqrt(self) -> Self;
    /// Flips the sign of `self` where the sign bit of `other` is set.
    fn flip_sign_by(self, other: Self) -> Self;
    /// Returns `self < other`; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// Returns `self <= other`; false for NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Returns `this` where `mask` is true, else `other`.
    fn select(mask: Self::Mask, this: Self, other: Self) -> Self;
}

/// The numbers of a part of a packet, in one register.
pub trait Wide: Arithmetic {
    /// Number of parts of a packet.
    const N_PARTS: usize;
    /// Returns the bits: bit `i` for lane `i`.
    fn bits(mask: Self::Mask) -> u16;
    /// Returns the next greater number of each; they must be finite and not negative.
    fn next_up(self) -> Self;
    /// Returns the numbers; eight fill the first half.
    fn to_arrays(self) -> Sixteen;
    /// Stores this part of a packet's numbers.
    #[inline(always)]
    fn store(self, numbers: &mut Sixteen, part: usize) {
        if Self::N_PARTS == 1 {
            *numbers = self.to_arrays();
        } else {
            numbers[part] = self.to_arrays()[0];
        }
    }
}

impl<R: Real> Arithmetic for R {
    type Mask = R::Mask;

    #[inline(always)]
    fn splat(self, value: f32) -> Self {
        Real::splat(self, value)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Real::min(self, other)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Real::max(self, other)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Real::abs(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Real::sqrt(self)
    }

    #[inline(always)]
    fn flip_sign_by(self, other: Self) -> Self {
        Real::flip_sign_by(self, other)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> R::Mask {
        Real::lt(self, other)
    }

    #[inline(always)]
    fn le(self, other: Self) -> R::Mask {
        Real::le(self, other)
    }

    #[inline(always)]
    fn select(mask: R::Mask, this: Self, other: Self) -> Self {
        Real::select(mask, this, other)
    }
}
