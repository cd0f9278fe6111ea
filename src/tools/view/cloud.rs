//! The hit points of the shown pixels.

use super::frame::ShownPixels;
use super::payload::Payload;
use base::numbers::count;
use host::text::Diagnostic;
use output::results::HitsFile;
use vtk::ArrayValues;

/// Hit points and their pixels.
#[derive(Debug, Default)]
pub(super) struct Cloud {
    /// Three coordinates per point, in world space, relative to the origin of the page.
    positions: Vec<f32>,
    /// Indices into the shown pixels, ascending.
    pixels: Vec<u32>,
    /// Number of points of the rendering.
    n_all: usize,
}

impl Cloud {
    /// Reads the points of all shown pixels, so that each pixel that is marked or probed in the
    /// picture has its point.
    pub(super) fn read(
        hits: &HitsFile,
        pixels: &ShownPixels,
        origin: [f64; 3],
    ) -> Result<Self, Diagnostic> {
        let mut cloud = Self::default();
        for piece in hits.pieces() {
            let points = piece.read_points()?;
            let of_points = piece.read("pixel")?.values;
            let of_points = of_points.iter().map(|pixel| pixels.index(pixel as u64));
            cloud.add(&points, of_points, origin);
        }
        Ok(cloud)
    }

    /// Adds the points of shown pixels.
    fn add(
        &mut self,
        points: &[[f64; 3]],
        pixels: impl Iterator<Item = Option<u32>>,
        origin: [f64; 3],
    ) {
        for (point, pixel) in points.iter().zip(pixels) {
            if let Some(pixel) = pixel {
                let from_origin = |axis: usize| (point[axis] - origin[axis]) as f32;
                self.positions.extend([0, 1, 2].map(from_origin));
                self.pixels.push(pixel);
            }
        }
        self.n_all += points.len();
    }

    /// Returns the number of shown points.
    pub(super) fn len(&self) -> usize {
        self.pixels.len()
    }

    /// Returns the number of points of the rendering.
    pub(super) fn n_all(&self) -> usize {
        self.n_all
    }

    /// Returns the positions and the pixels as payloads of the page.
    pub(super) fn payloads(self) -> [Payload; 2] {
        [
            Payload::encode_numbers("cloud-positions", &ArrayValues::F32(self.positions)),
            Payload::encode_numbers("cloud-pixels", &ArrayValues::U32(self.pixels)),
        ]
    }

    /// Returns a note on the omitted points, if any.
    pub(super) fn note(&self) -> Option<String> {
        let [shown, all] = [self.len(), self.n_all].map(|n| count(n as u64));
        (self.len() < self.n_all)
            .then(|| format!("The cloud shows {shown} of {all} hit points, at the shown pixels."))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_shown_pixel_has_its_point() {
        let points: Vec<[f64; 3]> = (0..100_u8).map(|i| [i.into(); 3]).collect();
        let pixels = (0..100).map(|i: u32| i.is_multiple_of(2).then_some(i));
        let of = |points: &[[f64; 3]], pixels: &mut dyn Iterator<Item = Option<u32>>| {
            let mut cloud = Cloud::default();
            cloud.add(points, pixels, [0.0; 3]);
            cloud
        };
        let cloud = of(&points, &mut { pixels });
        assert_eq!((cloud.len(), cloud.n_all()), (50, 100));
        assert_eq!(cloud.positions[3..6], [2.0; 3]);
        assert!(cloud.note().unwrap().contains("50 of 100 hit points"));
        assert_eq!(of(&[], &mut [].into_iter()).note(), None);
    }
}
