//! The Mann-Whitney U test, and the distribution of the rank sum.
//!
//! H. B. Mann, D. R. Whitney: On a test of whether one of two random variables is stochastically
//! larger than the other, Annals of Mathematical Statistics 18 (1947). Ties take the mean of their
//! ranks. The exact distribution is the permutation distribution of these ranks, by the shift
//! algorithm of B. Streitberg, J. Röhmel: Exact distributions for permutation and rank tests,
//! Statistical Software Newsletter 12 (1986).

use std::f64::consts::SQRT_2;

/// Maximum size of both samples together for the exact distribution. Above it the normal
/// approximation is accurate enough: 0.0113 instead of 0.0109.
const MAX_EXACT: usize = 100;

/// Returns the p-value of the two-sided Mann-Whitney U test: the probability that two samples of
/// the same distribution differ at least as much as these. Exact up to 100 values in total, ties
/// included; above that by the normal approximation with corrections for ties and continuity.
///
/// Returns 1 if a sample is empty. The values must not be NaN.
pub fn mann_whitney_p(a: &[f64], b: &[f64]) -> f64 {
    let ranks = doubled_ranks(a, b);
    let sum_b = ranks[a.len()..].iter().sum();
    let rank_sums = RankSums::from_ranks(&ranks, b.len());
    let tails = [rank_sums.at_most(sum_b), rank_sums.at_least(sum_b)];
    (2.0 * tails[0].min(tails[1])).min(1.0)
}

/// Returns twice the rank, from 1, of each value of `a`, then of `b`, among all values: integers,
/// since equal values share the mean of their ranks.
pub(super) fn doubled_ranks(a: &[f64], b: &[f64]) -> Vec<usize> {
    let values = [a, b].concat();
    let mut sorted = values.clone();
    sorted.sort_by(f64::total_cmp);
    let rank = |value: &f64| {
        let n_below = sorted.partition_point(|other| other < value);
        let n_up_to = sorted.partition_point(|other| other <= value);
        n_below + 1 + n_up_to
    };
    values.iter().map(rank).collect()
}

/// The distribution of twice the sum of `n` ranks, where all choices of `n` ranks are equally
/// probable.
pub(super) enum RankSums {
    /// The probability of each sum from 0.
    Exact(Vec<f64>),
    /// Mean and standard deviation.
    Normal(f64, f64),
}

impl RankSums {
    /// Creates the distribution for `n` of the `doubled` ranks.
    pub(super) fn from_ranks(doubled: &[usize], n: usize) -> Self {
        match doubled.len() {
            0..=MAX_EXACT => Self::exact(doubled, n),
            _ => Self::normal(doubled, n),
        }
    }

    /// Creates the distribution for `n` of `n_a + n` values without ties.
    pub(super) fn untied(n_a: usize, n: usize) -> Self {
        let doubled: Vec<usize> = (1..=n_a + n).map(|rank| 2 * rank).collect();
        Self::from_ranks(&doubled, n)
    }

    /// Counts the choices of `n` ranks by their sum, rank by rank: choices that include a rank are
    /// choices of one rank fewer, shifted by it.
    fn exact(doubled: &[usize], n: usize) -> Self {
        let n_sums = doubled.iter().sum::<usize>() + 1;
        let mut n_choices = vec![vec![0.0; n_sums]; n + 1];
        n_choices[0][0] = 1.0;
        for &rank in doubled {
            for size in (1..=n).rev() {
                let (smaller, larger) = n_choices.split_at_mut(size);
                let smaller = &smaller[size - 1][..n_sums - rank];
                for (with, without) in larger[0][rank..].iter_mut().zip(smaller) {
                    *with += without;
                }
            }
        }
        let by_sum = n_choices.swap_remove(n);
        let n_all: f64 = by_sum.iter().sum();
        Self::Exact(by_sum.into_iter().map(|count| count / n_all).collect())
    }

    fn normal(doubled: &[usize], n: usize) -> Self {
        let n_all = doubled.len() as f64;
        let mean = doubled.iter().sum::<usize>() as f64 / n_all;
        let deviations = doubled.iter().map(|&rank| (rank as f64 - mean).powi(2));
        let variance = deviations.sum::<f64>() / n_all;
        // Sampling without replacement. The variance of the ranks accounts for ties.
        let n = n as f64;
        let of_sum = n * variance * (n_all - n) / (n_all - 1.0);
        Self::Normal(n * mean, of_sum.sqrt())
    }

    /// Returns the probability of a sum of `sum` or less.
    pub(super) fn at_most(&self, sum: usize) -> f64 {
        match self {
            Self::Exact(probabilities) => probabilities.iter().take(sum + 1).sum(),
            &Self::Normal(mean, deviation) => upper_tail((mean - sum as f64 - 1.0) / deviation),
        }
    }

