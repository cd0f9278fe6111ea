//! Points in the strata of a pixel.

use super::hash::{hash, mixed, unit};
use crate::simd::{Integer, Real};

/// Points in a pixel: `n` strata of equal area with one jittered point each. One stratum's point is
/// the pixel's center.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Strata {
    n: u32,
    n_rows: u32,
    /// The index of the point at the pixel's center.
    center: u32,
    /// The lower half of the seed.
    seed: u32,
    /// The hash of the upper half of the seed.
    mixed: [u32; 4],
}

impl Strata {
    /// Creates `n` strata, at least 1.
    pub(super) fn new(n: u32, seed: u64) -> Self {
        let mut pattern = Self {
            n,
            n_rows: (n as f32).sqrt().round().max(1.0) as u32,
            center: 0,
            seed: seed as u32,
            mixed: mixed([(seed >> 32) as u32, 0, 0]),
        };
        let row = pattern.n_rows / 2;
        let [first, end] = [row, row + 1].map(|row| pattern.first_of_row(row));
        pattern.center = first + (end - first) / 2;
        pattern
    }

    /// Returns the index of the point at the pixel's center.
    pub(super) fn center(&self) -> u32 {
        self.center
    }

    /// Returns point `i` of one pixel, or one per lane: both coordinates in [-0.5, 0.5), relative
    /// to the pixel's center.
    #[inline(always)]
    pub(super) fn point<R: Real>(&self, pixel: R::Integer, i: u32) -> [R; 2] {
        let zero = R::from_integer(pixel.splat(0));
        if i == self.center {
            return [zero; 2];
        }
        let row = self.row_of(i);
        let (first, end) = (self.first_of_row(row), self.first_of_row(row + 1));
        let key = [pixel.splat(self.seed), pixel, pixel.splat(i)];
        let words = hash(key, self.mixed);
        let (u, v) = (unit::<R>(words[0]), unit::<R>(words[1]));
        // A row is as high as its number of points demands: all strata have the same area.
        let n_in_row = zero.splat((end - first) as f32);
        let x = (zero.splat((i - first) as f32) + u) / n_in_row;
        let y = (zero.splat(first as f32) + v * n_in_row) / zero.splat(self.n as f32);
        let half = zero.splat(0.5);
        [x - half, y - half]
    }

    /// Returns the first point of a row. The numbers of points per row differ by at most 1.
    fn first_of_row(&self, row: u32) -> u32 {
        (u64::from(row) * u64::from(self.n) / u64::from(self.n_rows)) as u32
    }

    /// Returns the row of a point: the greatest whose first point is at most `i`, so that
    /// `row * n < (i + 1) * n_rows`.
    fn row_of(&self, i: u32) -> u32 {
        ((u64::from(i + 1) * u64::from(self.n_rows) - 1) / u64::from(self.n)) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stratum_has_one_point_and_one_is_the_center() {
        for n in 1..=40 {
            let pattern = Strata::new(n, 5);
            assert_eq!(pattern.point::<f32>(9, pattern.center()), [0.0; 2]);
            let mut rows = vec![0; pattern.n_rows as usize];
            for i in 0..n {
                let row = pattern.row_of(i);
                let (first, end) = (pattern.first_of_row(row), pattern.first_of_row(row + 1));
                assert!((first..end).contains(&i), "point {i} of {n} in row {row}");
                rows[row as usize] += 1;
                let [x, y] = pattern.point::<f32>(9, i).map(|offset| offset + 0.5);
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
