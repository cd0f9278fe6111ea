//! Directions with a density that is given by a map of all of them.
//!
//! Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, 2023, A.5.6 and
//! 12.5.2.

use crate::simd::{LookupTable, Real};

/// A density of directions that is the same everywhere in a cell of a grid, whose columns
/// are at equal steps of longitude, and rows of latitude.
///
/// Two numbers in [0, 1) choose a direction: the second one its row, the first one its
/// column, by the inverse of the cumulative distributions. So numbers that are well
/// distributed give such directions.
#[derive(Debug, Clone, PartialEq)]
pub struct EquirectangularDistribution {
    n_columns: usize,
    /// The cumulative shares of the rows: from 0 to 1, row 0 on top.
    rows: Vec<f32>,
    /// The cumulative shares of the columns of each row, row by row: from 0 to 1.
    columns: Vec<f32>,
    /// The sines of the latitudes at the edges of the rows, from 1 to -1.
    heights: Vec<f32>,
}

impl EquirectangularDistribution {
    /// The distribution with densities in proportion to these numbers, row by row, row 0
    /// on top; `None` unless their sum is greater than 0 and finite.
    pub fn new(n_columns: usize, densities: &[f32]) -> Option<Self> {
        let n_rows = densities.len() / n_columns.max(1);
        let height = |row: usize| (std::f64::consts::PI * (0.5 - row as f64 / n_rows as f64)).sin();
        let mut columns = Vec::with_capacity(n_rows * (n_columns + 1));
        let mut weights = Vec::with_capacity(n_rows);
        for (row, of_row) in densities.chunks_exact(n_columns.max(1)).enumerate() {
            let sum = push_cumulative(of_row.iter().map(|&density| density.into()), &mut columns);
            weights.push(sum * (height(row) - height(row + 1)));
        }
        let mut rows = Vec::with_capacity(n_rows + 1);
        let sum = push_cumulative(weights.into_iter(), &mut rows);
        (sum > 0.0 && sum.is_finite()).then(|| Self {
            n_columns,
            rows,
            columns,
            heights: (0..=n_rows).map(|row| height(row) as f32).collect(),
        })
    }

    /// The cumulative shares of the columns of a row.
    fn columns(&self, row: usize) -> &[f32] {
        &self.columns[row * (self.n_columns + 1)..][..=self.n_columns]
    }

    /// The density in a cell, per steradian.
    fn density(&self, row: usize, column: usize) -> f32 {
        let columns = self.columns(row);
        let share = (self.rows[row + 1] - self.rows[row]) * (columns[column + 1] - columns[column]);
        let height = self.heights[row] - self.heights[row + 1];
        share * self.n_columns as f32 / (std::f32::consts::TAU * height)
    }
}

/// Appends the cumulative shares of weights, one more than there are; returns their sum.
fn push_cumulative(weights: impl Iterator<Item = f64> + Clone, to: &mut Vec<f32>) -> f64 {
    let sum: f64 = weights.clone().sum();
    let mut before = 0.0;
    to.push(0.0);
    for weight in weights {
        before += weight;
        // Without a weight nothing is chosen.
        to.push(if sum > 0.0 {
            (before / sum) as f32
        } else {
            1.0
        });
    }
    sum
}

/// The direction that two numbers choose: its longitude, as the fraction of the grid's
/// width, the sine of its latitude, and the density there, per steradian.
impl LookupTable<2, 3> for EquirectangularDistribution {
    #[inline]
    fn values_at(&self, [u, v]: [f32; 2]) -> [f32; 3] {
        let (row, down) = inverse(&self.rows, v);
        let (column, across) = inverse(self.columns(row), u);
        let [upper, lower] = [self.heights[row], self.heights[row + 1]];
        [
            (column as f32 + across) / self.n_columns as f32,
            upper + (lower - upper) * down,
            self.density(row, column),
        ]
    }
}

/// The density at a place: the fraction of the grid's width, or that and a whole number,
/// and of its height from the lower edge.
impl LookupTable<2, 1> for EquirectangularDistribution {
    #[inline]
    fn values_at(&self, [u, v]: [f32; 2]) -> [f32; 1] {
        let n_rows = self.heights.len() - 1;
        let index = |place: f32, n: usize| ((place * n as f32) as usize).min(n - 1);
        let column = index(u - Real::floor(u), self.n_columns);
        [self.density(index(1.0 - v, n_rows), column)]
    }
}

/// The cell that a number in [0, 1) chooses by cumulative shares, and how far it is in it,
/// from 0 to 1.
fn inverse(cumulative: &[f32], number: f32) -> (usize, f32) {
    let n_up_to = cumulative.partition_point(|share| *share <= number);
    let cell = n_up_to.clamp(1, cumulative.len() - 1) - 1;
    let [from, to] = [cumulative[cell], cumulative[cell + 1]];
    (cell, (number - from) / (to - from))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The direction that numbers choose, as a place of the grid, and its density.
    fn chosen(of: &EquirectangularDistribution, numbers: [f32; 2]) -> ([f32; 2], f32) {
        let [u, height, density] = f32::look_up(of, numbers);
        ([u, 0.5 + height.asin() / std::f32::consts::PI], density)
    }

    proptest! {
        #[test]
        fn shares_of_cells_are_their_densities_times_their_areas(
            n_columns in 1_usize..6,
            densities in prop::collection::vec(prop_oneof![Just(0.0), 0.01_f32..10.0], 6..30),
        ) {
            let n_rows = densities.len() / n_columns;
            let densities = &densities[..n_columns * n_rows];
            let Some(of) = EquirectangularDistribution::new(n_columns, densities) else {
                prop_assert!(densities.iter().all(|density| *density == 0.0));
                return Ok(());
            };
            let mut counts = vec![0; densities.len()];
            const N: u32 = 300;
            for i in 0..N * N {
                let numbers = [i / N, i % N].map(|k| (k as f32 + 0.5) / N as f32);
                let ([u, v], density) = chosen(&of, numbers);
                let row = (((1.0 - v) * n_rows as f32) as usize).min(n_rows - 1);
                let column = ((u * n_columns as f32) as usize).min(n_columns - 1);
                counts[row * n_columns + column] += 1;
                let [found] = f32::look_up(&of, [u - 3.0, v]);
                prop_assert!((found / density - 1.0).abs() < 1e-5, "{} {}", found, density);
            }
            let area = |row: usize| {
                let height = |row: usize| (std::f32::consts::PI * row as f32 / n_rows as f32).cos();
                (height(row) - height(row + 1)) / n_columns as f32
            };
            let sum: f32 = (0..).zip(densities).map(|(i, d)| d * area(i / n_columns)).sum();
            for (i, (count, density)) in counts.into_iter().zip(densities).enumerate() {
                let expected = density * area(i / n_columns) / sum;
                let found = count as f32 / (N * N) as f32;
                prop_assert!((found - expected).abs() < 0.015, "{}: {} {}", i, found, expected);
            }
        }
    }

    #[test]
    fn the_same_everywhere_is_uniform() {
        let of = EquirectangularDistribution::new(7, &[2.0; 35]).unwrap();
        for i in 0..1000_u16 {
            let (_, density) = chosen(
                &of,
                [f32::from(i) / 1000.0, f32::from(i * 7 % 1000) / 1000.0],
            );
            assert!((density * 4.0 * std::f32::consts::PI - 1.0).abs() < 1e-5);
        }
        for nothing in [&[][..], &[0.0; 6], &[f32::INFINITY, 1.0, 1.0]] {
            assert_eq!(EquirectangularDistribution::new(3, nothing), None);
        }
    }
}
