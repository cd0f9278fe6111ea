//! Cost laws: a fixed cost plus a power law.
//!
//! A plain power law, fitted as a straight line on two logarithmic axes, mistakes the fixed cost of
//! every run for a smaller exponent: brute force over the number of objects would seem to grow
//! slower than linearly.
//!
//! The fit is weighted least squares by variable projection (Golub and Pereyra, SIAM Journal on
//! Numerical Analysis 10, 1973): for each exponent the best fixed cost and factor, both at least 0,
//! have a closed form. Only the exponent is left to search for, and a scan of its whole range
//! cannot end in a local minimum. The confidence interval of the exponent comes from the profile
//! likelihood (Bates and Watts, "Nonlinear Regression Analysis", 1988, section 6.1).

use std::fmt;

use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

use output::chart::rounded_number;

/// Range of the exponents.
const EXPONENTS: [f64; 2] = [-4.0, 4.0];
/// Number of steps of the scan over the exponents.
const N_STEPS: u32 = 800;
/// Minimum relative standard error of a median: points differ by more than the noise of repeats,
/// for example where the data exceed a cache.
const MIN_ERROR: f64 = 0.005;
/// Probability that the interval of the exponent covers the true one.
const CONFIDENCE: f64 = 0.95;

/// `y = factor * x^exponent`: a straight line on two logarithmic axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PowerLaw {
    /// `y` at `x = 1`.
    pub factor: f64,
    /// The slope on logarithmic axes.
    pub exponent: f64,
}

impl PowerLaw {
    /// Evaluates `y` at `x`.
    pub fn at(&self, x: f64) -> f64 {
        self.factor * x.powf(self.exponent)
    }
}

/// `cost = fixed + factor * n^exponent`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CostLaw {
    /// The cost at size 0, at least 0.
    pub fixed: f64,
    /// The power law; its factor is at least 0.
    #[serde(flatten)]
    pub growing: PowerLaw,
    /// Root mean square of the samples' relative distances from the law.
    pub residual: f64,
    /// The 95 % confidence interval of the exponent, within -4 and 4; `None` for two sizes, which
    /// the law fits exactly without a fixed cost.
    pub exponent_95: Option<[f64; 2]>,
}

/// Formats `0.12 + 3.4e-5 x^1.02, with 0.98 to 1.06 for the exponent`.
impl fmt::Display for CostLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PowerLaw { factor, exponent } = self.growing;
        let [fixed, factor] = [self.fixed, factor].map(rounded_number);
        write!(f, "{fixed} + {factor} x^{exponent:.3}")?;
        match self.exponent_95 {
            Some([low, high]) => write!(f, ", 95 % interval of the exponent {low:.2} to {high:.2}"),
            None => Ok(()),
        }
    }
}

/// A measured cost to fit a law to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CostSample {
    /// The size.
    pub n: f64,
    /// The cost: a median.
    pub cost: f64,
    /// The ends of its confidence interval or, for a few runs, of their range.
    pub interval: [f64; 2],
    /// The probability that the interval covers the true cost; 0 for one run.
    pub coverage: f64,
}

impl CostLaw {
    /// Fits the law to samples whose sizes and costs are greater than 0; `None` for fewer than two
    /// different sizes.
    pub fn fit(samples: &[CostSample]) -> Option<Self> {
        let law = match distinct_sizes(samples).len() {
            0 | 1 => return None,
            2 => straight_line(samples),
            n_sizes => ExponentSearch::new(samples).solve(n_sizes),
        };
        Some(Self {
            residual: relative_residual(samples, |n| law.at(n)),
            ..law
        })
    }

    /// Evaluates the cost at size `n`.
    pub fn at(&self, n: f64) -> f64 {
        self.fixed + self.growing.at(n)
    }
}

/// Returns the sizes of samples in ascending order, each once.
pub(super) fn distinct_sizes(samples: &[CostSample]) -> Vec<f64> {
    let mut sizes: Vec<f64> = samples.iter().map(|sample| sample.n).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.dedup();
    sizes
}

