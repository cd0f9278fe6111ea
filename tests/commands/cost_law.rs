//! Fitted cost laws are the true ones: with and without a fixed cost, with noise, and with
//! the minimum number of samples.

use math::sampling::uniform;
use proptest::prelude::*;
use tools::study::{CostLaw, CostSample, SampleStatistics};

/// Samples of `fixed + factor * n^exponent` with relative, approximately normal noise and the
/// confidence interval that repeats would give.
fn samples(law: [f64; 3], sizes: &[f64], noise: f64, seed: u64) -> Vec<CostSample> {
    let [fixed, factor, exponent] = law;
    let sample = |(i, &n): (usize, &f64)| {
        let normal: f32 = (0..3)
            .flat_map(|part| uniform([seed, i as u64, part]))
            .sum();
        let exact = fixed + factor * n.powf(exponent);
        let cost = exact * (1.0 + noise * (f64::from(normal) - 6.0));
        CostSample {
            n,
            cost,
            interval: [cost * (1.0 - 1.96 * noise), cost * (1.0 + 1.96 * noise)],
            coverage: 0.95,
        }
    };
    sizes.iter().enumerate().map(sample).collect()
}

fn law(samples: &[CostSample]) -> CostLaw {
    CostLaw::fit(samples).expect("there are two sizes at least")
}

const DECADES: [f64; 5] = [1e1, 1e2, 1e3, 1e4, 1e5];

proptest! {
    #[test]
    fn an_exact_law_is_found(
        fixed in prop_oneof![Just(0.0), 0.1..100.0_f64],
        factor in 0.01..10.0_f64,
        exponent in 0.3..2.0_f64,
    ) {
        let found = law(&samples([fixed, factor, exponent], &DECADES, 0.0, 0));
        let [low, high] = found.exponent_95.unwrap();
        prop_assert!((found.growing.exponent - exponent).abs() < 1e-3, "{found:?}");
        prop_assert!(low <= exponent && exponent <= high, "{found:?}");
        for n in DECADES {
            let exact = fixed + factor * n.powf(exponent);
            prop_assert!((found.at(n) / exact - 1.0).abs() < 1e-3, "{found:?} at {n}");
        }
    }

    #[test]
    fn units_change_nothing_but_the_factors(
        exponent in 0.3..2.0_f64,
        unit in 1e-6..1e6_f64,
        size in 1e-3..1e3_f64,
        seed in 0..1000_u64,
    ) {
        let here = samples([3.0, 0.1, exponent], &DECADES, 0.02, seed);
        let there: Vec<CostSample> = here
            .iter()
            .map(|of| CostSample {
                n: of.n * size,
                cost: of.cost * unit,
                interval: of.interval.map(|end| end * unit),
                ..*of
            })
            .collect();
        let [here, there] = [law(&here), law(&there)];
        prop_assert!((here.growing.exponent - there.growing.exponent).abs() < 1e-6);
        prop_assert!((here.fixed * unit - there.fixed).abs() <= 1e-6 * there.at(size));
    }

    /// For any samples the exponent is within its interval, and all parameters are finite and
    /// not negative.
    #[test]
    fn any_points_give_a_law(
        costs in prop::collection::vec(1e-3..1e6_f64, 2..9),
        noise in 0.0..0.3_f64,
    ) {
        let sample = |(i, &cost): (usize, &f64)| CostSample {
            n: 10_f64.powi(i as i32),
            cost,
            interval: [cost * (1.0 - noise), cost * (1.0 + noise)],
            coverage: 0.95,
        };
        let points: Vec<CostSample> = costs.iter().enumerate().map(sample).collect();
        let found = law(&points);
        prop_assert!(found.fixed >= 0.0 && found.growing.factor >= 0.0, "{found:?}");
        prop_assert!(points.iter().all(|point| found.at(point.n).is_finite()), "{found:?}");
        if let Some([low, high]) = found.exponent_95 {
            let exponent = found.growing.exponent;
            prop_assert!(low <= exponent && exponent <= high, "{found:?}");
            prop_assert!(-4.0 <= low && high <= 4.0, "{found:?}");
        }
    }
}