    /// Returns the probability of a sum of `sum` or more.
    fn at_least(&self, sum: usize) -> f64 {
        match self {
            Self::Exact(probabilities) => probabilities.iter().skip(sum).sum(),
            &Self::Normal(mean, deviation) => upper_tail((sum as f64 - 1.0 - mean) / deviation),
        }
    }
}

/// Returns the probability that a standard normal variable exceeds `z`; 1 for NaN, the result of a
/// standard deviation of 0.
fn upper_tail(z: f64) -> f64 {
    if z.is_nan() {
        return 1.0;
    }
    0.5 * libm::erfc(z / SQRT_2)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The test by its definition: U is the number of pairs in which `b` is greater, ties counting
    /// half, over all permutations of the values.
    fn by_definition(a: &[f64], b: &[f64]) -> f64 {
        let wins = |a: &[f64], b: &[f64]| {
            let pairs = a.iter().flat_map(|x| b.iter().map(move |y| (x, y)));
            let doubled = |(x, y): (&f64, &f64)| 2 * u64::from(y > x) + u64::from(y == x);
            pairs.map(doubled).sum::<u64>()
        };
        let all = [a, b].concat();
        let mut tails = [0.0; 2];
        let mut n = 0.0;
        for dealt in 0_u32..1 << all.len() {
            if dealt.count_ones() as usize != b.len() {
                continue;
            }
            let of = |side: bool| -> Vec<f64> {
                let goes = |i: usize| (dealt >> i & 1 == 1) == side;
                let chosen = (0..all.len()).filter(|&i| goes(i));
                chosen.map(|i| all[i]).collect()
            };
            let (found, dealt) = (wins(a, b), wins(&of(false), &of(true)));
            tails[0] += f64::from(dealt <= found);
            tails[1] += f64::from(dealt >= found);
            n += 1.0;
        }
        (2.0 * tails[0].min(tails[1]) / n).min(1.0)
    }

    /// The results of SciPy's `mannwhitneyu`: exact, then approximate.
    #[test]
    fn known_samples_have_scipys_p() {
        let rising = |n: u32, step: u32, from: f64| -> Vec<f64> {
            (0..n).map(|i| from + f64::from(i * step)).collect()
        };
        let cycling = |n: u32, step: u32, cycle: u32, from: u32| -> Vec<f64> {
            (0..n).map(|i| f64::from(i * step % cycle + from)).collect()
        };
        let first = [
            10.35, 10.82, 10.33, 8.7, 10.91, 10.45, 9.46, 10.58, 10.36, 10.29,
        ];
        let second = [
            10.93, 11.45, 10.16, 10.74, 10.42, 11.5, 10.94, 10.61, 10.12, 10.64,
        ];
        let known: [(&[f64], &[f64], f64); 4] = [
            (
                &[19.0, 22.0, 16.0, 29.0, 24.0],
                &[20.0, 11.0, 17.0, 12.0],
                1.0 / 9.0,
            ),
            (&first, &second, 0.07525601333650869),
            (
                &cycling(60, 1, 7, 0),
                &cycling(50, 3, 8, 1),
                0.0010406347107746578,
            ),
            (
                &rising(60, 2, 0.0),
                &rising(60, 2, 16.0),
                0.018825021444696544,
            ),
        ];
        for (a, b, expected) in known {
            let p = mann_whitney_p(a, b);
            assert!(
                (p / expected - 1.0).abs() < 1e-9,
                "{p} instead of {expected}"
            );
        }
    }

    #[test]
    fn equal_samples_have_p_1() {
        assert_eq!(mann_whitney_p(&[], &[1.0]), 1.0);
        assert_eq!(mann_whitney_p(&[3.0; 9], &[3.0; 9]), 1.0);
        assert_eq!(mann_whitney_p(&[3.0; 90], &[3.0; 90]), 1.0);
    }

    proptest! {
        #[test]
        fn p_is_that_of_all_permutations(
            a in prop::collection::vec(0_u8..6, 0..6),
            b in prop::collection::vec(0_u8..6, 0..6),
        ) {
            let [a, b] = [a, b].map(|sample| sample.into_iter().map(f64::from).collect::<Vec<_>>());
            let (p, expected) = (mann_whitney_p(&a, &b), by_definition(&a, &b));
            prop_assert!((p - expected).abs() < 1e-12, "{p} instead of {expected}");
        }

        #[test]
        fn the_order_of_the_samples_and_of_their_values_does_not_matter(
            a in prop::collection::vec(0_u8..30, 1..20),
            b in prop::collection::vec(0_u8..30, 1..20),
        ) {
            let [a, b] = [a, b].map(|sample| sample.into_iter().map(f64::from).collect::<Vec<_>>());
            let p = mann_whitney_p(&a, &b);
            prop_assert!((mann_whitney_p(&b, &a) - p).abs() < 1e-12);
            let [mut a, mut b] = [a, b];
            a.reverse();
            b.sort_by(f64::total_cmp);
            prop_assert!((mann_whitney_p(&a, &b) - p).abs() < 1e-12);
        }
    }
}
