//! The difference of two pictures.

use serde::Serialize;

use super::Side;
use host::text::Diagnostic;

/// The difference of two pictures of the same size; color channels range from 0 to 255.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PictureDifference {
    /// Pixels whose colors differ.
    pub n_pixels: u64,
    /// The greatest difference of a channel, 0 to 255.
    pub max: u8,
    /// The root mean square of the differences over all channels of all pixels.
    pub rms: f64,
}

impl PictureDifference {
    /// Compares the colors of all pixels of two outputs.
    ///
    /// # Errors
    /// The colors cannot be read.
    pub(super) fn measure([a, b]: &[Side; 2]) -> Result<Self, Diagnostic> {
        let mut sums = ColorSums::default();
        for rows in a.bands() {
            sums.add(&a.colors(rows.clone())?, &b.colors(rows)?);
        }
        Ok(sums.difference())
    }

    /// Compares the colors of two pictures.
    pub(super) fn compare(a: &[[u8; 3]], b: &[[u8; 3]]) -> Self {
        let mut sums = ColorSums::default();
        sums.add(a, b);
        sums.difference()
    }
}

/// The sums over the pixels compared so far.
#[derive(Default)]
struct ColorSums {
    n_pixels: u64,
    n_different: u64,
    max: u8,
    squares: u64,
}

impl ColorSums {
    fn add(&mut self, a: &[[u8; 3]], b: &[[u8; 3]]) {
        self.n_pixels += a.len() as u64;
        for (a, b) in a.iter().zip(b).filter(|(a, b)| a != b) {
            self.n_different += 1;
            for (a, b) in a.iter().zip(b) {
                let difference = a.abs_diff(*b);
                self.max = self.max.max(difference);
                self.squares += u64::from(difference).pow(2);
            }
        }
    }

    fn difference(&self) -> PictureDifference {
        let n_channels = 3 * self.n_pixels.max(1);
        PictureDifference {
            n_pixels: self.n_different,
            max: self.max,
            rms: (self.squares as f64 / n_channels as f64).sqrt(),
        }
    }
}

/// Returns the greatest difference of a channel for each pixel.
pub(super) fn by_pixel(a: &[[u8; 3]], b: &[[u8; 3]]) -> Vec<u8> {
    let difference = |(a, b): (&[u8; 3], &[u8; 3])| {
        let channels = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
        channels.max().unwrap_or(0)
    };
    a.iter().zip(b).map(difference).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_counted_and_measured() {
        let a = [[0, 0, 0], [10, 20, 30], [255, 255, 255]];
        let b = [[0, 0, 0], [10, 24, 33], [255, 255, 0]];
        let found = PictureDifference::compare(&a, &b);
        assert_eq!((found.n_pixels, found.max), (2, 255));
        let mean_square = f64::from(4 * 4 + 3 * 3 + 255 * 255) / 9.0;
        assert!((found.rms - mean_square.sqrt()).abs() < 1e-12);
        assert_eq!(PictureDifference::compare(&a, &a).n_pixels, 0);
        assert_eq!(by_pixel(&a, &b), [0, 4, 255]);
    }
}
