//! The work that two renderings take for equal noise.

use serde::Serialize;

use super::{Side, Totals};
use host::text::Diagnostic;
use tracer::cost::Metric;

/// Groups of rows, each of which is left out once for the interval.
const N_GROUPS: usize = 32;

/// The 97.5 % quantile of Student's t distribution with 31 degrees of freedom.
const T: f64 = 2.040;

/// The share of A's work for which B has the noise of A: the ratio B / A of variance times work,
/// since variance falls with one over the work.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EqualNoise {
    /// The share of the work, in node visits and primitive tests.
    pub work: f64,
    /// The 95 % confidence interval, by a jackknife over groups of rows (B. Efron, The Jackknife,
    /// the Bootstrap and Other Resampling Plans, 1982, section 3).
    pub interval: [f64; 2],
}

impl EqualNoise {
    /// Compares two outputs; `None` unless both have `noise` and counters, and some of it.
    ///
    /// # Errors
    /// The noise cannot be read.
    pub(super) fn measure(sides: &[Side; 2], totals: &Totals) -> Result<Option<Self>, Diagnostic> {
        let steps = totals.steps();
        if !sides.iter().all(|side| side.has(Metric::NOISE)) || steps.contains(&0.0) {
            return Ok(None);
        }
        let [a, b] = sides;
        let mut sums = [[0.0; 2]; N_GROUPS];
        let width = a.size()[0] as usize;
        for rows in a.bands() {
            let noise = [a.noise(rows.clone())?, b.noise(rows.clone())?];
            for (i, y) in rows.enumerate() {
                let row = |side: usize| &noise[side][i * width..][..width];
                for (&a, &b) in row(0).iter().zip(row(1)) {
                    // Pixels that one side did not render.
                    if !a.is_nan() && !b.is_nan() {
                        let sums = &mut sums[y as usize % N_GROUPS];
                        sums[0] += f64::from(a).powi(2);
                        sums[1] += f64::from(b).powi(2);
                    }
                }
            }
        }
        Ok(Self::estimate(&sums, steps[1] / steps[0]))
    }

    /// Returns the share and its interval of sums of A's and B's variances by groups; `work` is the
    /// ratio B / A of the whole work.
    fn estimate(sums: &[[f64; 2]], work: f64) -> Option<Self> {
        let total = |side: usize| sums.iter().map(|sums| sums[side]).sum::<f64>();
        let [a, b] = [total(0), total(1)];
        let share = work * b / a;
        if !share.is_finite() || share == 0.0 {
            return None;
        }
        // In the logarithm, as of any ratio.
        let without = |sums: &[f64; 2]| (work * (b - sums[1]) / (a - sums[0])).ln();
        let logs: Vec<f64> = sums.iter().map(without).collect();
        let n = logs.len() as f64;
        let mean = logs.iter().sum::<f64>() / n;
        let squares: f64 = logs.iter().map(|log| (log - mean).powi(2)).sum();
        let half = T * ((n - 1.0) / n * squares).sqrt();
        let interval = [-half, half].map(|change| (share.ln() + change).exp());
        (interval.iter().all(|end| end.is_finite())).then_some(Self {
            work: share,
            interval,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_variance_at_twice_the_work_is_the_same_efficiency() {
        let sums = [[2.0, 1.0]; N_GROUPS];
        let found = EqualNoise::estimate(&sums, 2.0).unwrap();
        assert!((found.work - 1.0).abs() < 1e-12);
        assert!(found.interval.iter().all(|end| (end - 1.0).abs() < 1e-12));
    }

    #[test]
    fn intervals_hold_the_share_in_about_95_of_100_cases() {
        // Sums of squares of uniform numbers, with another seed each.
        let mut state = 1_u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 40) as f64 / f64::from(1 << 24)
        };
        let mut square = || (0..20).map(|_| uniform().powi(2)).sum::<f64>();
        let n_held = (0..1000)
            .filter(|_| {
                let sums: Vec<[f64; 2]> = (0..N_GROUPS).map(|_| [square(), square()]).collect();
                let [low, high] = EqualNoise::estimate(&sums, 1.0).unwrap().interval;
                low <= 1.0 && 1.0 <= high
            })
            .count();
        assert!((930..=970).contains(&n_held), "{n_held}");
    }

    #[test]
    fn without_noise_there_is_no_share() {
        assert_eq!(EqualNoise::estimate(&[[0.0, 1.0]; N_GROUPS], 1.0), None);
        assert_eq!(EqualNoise::estimate(&[[1.0, 0.0]; N_GROUPS], 1.0), None);
    }
}
