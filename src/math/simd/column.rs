//! Columns of vectors: structures of arrays.

use glam::Vec3;

use super::lanes::{InstructionSet, Lanes, N_LANES};
use super::vector::Vector;

/// Least length of a column that grows: the columns of a wave of rays reach it at once, instead of
/// step by step, each with a wait for the lock of the heap.
const LEAST_LEN: usize = 2048;

/// Vectors as one array per coordinate, padded so that whole lanes fit past the last vector.
#[derive(Debug, Clone, Default)]
pub struct VectorColumn {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
}

impl VectorColumn {
    /// Makes room for at least `n` vectors; keeps the existing ones.
    #[inline]
    pub fn grow(&mut self, n: usize) {
        for numbers in [&mut self.x, &mut self.y, &mut self.z] {
            grow(numbers, n);
        }
    }

    /// Overwrites the first `n` vectors with zeros.
    #[inline]
    pub fn reset(&mut self, n: usize) {
        self.grow(n);
        for numbers in [&mut self.x, &mut self.y, &mut self.z] {
            numbers[..n].fill(0.0);
        }
    }

    /// Returns true if there is no room for any vector.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Loads consecutive vectors from index `first`, one per lane.
    #[inline(always)]
    pub fn load<I: InstructionSet>(&self, set: I, first: usize) -> Vector<I::Lanes> {
        Vector {
            x: set.load(lanes(&self.x, first)),
            y: set.load(lanes(&self.y, first)),
            z: set.load(lanes(&self.z, first)),
        }
    }

    /// Gathers the vectors with these indices, one per lane.
    #[inline(always)]
    pub fn gather<I: InstructionSet>(&self, set: I, indices: &[u32; N_LANES]) -> Vector<I::Lanes> {
        if are_consecutive(indices) {
            return self.load(set, indices[0] as usize);
        }
        let mut columns = [[0.0; N_LANES]; 3];
        for (lane, &index) in indices.iter().enumerate() {
            set_lane(&mut columns, lane, self.get(index as usize));
        }
        set.load_vector(&columns)
    }

    /// Adds to the vectors with these indices, only in the lanes of `lanes`.
    #[inline(always)]
    pub fn add_to<I: InstructionSet>(
        &mut self,
        set: I,
        indices: &[u32; N_LANES],
        added: Vector<I::Lanes>,
        mut lanes: u8,
    ) {
        if lanes == u8::MAX && are_consecutive(indices) {
            let first = indices[0] as usize;
            return self.store(first, self.load(set, first) + added);
        }
        let added = to_arrays(added);
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % N_LANES;
            lanes &= lanes - 1;
            self.add(indices[lane] as usize, lane_of(&added, lane));
        }
    }

    /// Overwrites consecutive vectors from index `first`, one per lane.
    #[inline(always)]
    pub fn store<L: Lanes>(&mut self, first: usize, vectors: Vector<L>) {
        *lanes_mut(&mut self.x, first) = vectors.x.to_array();
        *lanes_mut(&mut self.y, first) = vectors.y.to_array();
        *lanes_mut(&mut self.z, first) = vectors.z.to_array();
    }

    /// Compresses the lanes of `mask` and writes them from index `first`. Overwrites eight vectors:
    /// those after the compressed lanes lose their values.
    #[inline(always)]
    pub fn store_lanes<L: Lanes>(&mut self, first: usize, vectors: Vector<L>, mask: L::Mask) {
        let compressed = Vector {
            x: vectors.x.compress(mask),
            y: vectors.y.compress(mask),
            z: vectors.z.compress(mask),
        };
        self.store(first, compressed);
    }

    /// Returns the coordinates of eight vectors from index `first`.
    #[inline(always)]
    pub fn lanes(&self, first: usize) -> [&[f32; N_LANES]; 3] {
        [
            lanes(&self.x, first),
            lanes(&self.y, first),
            lanes(&self.z, first),
        ]
    }

    /// Overwrites vector `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, vector: Vec3) {
        (self.x[i], self.y[i], self.z[i]) = (vector.x, vector.y, vector.z);
    }

    /// Returns vector `i`.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Adds to vector `i`.
    #[inline(always)]
    pub fn add(&mut self, i: usize, vector: Vec3) {
        self.x[i] += vector.x;
        self.y[i] += vector.y;
        self.z[i] += vector.z;
    }
}

