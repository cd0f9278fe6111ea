//! Numbers in formulas: a single one, or one per lane.
//!
//! A formula that is generic over [`Real`] is written once. With `f32` it computes for one ray or
//! point, with lanes for eight, and the results agree to the last bit: each operation is rounded as
//! IEEE 754 says, and none is fused.

use std::hash::{Hash, Hasher};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A number, or one per lane. Comparisons with NaN are false.
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
    #[inline(always)]
    fn abs(self) -> Self {
        self.flip_sign_by(self)
    }
    /// Returns the square root.
    fn sqrt(self) -> Self;
    /// Flips the sign where the sign bit of `other` is set.
    fn flip_sign_by(self, other: Self) -> Self;
    /// Returns `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// Returns `self <= other`.
    fn le(self, other: Self) -> Self::Mask;
    /// Returns `this` where `mask` is true, else `other`.
    fn select(mask: Self::Mask, this: Self, other: Self) -> Self;
}

/// A number, or eight.
pub trait Real: Arithmetic<Mask: Mask> + Neg<Output = Self> {
    /// One integer per number.
    type Integer: Integer;
    /// The numbers in double precision.
    type Double: Double;

    /// Returns the same boolean in all lanes of `self`.
    #[inline(always)]
    fn splat_mask(self, value: bool) -> Self::Mask {
        let number = self.splat(f32::from(u8::from(value)));
        self.splat(0.0).lt(number)
    }
    /// Rounds toward negative infinity.
    fn floor(self) -> Self;
    /// Rounds toward zero.
    fn trunc(self) -> Self;
    /// Returns `self == other`.
    #[inline(always)]
    fn equals(self, other: Self) -> Self::Mask {
        self.le(other) & other.le(self)
    }
    /// Returns the bit pattern.
    fn to_integer_bits(self) -> Self::Integer;
    /// Returns the integer part, which must fit into 32 bits.
    fn to_integer(self) -> Self::Integer;
    /// Returns the number in double precision.
    fn to_double(self) -> Self::Double;
    /// Returns the nearest number; the integer must be less than 2^31.
    fn from_integer(integer: Self::Integer) -> Self;
    /// Returns the number with this bit pattern.
    fn from_integer_bits(bits: Self::Integer) -> Self;
    /// Returns the nearest number.
    fn from_double(double: Self::Double) -> Self;
    /// Returns an index that one of the numbers in `left` has; `None` if none is left. Numbers that
    /// only record their operations have no value, and return `least`: a loop over indices passes
    /// the last one plus 1, and finds all below a bound.
    fn next_index(self, left: Self::Mask, least: usize) -> Option<usize>;
    /// Looks up the values of a table at a point, number by number.
    fn look_up<const N: usize, const M: usize, T: LookupTable<N, M> + ?Sized>(
        table: &T,
        at: [Self; N],
    ) -> [Self; M];
}

/// A function of points that is not a formula over lanes, such as a picture lookup.
pub trait LookupTable<const N: usize, const M: usize> {
    /// Returns the values at a point.
    fn values_at(&self, at: [f32; N]) -> [f32; M];

    /// Returns the table for other devices.
    ///
    /// # Errors
    /// They do not have its function; the part of a scene that needs it, in words.
    fn on_device(&self) -> Result<DeviceTable, &'static str>;
}

/// A table for other devices.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeviceTable {
    /// The name of the device's function that looks values up.
    pub function: &'static str,
    /// The words that the function reads.
    pub words: Vec<u32>,
}

/// The first words differ between most tables; to hash all words of a large picture takes long.
impl Hash for DeviceTable {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let first = &self.words[..self.words.len().min(64)];
        (self.function, self.words.len(), first).hash(state);
    }
}

/// Looks up rows by index.
impl<const M: usize> LookupTable<1, M> for [[f32; M]] {
    #[inline(always)]
    fn values_at(&self, [index]: [f32; 1]) -> [f32; M] {
        self[index as usize]
    }

    /// The number of rows, then the rows.
    fn on_device(&self) -> Result<DeviceTable, &'static str> {
        let numbers = self.as_flattened().iter().map(|number| number.to_bits());
        Ok(DeviceTable {
            function: "table_row",
            words: std::iter::once(self.len() as u32).chain(numbers).collect(),
        })
    }
}

/// One boolean per number.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Returns the bits: bit `i` for lane `i`.
    fn bits(self) -> u8;
    /// Returns true if all are true, a hint: formulas give the same results without it.
    fn all(self) -> bool;
    /// Returns true if none is true, a hint as [`all`](Self::all).
    #[inline(always)]
    fn none(self) -> bool {
        self.bits() == 0
    }
}

/// One boolean per lane: bit `i` for lane `i`.
#[derive(Clone, Copy)]
pub struct BitMask<B>(pub(super) B);

impl Mask for BitMask<u8> {
    #[inline(always)]
    fn all(self) -> bool {
        self.0 == u8::MAX
    }

    #[inline(always)]
    fn bits(self) -> u8 {
        self.0
    }
}

impl<B: BitAnd<Output = B>> BitAnd for BitMask<B> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl<B: BitOr<Output = B>> BitOr for BitMask<B> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl<B: Not<Output = B>> Not for BitMask<B> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

