//! Hashes of integers, for one key or for lanes of keys.

use crate::simd::{Integer, Real};

/// Returns four uniformly distributed numbers in [0, 1) for a key of three integers.
///
/// The hash is pcg4d of Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020,
/// applied to both halves of the key.
#[inline]
pub fn uniform(key: [u64; 3]) -> [f32; 4] {
    let [low, high] = [0, 32].map(|shift| key.map(|word| (word >> shift) as u32));
    uniform_of_halves(high, low)
}

/// Returns the numbers of [`uniform`] for keys of any kind of integer, given their upper and their
/// lower halves.
#[inline]
pub fn uniform_of_halves<R: Real>(upper: [R::Integer; 3], lower: [R::Integer; 3]) -> [R; 4] {
    let zero = upper[0].splat(0);
    let [a, b, c, d] = pcg4d([upper[0], upper[1], upper[2], zero]);
    let [x, y, z] = lower;
    // An f32 in [0, 1) has 24 bits of uniform resolution.
    pcg4d([a.xor(x), b.xor(y), c.xor(z), d]).map(unit)
}

/// Hashes the upper halves of a key.
pub(super) fn mixed([a, b, c]: [u32; 3]) -> [u32; 4] {
    pcg4d([a, b, c, 0])
}

/// Hashes the lower halves of a key, for one key or for lanes of keys.
#[inline(always)]
pub(super) fn hash<N: Integer>([a, b, c]: [N; 3], mixed: [u32; 4]) -> [N; 4] {
    let [mixed_a, mixed_b, mixed_c, mixed_d] = mixed;
    pcg4d([
        a.xor(a.splat(mixed_a)),
        b.xor(a.splat(mixed_b)),
        c.xor(a.splat(mixed_c)),
        a.splat(mixed_d),
    ])
}

/// Returns the number in [0, 1) with the highest 24 bits of a word.
#[inline(always)]
pub(super) fn unit<R: Real>(word: R::Integer) -> R {
    let whole = R::from_integer(word.shift_right::<8>());
    whole * whole.splat(1.0 / (1 << 24) as f32)
}

#[inline(always)]
fn pcg4d<N: Integer>([x, y, z, w]: [N; 4]) -> [N; 4] {
    let (x, y, z, w) = round(congruent(x), congruent(y), congruent(z), congruent(w));
    let (x, y, z, w) = round(folded(x), folded(y), folded(z), folded(w));
    [x, y, z, w]
}

/// Advances a linear congruential generator.
#[inline(always)]
fn congruent<N: Integer>(word: N) -> N {
    let product = word.times(word.splat(1_664_525));
    product.plus(word.splat(1_013_904_223))
}

/// Mixes the upper bits of a word into its lower bits.
#[inline(always)]
fn folded<N: Integer>(word: N) -> N {
    word.xor(word.shift_right::<16>())
}

/// Applies a round of pcg4d.
#[inline(always)]
fn round<N: Integer>(x: N, y: N, z: N, w: N) -> (N, N, N, N) {
    let x = x.plus(y.times(w));
    let y = y.plus(z.times(x));
    let z = z.plus(x.times(y));
    let w = w.plus(y.times(z));
    (x, y, z, w)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_halves_are_the_hash_of_their_key() {
        for i in 0..1000 {
            let key: [u64; 3] = [i << 32 | 7, i * i, !i];
            let [upper, lower] = [32, 0].map(|shift| key.map(|word| (word >> shift) as u32));
            let expected = hash(lower, mixed(upper)).map(unit::<f32>);
            assert_eq!(uniform_of_halves::<f32>(upper, lower), expected);
            assert_eq!(uniform(key), expected);
        }
    }

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
}
