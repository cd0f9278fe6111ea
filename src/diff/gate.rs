//! The gate of `--fail-above`: whether B costs more than may be.

use serde::Serialize;

use super::Diff;
use super::measure::ratio;
use super::noise::Noise;
use crate::text::Diagnostic;

/// The cost that may be added, in percent of A's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit(f64);

/// What the gate found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gate {
    /// What may be added, in percent of A's cost.
    pub limit_percent: f64,
    /// What was held against it: `time`, or `node visits + primitive tests`.
    pub measure: &'static str,
    /// B over A.
    pub ratio: f64,
    /// The ratio is at least this; of a time the lower end of its interval.
    pub at_least: f64,
    /// Whether B may pass.
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
    /// Whether B over A may be this.
    fn allows(self, ratio: f64) -> bool {
        ratio <= 1.0 + self.0 / 100.0
    }
}

impl Gate {
    /// Holds the whole cost against the limit. A time is too high if all of its
    /// interval is: where no more was added than may be, noise closes the gate
    /// in one of forty comparisons at most. Counters are exact.
    ///
    /// # Errors
    /// Times that were not repeated often enough to tell.
    pub fn of(diff: &Diff, limit: Limit) -> Result<Self, Diagnostic> {
        let (measure, ratio, at_least) = match &diff.noise {
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
            measure,
            ratio,
            at_least,
            passed: limit.allows(at_least),
        })
    }

    /// What was found, in a sentence.
    pub fn sentence(&self) -> String {
        let measure = self.measure;
        let [change, at_least] =
            [self.ratio, self.at_least].map(|ratio| format!("{:+.1} %", added_percent(ratio)));
        let limit = format!("{} %", self.limit_percent);
        let least = if at_least == change {
            String::new()
        } else {
            format!(", {at_least} at least")
        };
        match self.passed {
            true if !Limit(self.limit_percent).allows(self.ratio) => format!(
                "passed, though not clearly: {change} of {measure}{least}; {limit} may be added"
            ),
            true => format!("passed: {change} of {measure}; {limit} may be added"),
            false => {
                format!("B costs too much: {change} of {measure}{least}; {limit} may be added")
            }
        }
    }
}

/// What a ratio adds: 5 for 1.05.
fn added_percent(ratio: f64) -> f64 {
    100.0 * (ratio - 1.0)
}

/// The estimate and the lower end of its interval.
fn time_ratio(noise: &Noise) -> Result<(f64, f64), Diagnostic> {
    let found = noise
        .test()
        .and_then(|test| Some((test.ratio.estimate, test.ratio.interval?[0])));
    found.ok_or_else(|| {
        let message = match noise.test() {
            None => "`--fail-above` cannot tell a slower time from noise: there are no repeats"
                .to_owned(),
            Some(test) => format!(
                "`--fail-above` cannot tell a slower time from noise with {} and {} repeats",
                test.n[0], test.n[1]
            ),
        };
        Diagnostic::new(message).with_help(
            "render both with `--repeats 10`, or with `--cost counters`, which are exact",
        )
    })
}
