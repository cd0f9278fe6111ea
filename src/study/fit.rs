//! A power law through points: what straight lines on two logarithmic axes say.

/// `y = factor * x^exponent`.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct PowerLaw {
    /// `y` at 1.
    pub factor: f64,
    /// The slope of the logarithms.
    pub exponent: f64,
    /// Standard error of the exponent; 0 for two points.
    pub exponent_error: f64,
}

impl PowerLaw {
    /// Least squares of the logarithms of points (x, y), all greater than 0;
    /// `None` with fewer than two different x.
    pub fn through(points: &[(f64, f64)]) -> Option<Self> {
        let n = points.len() as f64;
        let logs = points.iter().map(|(x, y)| (x.ln(), y.ln()));
        let logs: Vec<(f64, f64)> = logs.collect();
        let mean_x = logs.iter().map(|(x, _)| x).sum::<f64>() / n;
        let mean_y = logs.iter().map(|(_, y)| y).sum::<f64>() / n;
        let xx: f64 = logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
        let xy: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
        let exponent = xy / xx;
        let residual = |(x, y): &(f64, f64)| y - mean_y - exponent * (x - mean_x);
        let squares: f64 = logs.iter().map(|point| residual(point).powi(2)).sum();
        let law = Self {
            factor: (mean_y - exponent * mean_x).exp(),
            exponent,
            exponent_error: (squares / (n - 2.0).max(1.0) / xx).sqrt(),
        };
        law.exponent.is_finite().then_some(law)
    }

    /// Its `y` at `x`.
    pub fn at(&self, x: f64) -> f64 {
        self.factor * x.powf(self.exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exact_law_is_found() {
        let law = PowerLaw::through(&[(1.0, 3.0), (4.0, 6.0), (16.0, 12.0)]).unwrap();
        assert!((law.exponent - 0.5).abs() < 1e-12 && (law.factor - 3.0).abs() < 1e-12);
        assert!(law.exponent_error < 1e-12);
        assert!((law.at(100.0) - 30.0).abs() < 1e-9);
    }

    #[test]
    fn one_place_has_no_slope() {
        assert_eq!(PowerLaw::through(&[(2.0, 3.0), (2.0, 4.0)]), None);
        assert_eq!(PowerLaw::through(&[]), None);
    }
}
