//! Directions with a density given by an equirectangular map.
//!
//! Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, 2023, 12.5.2 and A.5.

use crate::simd::{DeviceTable, LookupTable, Real};

/// A density of directions that is bilinear between the texel centers of a map, whose columns are
/// equal steps of longitude, and rows of latitude. Between two rows it is linear in the sine of the
/// latitude; from the first and the last row to the poles it is constant.
///
/// Two numbers in [0, 1) sample a direction by inversion of the cumulative distributions: the
/// second one its latitude, then the first one its longitude. So well-distributed numbers give
/// well-distributed directions.
#[derive(Debug, Clone, PartialEq)]
pub struct EquirectangularDistribution {
    n_columns: usize,
    /// The densities at texel centers, per steradian, row by row.
    texels: Vec<f32>,
    /// The sum of each row.
    sums: Vec<f32>,
    /// The cumulative distribution of each row at the column centers, from the first column around
    /// to itself: from 0 to 1, row by row.
    columns: Vec<f32>,
    /// The cumulative distribution of the bands between two rows, or between a row and a pole: from
    /// 0 to 1.
    bands: Vec<f32>,
    /// The sines of the latitudes at the edges of the bands, from 1 to -1.
    heights: Vec<f32>,
}

/// The density along a line between two rows.
struct BetweenRows<'a> {
    /// The densities of the rows above and below, at texel centers.
    texels: [&'a [f32]; 2],
    /// The position between them: 0 at the upper row, 1 at the lower one.
    down: f32,
}

/// The cumulative density along a line between two rows, unnormalized.
struct Cumulative<'a> {
    /// The cumulative distributions of the rows above and below.
    columns: [&'a [f32]; 2],
    /// The weights of the two rows.
    weights: [f32; 2],
}

impl EquirectangularDistribution {
    /// Creates a distribution with densities proportional to these numbers, row by row, row 0 on
    /// top; `None` unless their sum is greater than 0 and finite.
    pub fn new(n_columns: usize, texels: &[f32]) -> Option<Self> {
        let n_rows = texels.len() / n_columns.max(1);
        let mut columns = Vec::with_capacity(n_rows * (n_columns + 1));
        let mut sums = Vec::with_capacity(n_rows);
        // Integrate each row between its column centers.
        for row in texels.chunks_exact(n_columns.max(1)) {
            let next = row.iter().cycle().skip(1);
            let steps = row
                .iter()
                .zip(next)
                .map(|(a, b)| 0.5 * (f64::from(*a) + f64::from(*b)));
            sums.push(push_cumulative(steps, &mut columns));
        }
        // Integrate the bands between the rows.
        let heights = row_heights(n_rows);
        let band = |i: usize| {
            let [above, below] = around(i, n_rows).map(|row| sums[row]);
            0.5 * (above + below) * (heights[i] - heights[i + 1])
        };
        let mut bands = Vec::with_capacity(n_rows + 2);
        let n_bands = if n_rows == 0 { 0 } else { n_rows + 1 };
        let sum = push_cumulative((0..n_bands).map(band), &mut bands);
        // Normalize the density to an integral of 1 over the sphere.
        let scale = n_columns as f64 / (std::f64::consts::TAU * sum);
        (sum > 0.0 && sum.is_finite()).then(|| Self {
            n_columns,
            texels: texels
                .iter()
                .map(|texel| (f64::from(*texel) * scale) as f32)
                .collect(),
            sums: sums.iter().map(|sum| (sum * scale) as f32).collect(),
            columns,
            bands,
            heights: heights.iter().map(|height| *height as f32).collect(),
        })
    }

    /// Returns the distribution for other devices: the numbers of columns and rows, then all arrays.
    fn on_device(&self, function: &'static str) -> DeviceTable {
        let Self {
            n_columns,
            texels,
            sums,
            columns,
            bands,
            heights,
        } = self;
        let head = [*n_columns as u32, sums.len() as u32];
        let arrays = [texels, sums, columns, bands, heights];
        let numbers = arrays.into_iter().flatten().map(|number| number.to_bits());
        DeviceTable {
            function,
            words: head.into_iter().chain(numbers).collect(),
        }
    }

    /// Returns the density along a line at position `down` of a band.
    #[inline(always)]
    fn between_rows(&self, [above, below]: [usize; 2], down: f32) -> BetweenRows<'_> {
        let n = self.n_columns;
        BetweenRows {
            texels: [
                &self.texels[above * n..][..n],
                &self.texels[below * n..][..n],
            ],
            down,
        }
    }

    /// Returns the cumulative density along a line at position `down` of a band.
    #[inline(always)]
    fn cumulative(&self, [above, below]: [usize; 2], down: f32) -> Cumulative<'_> {
        let n = self.n_columns + 1;
        Cumulative {
            columns: [
                &self.columns[above * n..][..n],
                &self.columns[below * n..][..n],
            ],
            weights: [self.sums[above] * (1.0 - down), self.sums[below] * down],
        }
    }
}

