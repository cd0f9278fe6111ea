//! A test for a significant change of the time.

use serde::Serialize;

use math::statistics::{CONFIDENCE, Ratio, mann_whitney_p};

/// The result of the test.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Noise {
    /// A run was not repeated.
    Unknown,
    /// The repeats measured other pixels than those that are compared.
    Cut,
    /// There are so few repeats that no difference would be significant.
    TooFew(Test),
    /// The difference is not significant.
    WithinNoise(Test),
    /// B is significantly slower.
    Slower(Test),
    /// B is significantly faster.
    Faster(Test),
}

/// A comparison of the repeats by their times, each the sum over all pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Test {
    /// The numbers of repeats of A and B.
    pub n: [usize; 2],
    /// The p-value of the two-sided Mann-Whitney U test.
    pub p: f64,
    /// The ratio of the times B / A.
    pub ratio: Ratio,
}

impl Test {
    /// Formats the p-value, such as `p = 0.03`.
    pub(super) fn p_label(&self) -> String {
        match self.p {
            p if p < 1e-4 => "p < 0.0001".to_owned(),
            p if p < 0.01 => format!("p = {p:.4}"),
            p => format!("p = {p:.2}"),
        }
    }
}

impl Noise {
    /// Compares the times of the repeats, which are positive; a run that was not repeated has at
    /// most one time.
    pub fn test_times(a: &[f64], b: &[f64]) -> Self {
        let Some(ratio) = Ratio::estimate(a, b).filter(|_| a.len().min(b.len()) > 1) else {
            return Self::Unknown;
        };
        let test = Test {
            n: [a.len(), b.len()],
            p: mann_whitney_p(a, b),
            ratio,
        };
        match ratio.interval {
            None => Self::TooFew(test),
            Some(_) if test.p > 1.0 - CONFIDENCE => Self::WithinNoise(test),
            Some(_) if ratio.estimate > 1.0 => Self::Slower(test),
            Some(_) => Self::Faster(test),
        }
    }

    /// Returns the comparison; `None` for [`Self::Unknown`] and [`Self::Cut`].
    pub fn test(&self) -> Option<&Test> {
        match self {
            Self::Unknown | Self::Cut => None,
            Self::TooFew(test)
            | Self::WithinNoise(test)
            | Self::Slower(test)
            | Self::Faster(test) => Some(test),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns times around `center` with noise of 1 %.
    fn times(center: f64, n: usize) -> Vec<f64> {
        let noise = |i: usize| 1.0 + 0.01 * ((i * 7 % 10) as f64 / 4.5 - 1.0);
        (0..n).map(|i| center * noise(i)).collect()
    }

    #[test]
    fn a_significant_change_is_found() {
        let base = times(1e9, 10);
        assert!(matches!(
            Noise::test_times(&base, &times(1.002e9, 10)),
            Noise::WithinNoise(_)
        ));
        assert!(matches!(
            Noise::test_times(&base, &times(1.05e9, 10)),
            Noise::Slower(_)
        ));
        assert!(matches!(
            Noise::test_times(&base, &times(0.95e9, 10)),
            Noise::Faster(_)
        ));
    }

    #[test]
    fn too_few_repeats_give_no_verdict() {
        let base = times(1e9, 10);
        assert_eq!(Noise::test_times(&base, &[]), Noise::Unknown);
        assert_eq!(Noise::test_times(&base, &[2e9]), Noise::Unknown);
        let few = Noise::test_times(&times(1e9, 3), &times(2e9, 3));
        assert!(matches!(few, Noise::TooFew(_)), "{few:?}");
    }
}