/// Integers modulo 2^32.
pub trait Integer: Copy {
    /// Returns the same integer in all lanes of `self`.
    fn splat(self, value: u32) -> Self;
    /// Returns the sum.
    fn plus(self, other: Self) -> Self;
    /// Returns the lower half of the product.
    fn times(self, other: Self) -> Self;
    /// Returns the bitwise AND.
    fn and(self, other: Self) -> Self;
    /// Returns the bitwise XOR.
    fn xor(self, other: Self) -> Self;
    /// Returns the integer times 2^N.
    fn shift_left<const N: i32>(self) -> Self;
    /// Returns the integer shifted right by `N` bits.
    fn shift_right<const N: i32>(self) -> Self;
    /// Returns the bits in reverse order.
    #[inline(always)]
    fn reverse_bits(self) -> Self {
        let swapped = swap::<_, 1>(self, 0x5555_5555);
        let swapped = swap::<_, 2>(swapped, 0x3333_3333);
        let swapped = swap::<_, 4>(swapped, 0x0f0f_0f0f);
        let swapped = swap::<_, 8>(swapped, 0x00ff_00ff);
        swap::<_, 16>(swapped, 0x0000_ffff)
    }
}

/// Swaps groups of `N` bits; `lower` masks every other group.
#[inline(always)]
fn swap<I: Integer, const N: i32>(integer: I, lower: u32) -> I {
    let lower = integer.splat(lower);
    let raised = integer.and(lower).shift_left::<N>();
    raised.xor(integer.shift_right::<N>().and(lower))
}

/// Numbers in double precision.
pub trait Double: Copy + Mul<Output = Self> {
    /// Returns the same number in all lanes of `self`.
    fn splat(self, value: f64) -> Self;
    /// Returns 0 where the number is less than `limit`.
    fn zero_below(self, limit: f64) -> Self;
}

impl Arithmetic for f32 {
    type Mask = bool;

    #[inline(always)]
    fn splat(self, value: f32) -> f32 {
        value
    }

    #[inline(always)]
    fn min(self, other: f32) -> f32 {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn max(self, other: f32) -> f32 {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn sqrt(self) -> f32 {
        f32::sqrt(self)
    }

    #[inline(always)]
    fn flip_sign_by(self, other: f32) -> f32 {
        f32::from_bits(self.to_bits() ^ (other.to_bits() & (1 << 31)))
    }

    #[inline(always)]
    fn lt(self, other: f32) -> bool {
        self < other
    }

    #[inline(always)]
    fn le(self, other: f32) -> bool {
        self <= other
    }

    #[inline(always)]
    fn select(mask: bool, this: f32, other: f32) -> f32 {
        if mask { this } else { other }
    }
}

impl Real for f32 {
    type Integer = u32;
    type Double = f64;

    #[inline(always)]
    fn floor(self) -> f32 {
        let whole = Real::trunc(self);
        if whole > self { whole - 1.0 } else { whole }
    }

    /// `f32::trunc` is a function call on x86-64 without SSE 4.1.
    #[inline(always)]
    fn trunc(self) -> f32 {
        // From 2^23 on all numbers are whole. NaN stays NaN.
        let is_small = self.abs() < (1 << 23) as f32;
        if is_small {
            (self as i32 as f32).copysign(self)
        } else {
            self
        }
    }

    #[inline(always)]
    fn to_integer_bits(self) -> u32 {
        self.to_bits()
    }

    #[inline(always)]
    fn to_integer(self) -> u32 {
        self as i32 as u32
    }

    #[inline(always)]
    fn to_double(self) -> f64 {
        self.into()
    }

    #[inline(always)]
    fn from_integer(integer: u32) -> f32 {
        integer as i32 as f32
    }

    #[inline(always)]
    fn from_integer_bits(bits: u32) -> f32 {
        f32::from_bits(bits)
    }

    #[inline(always)]
    fn from_double(double: f64) -> f32 {
        double as f32
    }

    #[inline(always)]
    fn next_index(self, left: bool, _: usize) -> Option<usize> {
        left.then_some(self as usize)
    }

    #[inline(always)]
    fn look_up<const N: usize, const M: usize, T: LookupTable<N, M> + ?Sized>(
        table: &T,
        at: [f32; N],
    ) -> [f32; M] {
        table.values_at(at)
    }
}

impl Mask for bool {
    #[inline(always)]
    fn all(self) -> bool {
        self
    }

    #[inline(always)]
    fn bits(self) -> u8 {
        self.into()
    }
}

impl Integer for u32 {
    #[inline(always)]
    fn splat(self, value: u32) -> u32 {
        value
    }

    #[inline(always)]
    fn plus(self, other: u32) -> u32 {
        self.wrapping_add(other)
    }

    #[inline(always)]
    fn times(self, other: u32) -> u32 {
        self.wrapping_mul(other)
    }

    #[inline(always)]
    fn and(self, other: u32) -> u32 {
        self & other
    }

    #[inline(always)]
    fn xor(self, other: u32) -> u32 {
        self ^ other
    }

    #[inline(always)]
    fn shift_left<const N: i32>(self) -> u32 {
        self << N
    }

    #[inline(always)]
    fn shift_right<const N: i32>(self) -> u32 {
        self >> N
    }

    #[inline(always)]
    fn reverse_bits(self) -> u32 {
        u32::reverse_bits(self)
    }
}

impl Double for f64 {
    #[inline(always)]
    fn splat(self, value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn zero_below(self, limit: f64) -> f64 {
        if self < limit { 0.0 } else { self }
    }
}
