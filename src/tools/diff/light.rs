//! The difference of the light of two pictures.

use serde::Serialize;

use super::Side;
use host::text::Diagnostic;
use render::film::Column;

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
    /// Compares the radiance of all pixels of two outputs; `None` unless both have it.
    ///
    /// # Errors
    /// The radiance cannot be read.
    pub(super) fn measure(sides: &[Side; 2]) -> Result<Option<Self>, Diagnostic> {
        let has_radiance = |side: &Side| side.has_array(Column::RADIANCE.name);
        if !sides.iter().all(has_radiance) {
            return Ok(None);
        }
        let [a, b] = sides;
        let mut sums = LightSums::default();
        for rows in a.bands() {
            sums.add(&a.radiance(rows.clone())?, &b.radiance(rows)?);
        }
        Ok(Some(sums.difference()))
    }

    /// Compares the channels of all pixels of two pictures.
    pub(super) fn compare(a: &[f32], b: &[f32]) -> Self {
        let mut sums = LightSums::default();
        sums.add(a, b);
        sums.difference()
    }
}

/// The sums over the channels compared so far.
#[derive(Default)]
struct LightSums {
    n: usize,
    light: [f64; 2],
    max: f64,
    squares: f64,
}

impl LightSums {
    fn add(&mut self, a: &[f32], b: &[f32]) {
        self.n += a.len();
        for (&a, &b) in a.iter().zip(b) {
            let [a, b] = [a, b].map(f64::from);
            let difference = (b - a).abs();
            self.light[0] += a;
            self.light[1] += b;
            self.max = self.max.max(difference);
            self.squares += difference * difference;
        }
    }

    fn difference(&self) -> LightDifference {
        let n = self.n.max(1) as f64;
        LightDifference {
            mean: self.light.map(|sum| sum / n),
            max: self.max,
            rms: (self.squares / n).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_above_white_are_measured() {
        let found = LightDifference::compare(&[0.0, 0.5, 4.0, 1.0], &[0.0, 0.5, 6.0, 0.0]);
        assert_eq!(found.mean, [1.375, 1.625]);
        assert_eq!((found.max, found.rms), (2.0, 1.25_f64.sqrt()));
    }
}
