//! Random numbers that depend only on their key.
//!
//! They are hashes instead of the output of a generator with a state: a sample
//! of a pixel or a sphere of a cloud is the same in whatever order and on
//! whatever thread it is computed.

use glam::Vec2;

use crate::simd::{Integer, Real};

/// Four uniformly distributed numbers in [0, 1) for a key of three integers.
///
/// The hash is pcg4d of Jarzynski and Olano, "Hash Functions for GPU
/// Rendering", JCGT 9(3), 2020, on both halves of the key.
pub fn uniform(key: [u64; 3]) -> [f32; 4] {
    let [low, high] = [0, 32].map(|shift| key.map(|word| (word >> shift) as u32));
    // An f32 in [0, 1) has 24 bits of uniform resolution.
    hash(low, mixed(high)).map(unit::<f32>)
}

/// The hash of the upper halves of a key.
fn mixed([a, b, c]: [u32; 3]) -> [u32; 4] {
    pcg4d([a, b, c, 0])
}

/// The hash of the lower halves of a key, for one key or for lanes of keys.
#[inline(always)]
fn hash<N: Integer>([a, b, c]: [N; 3], mixed: [u32; 4]) -> [N; 4] {
    let [mixed_a, mixed_b, mixed_c, mixed_d] = mixed;
    pcg4d([
        a.xor(a.splat(mixed_a)),
        b.xor(a.splat(mixed_b)),
        c.xor(a.splat(mixed_c)),
        a.splat(mixed_d),
    ])
}

/// The number in [0, 1) that has the highest 24 bits of a word.
#[inline(always)]
fn unit<R: Real>(word: R::Integer) -> R {
    let whole = R::from_integer(word.shift_right::<8>());
    whole * whole.splat(1.0 / (1 << 24) as f32)
}

#[inline(always)]
fn pcg4d<N: Integer>([x, y, z, w]: [N; 4]) -> [N; 4] {
    let (x, y, z, w) = round(congruent(x), congruent(y), congruent(z), congruent(w));
    let (x, y, z, w) = round(folded(x), folded(y), folded(z), folded(w));
    [x, y, z, w]
}

/// The next number of a linear congruential generator.
#[inline(always)]
fn congruent<N: Integer>(word: N) -> N {
    let product = word.times(word.splat(1_664_525));
    product.plus(word.splat(1_013_904_223))
}

/// A word whose upper bits change its lower ones.
#[inline(always)]
fn folded<N: Integer>(word: N) -> N {
    word.xor(word.shift_right::<16>())
}

/// A round of pcg4d.
#[inline(always)]
fn round<N: Integer>(x: N, y: N, z: N, w: N) -> (N, N, N, N) {
    let x = x.plus(y.times(w));
    let y = y.plus(z.times(x));
    let z = z.plus(x.times(y));
    let w = w.plus(y.times(z));
    (x, y, z, w)
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
    /// The hash of the upper halves of the keys of pixels below 2^32.
    mixed: [u32; 4],
}

impl PixelPattern {
    /// A pattern of `n` points, at least 1.
    pub fn new(n: u32, seed: u64) -> Self {
        let mut pattern = Self {
            n,
            n_rows: (n as f32).sqrt().round().max(1.0) as u32,
            center: 0,
            seed,
            mixed: mixed([(seed >> 32) as u32, 0, 0]),
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
    #[inline]
    pub fn point(&self, pixel: u64, i: u32) -> Vec2 {
        let [x, y] = self.points::<f32>(pixel as u32, (pixel >> 32) as u32, i);
        Vec2::new(x, y)
    }

    /// [`point`](Self::point) `i` of one pixel or of a pixel per lane, whose numbers
    /// have these lower and upper halves.
    #[inline(always)]
    pub fn points<R: Real>(&self, low: R::Integer, high: u32, i: u32) -> [R; 2] {
        let zero = R::from_integer(low.splat(0));
        if i == self.center {
            return [zero; 2];
        }
        let row = self.row_of(i);
        let (first, end) = (self.first_of_row(row), self.first_of_row(row + 1));
        let mixed = match high {
            0 => self.mixed,
            _ => mixed([(self.seed >> 32) as u32, high, 0]),
        };
        let words = hash([low.splat(self.seed as u32), low, low.splat(i)], mixed);
        let (u, v) = (unit::<R>(words[0]), unit::<R>(words[1]));
        // The height of a row is proportional to its points: all strata have the
        // same area.
        let n_in_row = zero.splat((end - first) as f32);
        let x = (zero.splat((i - first) as f32) + u) / n_in_row;
        let y = (zero.splat(first as f32) + v * n_in_row) / zero.splat(self.n as f32);
        let half = zero.splat(0.5);
        [x - half, y - half]
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
