//! The difference of the light of two pictures.

use serde::Serialize;

/// The difference of the radiance of all pixels, which has no limit and depends neither on exposure
/// nor on a tone curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LightDifference {
    /// The means over all channels of all pixels of A and B.
    pub mean: [f64; 2],
    /// The greatest difference of a channel.
    pub max: f64,
    /// The root mean square of the differences over all channels of all pixels.
    pub rms: f64,
}

impl LightDifference {
    /// Compares the channels of all pixels.
    pub(super) fn measure(a: &[f32], b: &[f32]) -> Self {
        let n = a.len().max(1) as f64;
        let mean = [a, b].map(|light| light.iter().copied().map(f64::from).sum::<f64>() / n);
        let differences = a
            .iter()
            .zip(b)
            .map(|(&a, &b)| (f64::from(b) - f64::from(a)).abs());
        let (max, squares) = differences.fold((0.0, 0.0), |(max, squares), difference| {
            (f64::max(max, difference), squares + difference * difference)
        });
        Self {
            mean,
            max,
            rms: (squares / n).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_above_white_are_measured() {
        let found = LightDifference::measure(&[0.0, 0.5, 4.0, 1.0], &[0.0, 0.5, 6.0, 0.0]);
        assert_eq!(found.mean, [1.375, 1.625]);
        assert_eq!((found.max, found.rms), (2.0, 1.25_f64.sqrt()));
    }
}
