//! The gate of `--fail-above`: tests if B costs more than the limit allows.

use serde::Serialize;

use super::noise::Noise;
use super::{Diff, ratio};
use host::text::Diagnostic;

/// The greatest increase of the cost that passes, in percent of A's cost; at least 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit(f64);

/// The verdict of the gate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gate {
    /// The greatest increase that passes, in percent of A's cost.
    pub limit_percent: f64,
    /// The compared metric: `time`, or `node visits + primitive tests`.
    #[serde(rename = "measure")]
    pub metric: &'static str,
    /// The ratio B / A.
    pub ratio: f64,
    /// The lower bound of the ratio: for a time the lower end of its confidence interval, for
    /// counters the ratio itself.
    pub at_least: f64,
    /// True if B passes.
    pub passed: bool,
}

impl std::str::FromStr for Limit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = text
            .strip_suffix('%')
            .and_then(|number| number.trim().parse().ok());
        match number {
            Some(percent) if (0.0..=1e6).contains(&percent) => Ok(Self(percent)),
            _ => Err("expected a percentage of at least 0, such as `5%`".to_owned()),
        }
    }
}

impl Limit {
    /// Returns true if the ratio B / A passes.
    pub(crate) fn allows(self, ratio: f64) -> bool {
        ratio <= 1.0 + self.0 / 100.0
    }
}

impl Gate {
    /// Compares the whole cost with the limit. A time fails if its confidence interval lies above
    /// the limit: noise fails at most one of forty comparisons. Counters are exact.
    ///
    /// # Errors
    /// If the times have too few repeats for a confidence interval.
    pub fn new(diff: &Diff, limit: Limit) -> Result<Self, Diagnostic> {
        let (metric, ratio, at_least) = match &diff.noise {
            None => {
                let ratio = ratio(diff.totals.steps());
                ("node visits + primitive tests", ratio, ratio)
            }
            Some(noise) => {
                let (ratio, at_least) = time_ratio(noise)?;
                ("time", ratio, at_least)
            }
        };
        Ok(Self {
            limit_percent: limit.0,
            metric,
            ratio,
            at_least,
            passed: limit.allows(at_least),
        })
    }

    /// Returns the verdict as a sentence.
    pub fn sentence(&self) -> String {
        let metric = self.metric;
        let [change, at_least] =
            [self.ratio, self.at_least].map(|ratio| format!("{:+.1} %", added_percent(ratio)));
        let limit = format!("{} %", self.limit_percent);
        let least = if at_least == change {
            String::new()
        } else {
            format!(", {at_least} at least")
        };
        if !self.passed {
            format!("B costs too much: {change} of {metric}{least}; {limit} may be added")
        } else if Limit(self.limit_percent).allows(self.ratio) {
            format!("passed: {change} of {metric}; {limit} may be added")
        } else {
            format!("passed, though not clearly: {change} of {metric}{least}; {limit} may be added")
        }
    }
}

/// Returns the increase of a ratio in percent: 5 for 1.05.
fn added_percent(ratio: f64) -> f64 {
    100.0 * (ratio - 1.0)
}

/// Returns the estimate of the ratio of the times and the lower end of its confidence interval.
fn time_ratio(noise: &Noise) -> Result<(f64, f64), Diagnostic> {
    let found = noise
        .test()
        .and_then(|test| Some((test.ratio.estimate, test.ratio.interval?[0])));
    found.ok_or_else(|| {
        let message = match noise.test() {
            None if *noise == Noise::Cut => {
                "`--fail-above` cannot test a change of time in a part of a picture".to_owned()
            }
            None => "`--fail-above` cannot test a change of time: there are no repeats".to_owned(),
            Some(test) => format!(
                "`--fail-above` cannot test a change of time with only {} and {} repeats",
                test.n[0], test.n[1]
            ),
        };
        let help = match noise {
            Noise::Cut => "render both with the same `--crop`, or with `--cost counters`",
            _ => "render both with `--repeats 10`, or with `--cost counters`: counters are exact",
        };
        Diagnostic::new(message).with_help(help)
    })
}