impl BetweenRows<'_> {
    /// Returns the density on the line at the center of a column.
    #[inline(always)]
    fn at_center(&self, column: usize) -> f32 {
        let [above, below] = self.texels;
        let column = column % above.len();
        let (above, below) = (above[column], below[column]);
        above + (below - above) * self.down
    }
}

impl Cumulative<'_> {
    /// Returns the cumulative density from the center of the first column to the center of another
    /// one.
    #[inline(always)]
    fn up_to_center(&self, column: usize) -> f32 {
        let ([above, below], [of_above, of_below]) = (self.columns, self.weights);
        above[column] * of_above + below[column] * of_below
    }

    /// Returns the column in which the cumulative density reaches a target.
    #[inline(always)]
    fn column(&self, target: f32) -> usize {
        let (mut first, mut n) = (0, self.columns[0].len() - 1);
        // A binary search without branches that depend on the target.
        while n > 1 {
            let half = n / 2;
            let is_behind = self.up_to_center(first + half) <= target;
            first += if is_behind { half } else { 0 };
            n -= half;
        }
        first
    }
}

/// Returns the sines of the latitudes of the poles and the centers of the rows, from 1 to -1.
fn row_heights(n_rows: usize) -> Vec<f64> {
    let center = |row: usize| {
        let turns = 0.5 - (row as f64 + 0.5) / n_rows as f64;
        (std::f64::consts::PI * turns).sin()
    };
    let (top, bottom) = (std::iter::once(1.0), std::iter::once(-1.0));
    top.chain((0..n_rows).map(center)).chain(bottom).collect()
}

/// Returns the rows above and below a band.
#[inline(always)]
fn around(band: usize, n_rows: usize) -> [usize; 2] {
    [band.saturating_sub(1), band.min(n_rows - 1)]
}

/// Appends the cumulative distribution of the weights, one number more than weights; returns their
/// sum.
fn push_cumulative(weights: impl Iterator<Item = f64> + Clone, to: &mut Vec<f32>) -> f64 {
    let sum: f64 = weights.clone().sum();
    let mut before = 0.0;
    to.push(0.0);
    for weight in weights {
        before += weight;
        // Without any weight, the band is never sampled.
        to.push(if sum > 0.0 {
            (before / sum) as f32
        } else {
            1.0
        });
    }
    sum
}

/// Samples a direction with two numbers. Returns its longitude as a fraction of the map's width,
/// possibly greater than 1, the sine of its latitude, and the density, per steradian.
impl LookupTable<2, 3> for EquirectangularDistribution {
    #[inline]
    fn values_at(&self, [u, v]: [f32; 2]) -> [f32; 3] {
        // Sample the latitude: the band, then the position in it.
        let (band, share) = inverse(&self.bands, v);
        let rows = around(band, self.sums.len());
        let down = linear([self.sums[rows[0]], self.sums[rows[1]]], share);
        // Sample the longitude along that line.
        let cumulative = self.cumulative(rows, down);
        let target = u * cumulative.up_to_center(self.n_columns);
        let column = cumulative.column(target);
        let from = cumulative.up_to_center(column);
        let to = cumulative.up_to_center(column + 1);
        let share = if to > from {
            (target - from) / (to - from)
        } else {
            0.5
        };
        let texels = self.between_rows(rows, down);
        let (left, right) = (texels.at_center(column), texels.at_center(column + 1));
        let across = linear([left, right], share.clamp(0.0, 1.0));
        let [upper, lower] = [self.heights[band], self.heights[band + 1]];
        // Return longitude, sine of the latitude, and density.
        [
            (column as f32 + 0.5 + across) / self.n_columns as f32,
            upper + (lower - upper) * down,
            left + (right - left) * across,
        ]
    }

    fn on_device(&self) -> Result<DeviceTable, &'static str> {
        Ok(self.on_device("sample_equirectangular"))
    }
}