/// Gathers the values with these indices, one per lane.
#[inline(always)]
pub fn gather<T: Copy>(values: &[T], indices: &[u32; N_LANES]) -> [T; N_LANES] {
    if are_consecutive(indices) {
        return *lanes(values, indices[0] as usize);
    }
    indices.map(|index| values[index as usize])
}

/// Returns eight consecutive numbers from `first` on.
#[inline(always)]
pub fn ascending(first: u32) -> [u32; N_LANES] {
    let mut numbers = [first; N_LANES];
    for (number, lane) in numbers.iter_mut().zip(0..) {
        *number += lane;
    }
    numbers
}

/// Returns true if the indices are consecutive: then whole vectors are loaded and stored, not
/// single numbers.
#[inline(always)]
fn are_consecutive(indices: &[u32; N_LANES]) -> bool {
    let mut are = true;
    for lane in 0..N_LANES {
        are &= indices[lane] == indices[0].wrapping_add(lane as u32);
    }
    are
}

/// Makes room for at least `n` values plus padding for whole lanes; keeps the existing values.
#[inline(always)]
pub fn grow<T: Clone + Default>(values: &mut Vec<T>, n: usize) {
    if values.len() < n + N_LANES {
        resize(values, n);
    }
}

#[cold]
#[inline(never)]
fn resize<T: Clone + Default>(values: &mut Vec<T>, n: usize) {
    let enough = (n + N_LANES).next_power_of_two().max(LEAST_LEN);
    values.resize(enough, T::default());
}

/// Returns the eight values from index `first`.
#[inline(always)]
pub fn lanes<T>(values: &[T], first: usize) -> &[T; N_LANES] {
    values[first..]
        .first_chunk()
        .expect("columns hold whole lanes")
}

/// Returns the eight values from index `first`.
#[inline(always)]
pub fn lanes_mut<T>(values: &mut [T], first: usize) -> &mut [T; N_LANES] {
    values[first..]
        .first_chunk_mut()
        .expect("columns hold whole lanes")
}

/// Packs eight bytes, each 0 or 1, into bits: bit `i` for byte `i`.
#[inline(always)]
pub fn bits_of(bytes: &[u8; N_LANES]) -> u8 {
    // The highest byte of the product is the sum of the bytes, each shifted to its bit.
    const SHIFTS: u64 = 0x0102_0408_1020_4080;
    (u64::from_le_bytes(*bytes).wrapping_mul(SHIFTS) >> 56) as u8
}

/// Returns the coordinates x, y and z, lane by lane.
#[inline(always)]
pub fn to_arrays<L: Lanes>(vectors: Vector<L>) -> [[f32; N_LANES]; 3] {
    let Vector { x, y, z } = vectors;
    [x.to_array(), y.to_array(), z.to_array()]
}

/// Sets the vector in one lane of these coordinates x, y and z.
#[inline(always)]
pub fn set_lane([x, y, z]: &mut [[f32; N_LANES]; 3], lane: usize, vector: Vec3) {
    (x[lane], y[lane], z[lane]) = (vector.x, vector.y, vector.z);
}

/// Returns the vector in one lane of these coordinates x, y and z.
#[inline(always)]
pub fn lane_of([x, y, z]: &[[f32; N_LANES]; 3], lane: usize) -> Vec3 {
    Vec3::new(x[lane], y[lane], z[lane])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_those_of_their_bytes() {
        for bits in 0..=u8::MAX {
            let bytes: [u8; N_LANES] = std::array::from_fn(|lane| bits >> lane & 1);
            assert_eq!(bits_of(&bytes), bits);
        }
    }
}
