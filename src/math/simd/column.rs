//! Columns of vectors: structures of arrays.

use glam::Vec3;

use super::lanes::{InstructionSet, Lanes, N_LANES};
use super::vector::Vector;

/// Vectors as one array per coordinate, with room for whole lanes behind the last.
#[derive(Debug, Clone, Default)]
pub struct VectorColumn {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
}

impl VectorColumn {
    /// Makes room for at least `n` vectors; keeps those that it has.
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

    /// Whether it has room for none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// The vectors from index `first` on, one per lane.
    #[inline(always)]
    pub fn load<I: InstructionSet>(&self, set: I, first: usize) -> Vector<I::Lanes> {
        Vector {
            x: set.load(lanes(&self.x, first)),
            y: set.load(lanes(&self.y, first)),
            z: set.load(lanes(&self.z, first)),
        }
    }

    /// The vectors with these indices, one per lane.
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

    /// Adds to the vectors with these indices, as far as they are among `lanes`.
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

    /// Overwrites the vectors from index `first` on, one per lane.
    #[inline(always)]
    pub fn store<L: Lanes>(&mut self, first: usize, vectors: Vector<L>) {
        *lanes_mut(&mut self.x, first) = vectors.x.to_array();
        *lanes_mut(&mut self.y, first) = vectors.y.to_array();
        *lanes_mut(&mut self.z, first) = vectors.z.to_array();
    }

    /// Overwrites the vectors from index `first` on with those of the lanes of `mask`. The
    /// vectors behind them lose their values: there is room for eight.
    #[inline(always)]
    pub fn store_lanes<L: Lanes>(&mut self, first: usize, vectors: Vector<L>, mask: L::Mask) {
        let compressed = Vector {
            x: vectors.x.compress(mask),
            y: vectors.y.compress(mask),
            z: vectors.z.compress(mask),
        };
        self.store(first, compressed);
    }

    /// The coordinates of eight vectors from index `first` on.
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

    /// Vector `i`.
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

/// Whether each index is one more than that before it: then whole vectors are loaded and
/// stored, not number by number.
#[inline(always)]
fn are_consecutive(indices: &[u32; N_LANES]) -> bool {
    let mut are = true;
    for lane in 0..N_LANES {
        are &= indices[lane] == indices[0].wrapping_add(lane as u32);
    }
    are
}

/// Makes room for at least `n` values and a lane for each behind them; keeps those
/// that there are.
#[inline(always)]
pub fn grow<T: Clone + Default>(values: &mut Vec<T>, n: usize) {
    if values.len() < n + N_LANES {
        resize(values, n);
    }
}

#[cold]
#[inline(never)]
fn resize<T: Clone + Default>(values: &mut Vec<T>, n: usize) {
    let enough = (n + N_LANES).next_power_of_two();
    values.resize(enough, T::default());
}

/// The eight values from index `first` on.
#[inline(always)]
pub fn lanes<T>(values: &[T], first: usize) -> &[T; N_LANES] {
    values[first..]
        .first_chunk()
        .expect("columns hold whole lanes")
}

/// The eight values from index `first` on.
#[inline(always)]
pub fn lanes_mut<T>(values: &mut [T], first: usize) -> &mut [T; N_LANES] {
    values[first..]
        .first_chunk_mut()
        .expect("columns hold whole lanes")
}

/// Eight bytes, each 0 or 1, as bits: bit `i` for byte `i`.
#[inline(always)]
pub fn bits_of(bytes: &[u8; N_LANES]) -> u8 {
    // The product has the sum of the bytes, each shifted by its own number of bits, in its
    // highest byte.
    const SHIFTS: u64 = 0x0102_0408_1020_4080;
    (u64::from_le_bytes(*bytes).wrapping_mul(SHIFTS) >> 56) as u8
}

/// The coordinates x, y and z, lane by lane.
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

/// The vector in one lane of these coordinates x, y and z.
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