/// Returns the power law through samples of two sizes: a straight line on logarithmic axes.
fn straight_line(samples: &[CostSample]) -> CostLaw {
    let n = samples.len() as f64;
    let logs = || {
        samples
            .iter()
            .map(|sample| (sample.n.ln(), sample.cost.ln()))
    };
    let mean_x = logs().map(|(x, _)| x).sum::<f64>() / n;
    let mean_y = logs().map(|(_, y)| y).sum::<f64>() / n;
    let xx: f64 = logs().map(|(x, _)| (x - mean_x).powi(2)).sum();
    let xy: f64 = logs().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let exponent = xy / xx;
    CostLaw {
        fixed: 0.0,
        growing: PowerLaw {
            factor: (mean_y - exponent * mean_x).exp(),
            exponent,
        },
        residual: 0.0,
        exponent_95: None,
    }
}

/// The search for the best exponent.
struct ExponentSearch {
    samples: Vec<WeightedSample>,
    /// The geometric mean of the sizes. Powers of sizes relative to it neither overflow nor
    /// underflow.
    scale: f64,
}

/// A sample with its standard error.
pub(super) struct WeightedSample {
    /// In an [`ExponentSearch`], relative to its scale.
    size: f64,
    cost: f64,
    /// Standard error of the cost.
    error: f64,
}

/// The best law for one exponent.
#[derive(Clone, Copy)]
struct Fit {
    exponent: f64,
    fixed: f64,
    factor: f64,
    /// The sum of squared residuals in units of the standard errors.
    chi_squared: f64,
}

impl ExponentSearch {
    fn new(samples: &[CostSample]) -> Self {
        let n = samples.len() as f64;
        let scale = (samples.iter().map(|sample| sample.n.ln()).sum::<f64>() / n).exp();
        let mut samples = weighted(samples);
        for sample in &mut samples {
            sample.size /= scale;
        }
        Self { samples, scale }
    }

    /// Returns the best law and the confidence interval of its exponent.
    fn solve(&self, n_sizes: usize) -> CostLaw {
        let [least, most] = EXPONENTS;
        let step = (most - least) / f64::from(N_STEPS);
        let scan = (0..=N_STEPS).map(|i| self.fit(least + step * f64::from(i)));
        let scan: Vec<Fit> = scan.collect();
        // Among equal fits prefer 0: a constant cost does not grow.
        let best = scan.iter().copied().fold(self.fit(0.0), better);
        let around = [best.exponent - step, best.exponent + step];
        let best = better(best, self.refine(around.map(|end| end.clamp(least, most))));
        let allowed = best.chi_squared + self.tolerance(best.chi_squared, n_sizes);
        let is_in = |fitted: &&Fit| fitted.chi_squared <= allowed;
        let ends = [scan.iter().find(is_in), scan.iter().rev().find(is_in)];
        let outward = [-step, step];
        let interval = [0, 1].map(|end| {
            let inside = ends[end].map_or(best.exponent, |fitted| fitted.exponent);
            self.crossing([inside, inside + outward[end]], allowed)
        });
        CostLaw {
            fixed: best.fixed,
            growing: PowerLaw {
                factor: best.factor * self.scale.powf(-best.exponent),
                exponent: best.exponent,
            },
            residual: 0.0,
            exponent_95: Some([
                interval[0].min(best.exponent),
                interval[1].max(best.exponent),
            ]),
        }
    }

    /// Returns the best law for an exponent.
    fn fit(&self, exponent: f64) -> Fit {
        let parts = linear_fit(&self.samples, |size| size.powf(exponent));
        self.law(exponent, parts)
    }

    /// Returns the law with these parameters and its residuals.
    fn law(&self, exponent: f64, [fixed, factor]: [f64; 2]) -> Fit {
        let residual = |sample: &WeightedSample| {
            let cost = fixed + factor * sample.size.powf(exponent);
            (sample.cost - cost) / sample.error
        };
        let squares = self.samples.iter().map(|sample| residual(sample).powi(2));
        Fit {
            exponent,
            fixed,
            factor,
            chi_squared: squares.sum(),
        }
    }

    /// Returns the best fit between two exponents, by golden-section search.
    fn refine(&self, [mut low, mut high]: [f64; 2]) -> Fit {
        let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
        for _ in 0..60 {
            let length = golden * (high - low);
            let [left, right] = [high - length, low + length].map(|exponent| self.fit(exponent));
            if left.chi_squared <= right.chi_squared {
                high = right.exponent;
            } else {
                low = left.exponent;
            }
        }
        self.fit((low + high) / 2.0)
    }

