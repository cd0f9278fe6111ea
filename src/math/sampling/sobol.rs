//! Sobol' points with Owen's scrambling, by hashing.
//!
//! After Burley, "Practical Hash-based Owen Scrambling", JCGT 10(4), 2020. Only the first two
//! dimensions of Sobol's sequence are used: as a (0, 2)-sequence, any `2^k` of its points from a
//! multiple of `2^k` on have one point in each elementary interval of area `2^-k`. Further
//! dimensions are the same two, reordered and scrambled differently, which keeps that property.

use crate::simd::Integer;

/// Returns point `index` of the sequence, scrambled with these seeds: 32 binary digits of each
/// coordinate, for one index or one per lane.
#[inline(always)]
pub(super) fn point<N: Integer>(index: N, seeds: [N; 2]) -> [N; 2] {
    let [x, y] = reversed_point(index);
    let [seed_x, seed_y] = seeds;
    [
        scrambled(x, seed_x).reverse_bits(),
        scrambled(y, seed_y).reverse_bits(),
    ]
}

/// Returns [`point`] with a digital shift, which keeps all elementary intervals and moves both
/// coordinates of point 0 to one half.
#[inline(always)]
pub(super) fn centered_point<N: Integer>(index: N, seeds: [N; 2]) -> [N; 2] {
    let zero = index.splat(0);
    let half = index.splat(1 << 31);
    let [x, y] = point(index, seeds);
    let [zero_x, zero_y] = point(zero, seeds);
    [x.xor(zero_x).xor(half), y.xor(zero_y).xor(half)]
}

/// Permutes the sequence by a seed: returns the index at this position. The first `2^k` positions
/// have `2^k` consecutive indices from a multiple of `2^k`.
#[inline(always)]
pub(super) fn shuffled<N: Integer>(position: N, seed: N) -> N {
    scrambled(position.reverse_bits(), seed).reverse_bits()
}

/// Returns the coordinates of a point with their binary digits in reverse order. The first
/// coordinate is the index: van der Corput's sequence. The generator matrix of the second one is
/// Pascal's triangle modulo 2, the product of five sparse matrices.
#[inline(always)]
fn reversed_point<N: Integer>(index: N) -> [N; 2] {
    let y = fold_half::<N, 16>(index, 0x0000_ffff);
    let y = fold_half::<N, 8>(y, 0x00ff_00ff);
    let y = fold_half::<N, 4>(y, 0x0f0f_0f0f);
    let y = fold_half::<N, 2>(y, 0x3333_3333);
    let y = fold_half::<N, 1>(y, 0x5555_5555);
    [index, y]
}

/// XORs into the digits of the mask the digits `SHIFT` above them.
#[inline(always)]
fn fold_half<N: Integer, const SHIFT: i32>(word: N, mask: u32) -> N {
    word.xor(word.shift_right::<SHIFT>().and(word.splat(mask)))
}

/// Scrambles digits in reverse order: each flips depending on the digits before it and on the seed.
/// The hash is Laine and Karras' with the constants of Vegdahl, "Building a Better LK Hash", 2021.
#[inline(always)]
fn scrambled<N: Integer>(reversed: N, seed: N) -> N {
    // Odd, so that no digit is lost.
    let odd_factor = seed
        .shift_right::<17>()
        .shift_left::<1>()
        .plus(seed.splat(1));
    let word = multiplied(reversed, 0x3d20_adea)
        .plus(seed)
        .times(odd_factor);
    multiplied(multiplied(word, 0x0552_6c56), 0x53a2_2864)
}