/// The case that motivates the fixed cost: a straight line on logarithmic axes gives 0.86.
#[test]
fn a_fixed_cost_is_not_a_smaller_exponent() {
    let found = law(&samples([2.0, 0.02, 1.0], &DECADES[..4], 0.01, 7));
    let [low, high] = found.exponent_95.unwrap();
    assert!((found.growing.exponent - 1.0).abs() < 0.03, "{found:?}");
    assert!(low > 0.9 && high < 1.1, "{found:?}");
    assert!((found.fixed - 2.0).abs() < 0.2, "{found:?}");
}

/// A study of nine runs of each size with noise of 3 %.
fn noisy_study(fixed: f64, sizes: &[f64], seed: u64) -> Vec<CostSample> {
    let sample = |(i, &n): (usize, &f64)| {
        let run = |run: u64| {
            let parts = (0..3).flat_map(|part| uniform([seed, i as u64, 3 * run + part]));
            (fixed + 0.1 * n.powf(0.9)) * (1.0 + 0.03 * (f64::from(parts.sum::<f32>()) - 6.0))
        };
        let runs: Vec<f64> = (0..9).map(run).collect();
        let statistics = SampleStatistics::from_values(&runs).unwrap();
        CostSample {
            n,
            cost: statistics.median,
            interval: statistics.spread(),
            coverage: statistics.coverage(),
        }
    };
    sizes.iter().enumerate().map(sample).collect()
}

/// Over 1000 noisy studies, the interval covers the exponent about as often as it claims, with
/// and without a fixed cost.
#[test]
fn the_interval_covers() {
    for fixed in [0.0, 5.0] {
        for sizes in [&DECADES[..3], &DECADES[..4], &DECADES] {
            let covers = |seed: &u64| {
                let found = law(&noisy_study(fixed, sizes, *seed));
                let [low, high] = found.exponent_95.unwrap();
                low <= 0.9 && 0.9 <= high
            };
            let n_covering = (0..1000).filter(covers).count();
            assert!(
                (930..=975).contains(&n_covering),
                "{n_covering} of 1000: {fixed}, {sizes:?}"
            );
        }
    }
}

#[test]
fn three_points_give_a_wider_interval_than_five() {
    let width = |sizes: &[f64]| {
        let [low, high] = law(&samples([5.0, 0.1, 0.9], sizes, 0.02, 3))
            .exponent_95
            .unwrap();
        high - low
    };
    assert!(width(&DECADES[..3]) > width(&DECADES));
}

#[test]
fn two_sizes_have_a_slope_without_an_interval_and_one_has_none() {
    let found = law(&samples([0.0, 3.0, 0.5], &[1.0, 16.0], 0.0, 0));
    assert!((found.growing.exponent - 0.5).abs() < 1e-12);
    assert_eq!((found.fixed, found.exponent_95), (0.0, None));
    let twice = samples([0.0, 3.0, 0.5], &[2.0, 2.0], 0.0, 0);
    assert_eq!(CostLaw::fit(&twice), None);
    assert_eq!(CostLaw::fit(&[]), None);
}

#[test]
fn a_constant_cost_has_exponent_0() {
    let found = law(&samples([4.0, 0.0, 1.0], &DECADES, 0.0, 0));
    assert!(found.growing.exponent.abs() < 1e-6, "{found:?}");
    assert!((found.at(50.0) - 4.0).abs() < 1e-9, "{found:?}");
    assert_eq!(found.exponent_95, Some([-4.0, 4.0]), "{found:?}");
}

#[test]
fn a_falling_cost_has_a_negative_exponent() {
    let threads = [1.0, 2.0, 4.0, 8.0, 16.0];
    let found = law(&samples([20.0, 80.0, -1.0], &threads, 0.0, 0));
    assert!((found.growing.exponent + 1.0).abs() < 1e-3, "{found:?}");
    assert!((found.fixed - 20.0).abs() < 0.1, "{found:?}");
}
