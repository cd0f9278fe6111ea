//! Random numbers that depend only on their key.
//!
//! They are hashes instead of the output of a generator with a state: a sample
//! of a pixel or a sphere of a cloud is the same in whatever order and on
//! whatever thread it is computed.

use glam::Vec2;

/// Four uniformly distributed numbers in [0, 1) for a key of three integers.
///
/// The hash is pcg4d of Jarzynski and Olano, "Hash Functions for GPU
/// Rendering", JCGT 9(3), 2020, on both halves of the key.
pub fn uniform(key: [u64; 3]) -> [f32; 4] {
    let low = key.map(|word| word as u32);
    let high = key.map(|word| (word >> 32) as u32);
    let mixed = pcg4d([high[0], high[1], high[2], 0]);
    let bits = pcg4d([
        low[0] ^ mixed[0],
        low[1] ^ mixed[1],
        low[2] ^ mixed[2],
        mixed[3],
    ]);
    // An f32 in [0, 1) has 24 bits of uniform resolution.
    bits.map(|word| (word >> 8) as f32 / (1 << 24) as f32)
}

fn pcg4d(key: [u32; 4]) -> [u32; 4] {
    let [mut x, mut y, mut z, mut w] =
        key.map(|word| word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    for round in 0..2 {
        x = x.wrapping_add(y.wrapping_mul(w));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        w = w.wrapping_add(y.wrapping_mul(z));
        if round == 0 {
            [x, y, z, w] = [x, y, z, w].map(|word| word ^ (word >> 16));
        }
    }
    [x, y, z, w]
}

/// A stratified pattern of points in a pixel: `n` strata of equal area with one
/// jittered point each. The point of one stratum is the pixel's center.
#[derive(Debug, Clone, Copy)]
pub struct PixelPattern {
    n: u32,
    n_rows: u32,
    /// The index of the point in the pixel's center.
    center: u32,
    seed: u64,
}

impl PixelPattern {
    /// A pattern of `n` points, at least 1.
    pub fn new(n: u32, seed: u64) -> Self {
        let mut pattern = Self {
            n,
            n_rows: (n as f32).sqrt().round().max(1.0) as u32,
            center: 0,
            seed,
        };
        let row = pattern.n_rows / 2;
        let [first, end] = [row, row + 1].map(|row| pattern.first_of_row(row));
        pattern.center = first + (end - first) / 2;
        pattern
    }

    /// The index of the point in the pixel's center.
    pub fn center(&self) -> u32 {
        self.center
    }

    /// Point `i` of pixel number `pixel`, relative to the pixel's center: both
    /// coordinates are in [-0.5, 0.5).
    pub fn point(&self, pixel: u64, i: u32) -> Vec2 {
        if i == self.center {
            return Vec2::ZERO;
        }
        let row = self.row_of(i);
        let (first, end) = (self.first_of_row(row), self.first_of_row(row + 1));
        let [u, v, ..] = uniform([self.seed, pixel, i.into()]);
        // The height of a row is proportional to its points: all strata have the
        // same area.
        let n_in_row = (end - first) as f32;
        let x = ((i - first) as f32 + u) / n_in_row;
        let y = (first as f32 + v * n_in_row) / self.n as f32;
        Vec2::new(x, y) - 0.5
    }

    /// The first point of a row. The numbers of points per row differ by at most
    /// 1.
    fn first_of_row(&self, row: u32) -> u32 {
        (u64::from(row) * u64::from(self.n) / u64::from(self.n_rows)) as u32
    }

    fn row_of(&self, i: u32) -> u32 {
        let guess = (u64::from(i) * u64::from(self.n_rows) / u64::from(self.n)) as u32;
        if i >= self.first_of_row(guess + 1) {
            guess + 1
        } else {
            guess
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniform_numbers_are_uniformly_distributed() {
        let mut counts = [0; 16];
        for i in 0..10_000 {
            for u in uniform([7, i, 3 << 32]) {
                counts[(u * 16.0) as usize] += 1;
            }
        }
        assert!(
            counts.iter().all(|n| (2300..2700).contains(n)),
            "{counts:?}"
        );
    }

    #[test]
    fn every_stratum_has_one_point_and_one_is_the_center() {
        for n in 1..=40 {
            let pattern = PixelPattern::new(n, 5);
            assert_eq!(pattern.point(9, pattern.center()), Vec2::ZERO);
            let mut rows = vec![0; pattern.n_rows as usize];
            for i in 0..n {
                let row = pattern.row_of(i);
                let (first, end) = (pattern.first_of_row(row), pattern.first_of_row(row + 1));
                assert!((first..end).contains(&i), "point {i} of {n} in row {row}");
                rows[row as usize] += 1;
                let Vec2 { x, y } = pattern.point(9, i) + 0.5;
                let column = (x * (end - first) as f32).floor() as u32;
                let in_its_column = column == i - first || i == pattern.center();
                let in_its_row = y >= first as f32 / n as f32 && y <= end as f32 / n as f32;
                assert!(in_its_column && in_its_row, "point {i} of {n} at {x}, {y}");
            }
            let spread = rows.iter().max().unwrap() - rows.iter().min().unwrap();
            assert!(spread <= 1, "{rows:?}");
        }
    }
}
