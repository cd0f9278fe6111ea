//! How a cost grows: a fixed part, and a part that grows as a power.
//!
//! A power law alone, fitted as a straight line on two logarithmic axes, takes
//! what every run pays, whatever its size, for a smaller exponent: brute force
//! over the number of objects would seem to grow slower than linearly.
//!
//! The fit is least squares by variable projection (Golub and Pereyra, SIAM
//! Journal on Numerical Analysis 10, 1973): for each exponent the best fixed
//! part and factor, both at least 0, have a closed form, so that one number is
//! left to search for, and a scan of its whole range cannot end in a local
//! minimum. Residuals are relative, as the noise of times is. The interval of
//! the exponent is that of the profile likelihood (Bates and Watts, "Nonlinear
//! Regression Analysis", 1988, section 6.1).

use serde::Serialize;

/// Exponents that are tried: beyond these, nothing grows or falls.
const EXPONENTS: [f64; 2] = [-4.0, 4.0];
/// Steps of the scan over them.
const N_STEPS: u32 = 800;
/// Least relative standard error of a median: points differ by more than the
/// noise that repeats show, by a cache's size, say.
const LEAST_ERROR: f64 = 0.005;
/// The normal distribution's 97.5 % quantile.
const NORMAL: f64 = 1.96;
/// Student's, for 1, 2, … degrees of freedom; above these nearly the normal one.
const STUDENT: [f64; 10] = [
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
];

/// `y = factor * x^exponent`: a straight line on two logarithmic axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PowerLaw {
    /// `y` at 1.
    pub factor: f64,
    /// The slope of the logarithms.
    pub exponent: f64,
}

impl PowerLaw {
    /// Its `y` at `x`.
    pub fn at(&self, x: f64) -> f64 {
        self.factor * x.powf(self.exponent)
    }
}

/// `cost = fixed + factor * n^exponent`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CostLaw {
    /// What is paid at any size, at least 0.
    pub fixed: f64,
    /// What grows; its factor is at least 0.
    #[serde(flatten)]
    pub growing: PowerLaw,
    /// The interval that holds the exponent with 95 % confidence, within -4 and
    /// 4; `None` for two points, through which a law goes without a fixed part.
    pub exponent_95: Option<[f64; 2]>,
}

/// A point that a law is fitted to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The size.
    pub n: f64,
    /// The cost: a median.
    pub cost: f64,
    /// Ends of the interval that holds it with 95 % confidence.
    pub interval: [f64; 2],
}

impl CostLaw {
    /// The law through samples whose sizes and costs are greater than 0; `None`
    /// with fewer than two different sizes.
    pub fn through(samples: &[Sample]) -> Option<Self> {
        let mut sizes: Vec<f64> = samples.iter().map(|sample| sample.n).collect();
        sizes.sort_by(f64::total_cmp);
        sizes.dedup();
        match sizes.len() {
            0 | 1 => None,
            2 => Some(straight(samples)),
            n_sizes => Some(Problem::of(samples).solve(n_sizes)),
        }
    }

    /// Its cost at size `n`.
    pub fn at(&self, n: f64) -> f64 {
        self.fixed + self.growing.at(n)
    }
}

/// The power law through samples of two sizes, by the logarithms.
fn straight(samples: &[Sample]) -> CostLaw {
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
        exponent_95: None,
    }
}

/// What is searched: the best exponent for these points.
struct Problem {
    points: Vec<Weighted>,
    /// The geometric mean of the sizes: powers of sizes relative to it neither
    /// overflow nor vanish.
    scale: f64,
}

struct Weighted {
    /// Over [`Problem::scale`].
    size: f64,
    cost: f64,
    /// Standard error of the cost.
    error: f64,
}

/// The best law of one exponent.
#[derive(Clone, Copy)]
struct Fitted {
    exponent: f64,
    fixed: f64,
    factor: f64,
    /// The sum of the squared residuals in units of their errors.
    chi_squared: f64,
}