/// XORs a word with a multiple of itself.
#[inline(always)]
fn multiplied<N: Integer>(word: N, factor: u32) -> N {
    word.xor(word.times(word.splat(factor)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash::hash;

    /// The reference: direction numbers by the recurrence of the polynomial x + 1.
    fn by_direction_numbers(index: u32) -> [u32; 2] {
        let mut numbers = vec![1_u32 << 31];
        for i in 1..32 {
            let before = numbers[i - 1];
            numbers.push(before ^ (before >> 1));
        }
        let mut second = 0;
        for (i, number) in numbers.into_iter().enumerate() {
            second ^= number * (index >> i & 1);
        }
        [index.reverse_bits(), second]
    }

    #[test]
    fn the_points_are_those_of_the_direction_numbers() {
        for index in (0..1000).chain((0..32).map(|bit| 1 << bit)) {
            let found = reversed_point(index).map(u32::reverse_bits);
            assert_eq!(found, by_direction_numbers(index), "{index}");
        }
    }

    /// Checks that each elementary interval has exactly one of these `2^k` points.
    fn check_intervals(points: &[[u32; 2]]) {
        let k = points.len().ilog2();
        for k_x in 0..=k {
            let top = |word: u32, bits| word.checked_shr(32 - bits).unwrap_or(0);
            let interval = |[x, y]: &[u32; 2]| top(*x, k_x) << (k - k_x) | top(*y, k - k_x);
            let mut found: Vec<u32> = points.iter().map(interval).collect();
            found.sort_unstable();
            assert!(found.into_iter().eq(0..1 << k), "2^-{k_x} x 2^-{}", k - k_x);
        }
    }

    #[test]
    fn every_elementary_interval_has_one_point() {
        for pixel in 0..50_u32 {
            let [a, b, c, _] = hash([pixel, 1, 2], [0; 4]);
            let first = |n: u32| {
                move |point: &dyn Fn(u32) -> [u32; 2]| -> Vec<[u32; 2]> {
                    (0..n).map(point).collect()
                }
            };
            for n in [1, 2, 8, 64, 256] {
                check_intervals(&first(n)(&|i| point(i, [a, b])));
                check_intervals(&first(n)(&|i| centered_point(i, [a, b])));
                check_intervals(&first(n)(&|i| point(shuffled(i, c), [a, b])));
                // Later samples of the same pixel.
                check_intervals(&first(n)(&|i| point(5 * n + i, [a, b])));
            }
            assert_eq!(centered_point(0, [a, b]), [1 << 31; 2]);
        }
    }

    /// Means and correlations over pixels: scrambled points are uniform and independent.
    #[test]
    fn points_of_pixels_and_dimensions_are_independent() {
        let unit = |word: u32| f64::from(word) / 2_f64.powi(32) - 0.5;
        let n = 4000;
        let of_pixel = |pixel: u32, i: u32| {
            let [a, b, c, _] = hash([pixel, 7, 0], [0; 4]);
            let [d, e, f, _] = hash([pixel, 7, 1], [0; 4]);
            let one = point(shuffled(i, c), [a, b]);
            let two = point(shuffled(i, f), [d, e]);
            [one[0], one[1], two[0], two[1]].map(unit)
        };
        for i in 0..8 {
            let samples: Vec<[f64; 4]> = (0..n).map(|pixel| of_pixel(pixel, i)).collect();
            let next: Vec<[f64; 4]> = (0..n).map(|pixel| of_pixel(pixel + 1, i)).collect();
            let mean =
                |f: &dyn Fn(usize) -> f64| (0..samples.len()).map(f).sum::<f64>() / f64::from(n);
            // Five standard deviations of the mean of uniform numbers and of products.
            let (of_mean, of_product) = (
                5.0 / (12.0 * f64::from(n)).sqrt(),
                5.0 / (144.0 * f64::from(n)).sqrt(),
            );
            for a in 0..4 {
                assert!(mean(&|k| samples[k][a]).abs() < of_mean, "mean {i} {a}");
                for b in 0..4 {
                    let with_next = mean(&|k| samples[k][a] * next[k][b]);
                    assert!(with_next.abs() < of_product, "{i} {a} {b}: {with_next}");
                    let inside = mean(&|k| samples[k][a] * samples[k][b]);
                    assert!(a == b || inside.abs() < of_product, "{i} {a} {b}: {inside}");
                }
            }
        }
    }
}
