//! The work that two renderings take for equal noise.

use std::ops::Range;

use serde::Serialize;

use super::Side;
use host::text::Diagnostic;
use tracer::cost::Metric;

/// Groups of pixels, each of which is left out once for the interval.
const N_GROUPS: usize = 32;

/// The 97.5 % quantile of Student's t distribution with 31 degrees of freedom.
const T: f64 = 2.040;

/// The share of A's work for which B has the noise of A: the ratio B / A of variance times work,
/// since variance falls with one over the work. Both are sums over the pixels that both rendered.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EqualNoise {
    /// The share of the work, in node visits and primitive tests.
    pub work: f64,
    /// The 95 % confidence interval, by a jackknife over groups of pixels (B. Efron, The Jackknife,
    /// the Bootstrap and Other Resampling Plans, 1982, section 3).
    pub interval: [f64; 2],
}

impl EqualNoise {
    /// Compares two outputs; `None` unless both have `noise` and counters, and some of it.
    ///
    /// # Errors
    /// The noise cannot be read.
    pub(super) fn measure(sides: &[Side; 2]) -> Result<Option<Self>, Diagnostic> {
        let needed = [Metric::NOISE, Metric::NODE_VISITS, Metric::PRIMITIVE_TESTS];
        let has_all = |side: &Side| needed.iter().all(|metric| side.has(*metric));
        if !sides.iter().all(has_all) {
            return Ok(None);
        }
        let [width, _] = sides[0].size();
        let mut variances = [[0.0; 2]; N_GROUPS];
        let mut work = [0.0; 2];
        for rows in sides[0].bands() {
            let [a, b] = sides.each_ref().map(|side| read_pixels(side, rows.clone()));
            let found = [a?, b?];
            for pixel in 0..found[0].noise.len() {
                if found.iter().any(|side| side.noise[pixel].is_nan()) {
                    // One side did not render the pixel.
                    continue;
                }
                let row = rows.start as usize + pixel / width as usize;
                // No group has whole rows or columns: edges would be in one group.
                let group = (row + 5 * (pixel % width as usize)) % N_GROUPS;
                for (i, side) in found.iter().enumerate() {
                    variances[group][i] += f64::from(side.noise[pixel]).powi(2);
                    work[i] += side.work[pixel];
                }
            }
        }
        Ok(Self::estimate(&variances, work[1] / work[0]))
    }

    /// Returns the share and its interval of sums of A's and B's variances by groups; `work` is the
    /// ratio B / A of the work for all of them.
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

/// Some pixels of a side.
struct SidePixels {
    /// The standard error of each; NaN if it was not rendered.
    noise: Vec<f32>,
    /// The node visits and primitive tests of each.
    work: Vec<f64>,
}

/// Reads the pixels of a side in `rows`.
fn read_pixels(side: &Side, rows: Range<u32>) -> Result<SidePixels, Diagnostic> {
    let mut work = side.costs(Metric::NODE_VISITS, rows.clone())?;
    let tests = side.costs(Metric::PRIMITIVE_TESTS, rows.clone())?;
    work.iter_mut().zip(tests).for_each(|(sum, n)| *sum += n);
    let noise = side.noise(rows)?;
    Ok(SidePixels { noise, work })
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
