//! Eight lanes and their masks, the interface between kernels and instruction sets.

use glam::Vec3;

use super::real::{Arithmetic, Integer, LookupTable, Mask, Real};
use super::vector::Vector;
use super::wide::{Sixteen, Wide};

/// Number of lanes.
pub const N_LANES: usize = 8;

/// A computation that is compiled once for each instruction set.
pub trait SimdKernel {
    /// The result.
    type Output;
    /// Runs the kernel. Implementations are `#[inline(always)]`: they must be inlined into the
    /// function that has the target features.
    fn run<I: InstructionSet>(self, set: I) -> Self::Output;
}

/// The source of [`Lanes`]. A value is a proof that the CPU has the instructions.
pub trait InstructionSet: Copy {
    /// The eight lanes.
    type Lanes: Lanes;
    /// The register type for parts of a packet.
    type Wide: Wide;
    /// Returns the same number in all lanes of a part.
    fn splat_wide(self, value: f32) -> Self::Wide;
    /// Loads one part of a packet's numbers.
    fn load_wide(self, numbers: &Sixteen, part: usize) -> Self::Wide;
    /// Returns the mask of a part with bit `i` for lane `i`.
    fn wide_mask(self, bits: u16) -> <Self::Wide as Arithmetic>::Mask;
    /// Returns the same number in all lanes.
    fn splat(self, value: f32) -> Self::Lanes;
    /// Returns the same vector in all lanes.
    #[inline(always)]
    fn splat_vector(self, v: Vec3) -> Vector<Self::Lanes> {
        Vector::splat(self.splat(0.0), v)
    }
    /// Loads one number per lane.
    fn load(self, values: &[f32; N_LANES]) -> Self::Lanes;
    /// Loads one vector per lane, with these coordinates x, y and z.
    #[inline(always)]
    fn load_vector(self, [x, y, z]: &[[f32; N_LANES]; 3]) -> Vector<Self::Lanes> {
        Vector {
            x: self.load(x),
            y: self.load(y),
            z: self.load(z),
        }
    }
    /// Loads one bit pattern per lane: for permutations, not for arithmetic.
    fn load_bits(self, bits: &[u32; N_LANES]) -> Self::Lanes;
    /// Returns the same bit pattern in all lanes.
    fn splat_bits(self, bits: u32) -> Self::Lanes;
    /// Loads one integer per lane.
    #[inline(always)]
    fn load_integers(self, integers: &[u32; N_LANES]) -> <Self::Lanes as Real>::Integer {
        self.load_bits(integers).to_integer_bits()
    }
    /// Returns the mask with bit `i` for lane `i`.
    fn mask(self, bits: u8) -> <Self::Lanes as Arithmetic>::Mask;
    /// Adds `n` to the counts whose bits are set.
    fn add_to(self, counts: &mut [u32; N_LANES], bits: u8, n: u32);
    /// Prefetches the cache line at this address, which need not be valid, into
    /// all levels of the cache.
    fn prefetch<T>(self, address: *const T);
}

/// Eight numbers.
pub trait Lanes: Real {
    /// Returns the numbers, lane by lane.
    fn to_array(self) -> [f32; N_LANES];
    /// Replaces the numbers, lane by lane.
    fn with_numbers(self, numbers: &[f32; N_LANES]) -> Self;
    /// Returns the sign bits: bit `i` for lane `i`.
    fn signs(self) -> u8;
    /// Returns the bit patterns, lane by lane.
    fn to_bits(self) -> [u32; N_LANES];
    /// Returns lanes 4 to 7, then lanes 0 to 3.
    fn swap_halves(self) -> Self;
    /// Permutes lanes: lane `i` of the result is lane `(order[i] >> shift[i]) % 8`; the shifts are
    /// bit patterns less than 32.
    fn permute(self, order: &[u32; N_LANES], shift: Self) -> Self;
    /// Moves the lanes of `mask` to the front, in their order. The remaining lanes have no meaning.
    fn compress(self, mask: Self::Mask) -> Self;
}

/// Implements [`Real::next_index`] for lanes.
#[inline(always)]
pub(super) fn next_index<L: Lanes>(indices: L, left: L::Mask) -> Option<usize> {
    let bits = left.bits();
    (bits != 0).then(|| indices.to_array()[bits.trailing_zeros() as usize % N_LANES] as usize)
}

/// Implements [`Real::look_up`] for lanes.
#[inline(always)]
pub(super) fn look_up<L, const N: usize, const M: usize, T>(table: &T, at: [L; N]) -> [L; M]
where
    L: Lanes,
    T: LookupTable<N, M> + ?Sized,
{
    const { assert!(N > 0) }
    let mut points = [[0.0; N]; N_LANES];
    for i in 0..N {
        for (point, number) in points.iter_mut().zip(at[i].to_array()) {
            point[i] = number;
        }
    }
    let mut columns = [[0.0; N_LANES]; M];
    for (lane, point) in points.into_iter().enumerate() {
        for (column, value) in columns.iter_mut().zip(table.values_at(point)) {
            column[lane] = value;
        }
    }
    let mut found = [at[0]; M];
    for i in 0..M {
        found[i] = at[0].with_numbers(&columns[i]);
    }
    found
}

impl<L: Lanes> Wide for L {
    const N_PARTS: usize = 2;

    #[inline(always)]
    fn bits(mask: L::Mask) -> u16 {
        mask.bits().into()
    }

    #[inline(always)]
    fn next_up(self) -> Self {
        let bits = self.to_integer_bits();
        Self::from_integer_bits(bits.plus(bits.splat(1)))
    }

    #[inline(always)]
    fn to_arrays(self) -> Sixteen {
        [self.to_array(), [0.0; N_LANES]]
    }
}