    /// Returns how much the sum of squares may exceed its minimum within the confidence interval:
    /// by the standard errors or, where the samples are farther from the law than these explain, by
    /// the residuals. To take the greater of both would cover the exponent too often.
    fn tolerance(&self, chi_squared: f64, n_sizes: usize) -> f64 {
        // Of the fixed cost, the factor and the exponent there are three.
        let degrees = (n_sizes - 3) as f64;
        let of_residuals = ChiSquared::new(degrees).ok();
        let explained = |chi: ChiSquared| chi_squared <= chi.inverse_cdf(CONFIDENCE);
        match StudentsT::new(0.0, 1.0, degrees) {
            Ok(student) if !of_residuals.is_none_or(explained) => {
                let quantile = student.inverse_cdf(0.5 + 0.5 * CONFIDENCE);
                chi_squared / degrees * quantile.powi(2)
            }
            _ => normal_quantile(CONFIDENCE).powi(2),
        }
    }

    /// Returns the exponent, between one inside and one outside the confidence interval, where the
    /// sum of squares reaches `allowed`; at most the end of the range.
    fn crossing(&self, [mut inside, mut outside]: [f64; 2], allowed: f64) -> f64 {
        let [least, most] = EXPONENTS;
        if outside < least || outside > most {
            return outside.clamp(least, most);
        }
        for _ in 0..40 {
            let middle = (inside + outside) / 2.0;
            if self.fit(middle).chi_squared <= allowed {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        inside
    }
}

/// Returns the fit with the smaller residuals; the first of equals.
fn better(a: Fit, b: Fit) -> Fit {
    if b.chi_squared < a.chi_squared { b } else { a }
}

/// Returns the standard errors from the middle of a normal distribution to either end of the range
/// with this probability.
fn normal_quantile(probability: f64) -> f64 {
    Normal::standard().inverse_cdf(0.5 + 0.5 * probability)
}

/// Returns the samples with their standard errors.
pub(super) fn weighted(samples: &[CostSample]) -> Vec<WeightedSample> {
    let one = |sample: &CostSample| {
        let [low, high] = sample.interval;
        // Not a number for one run.
        let error = (high - low) / (2.0 * normal_quantile(sample.coverage));
        WeightedSample {
            size: sample.n,
            cost: sample.cost,
            error: f64::max(MIN_ERROR * sample.cost, error),
        }
    };
    samples.iter().map(one).collect()
}

/// Returns the fixed cost and the factor, both at least 0, for which `fixed + factor *
/// growth(size)` is nearest to the samples.
pub(super) fn linear_fit(samples: &[WeightedSample], growth: impl Fn(f64) -> f64) -> [f64; 2] {
    // Weighted sums over the samples of products of 1, u = growth(size) and the cost.
    let [mut s1, mut su, mut suu, mut sy, mut suy] = [0.0; 5];
    for sample in samples {
        let weight = sample.error.powi(-2);
        let u = growth(sample.size);
        s1 += weight;
        su += weight * u;
        suu += weight * u * u;
        sy += weight * sample.cost;
        suy += weight * u * sample.cost;
    }
    let determinant = s1 * suu - su * su;
    let both = [
        (suu * sy - su * suy) / determinant,
        (s1 * suy - su * sy) / determinant,
    ];
    // A nearly constant growth cannot be distinguished from the fixed cost.
    if determinant > 1e-12 * s1 * suu && both.iter().all(|part| *part >= 0.0) {
        return both;
    }
    // Each explains this part of the weighted sum of squares.
    let [by_growth, by_fixed] = [suy * suy / suu, sy * sy / s1];
    if by_fixed > by_growth {
        [sy / s1, 0.0]
    } else {
        [0.0, suy / suu]
    }
}

/// Returns the root mean square of the relative distances of samples from a law.
pub(super) fn relative_residual(samples: &[CostSample], law: impl Fn(f64) -> f64) -> f64 {
    let squares = samples
        .iter()
        .map(|sample| (law(sample.n) / sample.cost - 1.0).powi(2));
    (squares.sum::<f64>() / samples.len() as f64).sqrt()
}