impl Problem {
    fn of(samples: &[Sample]) -> Self {
        let n = samples.len() as f64;
        let scale = (samples.iter().map(|sample| sample.n.ln()).sum::<f64>() / n).exp();
        let weighted = |sample: &Sample| {
            let [low, high] = sample.interval;
            let error = (high - low) / (2.0 * NORMAL);
            Weighted {
                size: sample.n / scale,
                cost: sample.cost,
                error: error.max(LEAST_ERROR * sample.cost),
            }
        };
        Self {
            points: samples.iter().map(weighted).collect(),
            scale,
        }
    }

    fn solve(&self, n_sizes: usize) -> CostLaw {
        let [least, most] = EXPONENTS;
        let step = (most - least) / f64::from(N_STEPS);
        let scan = (0..=N_STEPS).map(|i| self.fit(least + step * f64::from(i)));
        let scan: Vec<Fitted> = scan.collect();
        // What is constant does not grow: 0 is the best of equals.
        let best = scan.iter().copied().fold(self.fit(0.0), better);
        let around = [best.exponent - step, best.exponent + step];
        let best = better(best, self.refine(around.map(|end| end.clamp(least, most))));
        let allowed = best.chi_squared + self.allowance(best.chi_squared, n_sizes);
        let is_in = |fitted: &&Fitted| fitted.chi_squared <= allowed;
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
            exponent_95: Some([
                interval[0].min(best.exponent),
                interval[1].max(best.exponent),
            ]),
        }
    }

    /// The best fixed part and factor of an exponent. Where one of them would
    /// be below 0, the other one alone is the best.
    fn fit(&self, exponent: f64) -> Fitted {
        // Sums over the points of products of 1, u = size^exponent and the cost.
        let [mut s1, mut su, mut suu, mut sy, mut suy] = [0.0; 5];
        for point in &self.points {
            let weight = point.error.powi(-2);
            let u = point.size.powf(exponent);
            s1 += weight;
            su += weight * u;
            suu += weight * u * u;
            sy += weight * point.cost;
            suy += weight * u * point.cost;
        }
        let determinant = s1 * suu - su * su;
        let both = [
            (suu * sy - su * suy) / determinant,
            (s1 * suy - su * sy) / determinant,
        ];
        // Nearly constant powers cannot be told from the fixed part.
        if determinant > 1e-12 * s1 * suu && both.iter().all(|part| *part >= 0.0) {
            return self.fitted(exponent, both);
        }
        let alone = [[0.0, suy / suu], [sy / s1, 0.0]];
        let [growing, fixed] = alone.map(|parts| self.fitted(exponent, parts));
        better(growing, fixed)
    }

    fn fitted(&self, exponent: f64, [fixed, factor]: [f64; 2]) -> Fitted {
        let residual = |point: &Weighted| {
            let cost = fixed + factor * point.size.powf(exponent);
            (point.cost - cost) / point.error
        };
        let squares = self.points.iter().map(|point| residual(point).powi(2));
        Fitted {
            exponent,
            fixed,
            factor,
            chi_squared: squares.sum(),
        }
    }

    /// The best exponent between two, by golden sections.
    fn refine(&self, [mut low, mut high]: [f64; 2]) -> Fitted {
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

    /// By how much the sum of squares may grow within the interval: as the
    /// errors say or, where the points are farther from the law than these
    /// explain, as the residuals do.
    fn allowance(&self, chi_squared: f64, n_sizes: usize) -> f64 {
        let by_errors = NORMAL.powi(2);
        let Some(degrees) = n_sizes.checked_sub(4) else {
            return by_errors;
        };
        let student = STUDENT.get(degrees).copied().unwrap_or(NORMAL + 0.2);
        by_errors.max(chi_squared / (degrees + 1) as f64 * student.powi(2))
    }

    /// Where the sum of squares passes `allowed` between an exponent inside and
    /// one outside the interval; the end of the range where that lies beyond.
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

/// The one that is nearer to the points; the first of equals.
fn better(a: Fitted, b: Fitted) -> Fitted {
    if b.chi_squared < a.chi_squared { b } else { a }
}
