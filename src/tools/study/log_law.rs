//! The cost that theory predicts for a search in a balanced tree.

use serde::Serialize;

use super::CostSample;
use super::cost_law::{distinct_sizes, linear_fit, relative_residual, weighted};

/// `cost = fixed + factor * log₂ n`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LogLaw {
    /// The cost at size 1, at least 0.
    pub fixed: f64,
    /// The cost of doubling the size, at least 0.
    pub factor: f64,
    /// Root mean square of the samples' relative distances from the law.
    pub residual: f64,
}

impl LogLaw {
    /// Fits the law to samples whose costs are greater than 0; `None` for fewer than three
    /// different sizes, or for a size below 1.
    pub fn fit(samples: &[CostSample]) -> Option<Self> {
        let sizes = distinct_sizes(samples);
        if sizes.len() < 3 || sizes[0] < 1.0 {
            return None;
        }
        let [fixed, factor] = linear_fit(&weighted(samples), f64::log2);
        let law = Self {
            fixed,
            factor,
            residual: 0.0,
        };
        Some(Self {
            residual: relative_residual(samples, |n| law.at(n)),
            ..law
        })
    }

    /// Evaluates the cost at size `n`.
    pub fn at(&self, n: f64) -> f64 {
        self.fixed + self.factor * n.log2()
    }
}
