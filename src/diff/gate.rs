//! The gate of `--fail-above`: whether B costs more than may be.

use serde::Serialize;

use super::Diff;
use super::measure::ratio;
use super::noise::Noise;
use super::report::format_percent;
use crate::yaml::Diagnostic;

/// The cost that may be added, as a part of A's: 0.05 for `5%`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit(f64);

/// What the gate found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gate {
    /// What may be added, as a part of A's cost.
    pub limit: f64,
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
            Some(percent) if (0.0..=1e6).contains(&percent) => Ok(Self(percent / 100.0)),
            _ => Err("expected a percentage of at least 0, such as `5%`".to_owned()),
        }
    }
}

impl Gate {
    /// Holds the whole cost against the limit. A time is too high if all of its
    /// interval is: noise alone then closes the gate in one of forty runs.
    /// Counters are exact.
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
            limit: limit.0,
            measure,
            ratio,
            at_least,
            passed: at_least <= 1.0 + limit.0,
        })
    }

    /// What was found, in a sentence.
    pub fn sentence(&self) -> String {
        let Self { measure, limit, .. } = self;
        let [change, at_least] =
            [self.ratio, self.at_least].map(|ratio| format_percent(ratio - 1.0));
        let limit = format!("{} %", 100.0 * limit);
        let least = match at_least == change {
            true => String::new(),
            false => format!(", {at_least} at least"),
        };
        match self.passed {
            true if self.ratio > 1.0 + self.limit => format!(
                "passed, though not clearly: {change} of {measure}{least}; {limit} may be added"
            ),
            true => format!("passed: {change} of {measure}; {limit} may be added"),
            false => {
                format!("B costs too much: {change} of {measure}{least}; {limit} may be added")
            }
        }
    }
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