/// Returns the density at a direction: its longitude as a fraction of the map's width, plus any
/// whole number, its latitude as a fraction of the map's height from the lower edge, and the sine
/// of its latitude.
impl LookupTable<3, 1> for EquirectangularDistribution {
    #[inline]
    fn values_at(&self, [u, v, height]: [f32; 3]) -> [f32; 1] {
        let n_rows = self.sums.len();
        let band = (((1.0 - v) * n_rows as f32 + 0.5) as usize).min(n_rows);
        let [upper, lower] = [self.heights[band], self.heights[band + 1]];
        let down = ((upper - height) / (upper - lower)).clamp(0.0, 1.0);
        let texels = self.between_rows(around(band, n_rows), down);
        let column = (u - Real::floor(u)) * self.n_columns as f32 + self.n_columns as f32 - 0.5;
        let left = Real::floor(column);
        let from = texels.at_center(left as usize);
        let to = texels.at_center(left as usize + 1);
        [from + (to - from) * (column - left)]
    }

    fn on_device(&self) -> Result<DeviceTable, &'static str> {
        Ok(self.on_device("equirectangular_density"))
    }
}

/// Inverts a cumulative distribution at a number in [0, 1): returns the cell and the position in
/// it, from 0 to 1.
#[inline(always)]
fn inverse(cumulative: &[f32], number: f32) -> (usize, f32) {
    let n_up_to = cumulative.partition_point(|share| *share <= number);
    let cell = n_up_to.clamp(1, cumulative.len() - 1) - 1;
    let [from, to] = [cumulative[cell], cumulative[cell + 1]];
    (cell, (number - from) / (to - from))
}

/// Inverts a density that is linear between its values at 0 and 1: returns the position up to which
/// it has this share.
#[inline(always)]
fn linear([from, to]: [f32; 2], share: f32) -> f32 {
    let root = (from * from + (to * to - from * from) * share)
        .max(0.0)
        .sqrt();
    if from + root > 0.0 {
        (share * (from + to) / (from + root)).min(1.0)
    } else {
        share
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::{PI, TAU};

    use proptest::prelude::*;

    use super::*;

    /// Returns the sampled direction, as its longitude and the sine of its latitude, and its
    /// density.
    fn chosen(of: &EquirectangularDistribution, numbers: [f32; 2]) -> ([f32; 2], f32) {
        let [u, height, density] = f32::look_up(of, numbers);
        ([u, height], density)
    }

    fn density(of: &EquirectangularDistribution, [u, height]: [f32; 2]) -> f32 {
        let [density] = f32::look_up(of, [u, 0.5 + height.asin() / PI, height]);
        density
    }

    proptest! {
        #[test]
        fn parts_of_all_directions_are_chosen_by_their_density(
            n_columns in 1_usize..6,
            densities in prop::collection::vec(prop_oneof![Just(0.0), 0.01_f32..10.0], 6..30),
        ) {
            let n_rows = densities.len() / n_columns;
            let densities = &densities[..n_columns * n_rows];
            let Some(of) = EquirectangularDistribution::new(n_columns, densities) else {
                prop_assert!(densities.iter().all(|density| *density == 0.0));
                return Ok(());
            };
            const N: u32 = 300;
            const PARTS: usize = 4;
            let part = |[u, height]: [f32; 2]| {
                let index = |x: f32| ((x * PARTS as f32) as usize).min(PARTS - 1);
                index(u.fract()) * PARTS + index(0.5 * (1.0 + height))
            };
            let (mut chosen_in, mut expected) = ([0.0; PARTS * PARTS], [0.0; PARTS * PARTS]);
            for i in 0..N * N {
                let numbers = [i / N, i % N].map(|k| (k as f32 + 0.5) / N as f32);
                let (place, found) = chosen(&of, numbers);
                chosen_in[part(place)] += 1.0 / (N * N) as f32;
                let again = density(&of, [place[0] - 3.0, place[1]]);
                prop_assert!(
                    (found - again).abs() < 1e-3 * found + 1e-3,
                    "{:?} {} {}", place, found, again
                );
                let place = [numbers[0], 2.0 * numbers[1] - 1.0];
                expected[part(place)] += density(&of, place) * 2.0 * TAU / (N * N) as f32;
            }
            for (found, expected) in chosen_in.into_iter().zip(expected) {
                prop_assert!((found - expected).abs() < 0.01, "{} {}", found, expected);
            }
        }
    }

    #[test]
    fn the_same_everywhere_is_uniform() {
        let of = EquirectangularDistribution::new(7, &[2.0; 35]).unwrap();
        for i in 0..1000_u16 {
            let numbers = [f32::from(i) / 1000.0, f32::from(i * 7 % 1000) / 1000.0];
            let (_, density) = chosen(&of, numbers);
            assert!((density * 2.0 * TAU - 1.0).abs() < 1e-5);
        }
        for nothing in [&[][..], &[0.0; 6], &[f32::INFINITY, 1.0, 1.0]] {
            assert_eq!(EquirectangularDistribution::new(3, nothing), None);
        }
    }
}
