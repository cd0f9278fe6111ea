//! The hit points of the shown pixels.

use super::frame::ShownPixels;
use super::payload::Payload;
use crate::results::HitsFile;
use crate::text::Diagnostic;
use crate::text::numbers::count;
use crate::vtk::ArrayValues;

/// Hit points and their pixels.
#[derive(Debug)]
pub(super) struct Cloud {
    /// Three coordinates per point, in world space.
    positions: Vec<f32>,
    /// Indices into the shown pixels, ascending.
    pixels: Vec<u32>,
    /// The number of points of the rendering.
    n_all: usize,
}

impl Cloud {
    /// Reads the points of all shown pixels, so that each pixel that is marked or
    /// probed in the picture has its point.
    pub(super) fn read(hits: &mut HitsFile, pixels: &ShownPixels) -> Result<Self, Diagnostic> {
        let points = hits.read_points()?;
        let of_points = hits.read("pixel")?.values;
        let of_points = of_points.iter().map(|pixel| pixels.index(pixel as u64));
        Ok(Self::of(&points, of_points))
    }

    fn of(points: &[[f32; 3]], pixels: impl Iterator<Item = Option<u32>>) -> Self {
        let shown = points.iter().zip(pixels);
        let shown = shown.filter_map(|(point, pixel)| Some((point, pixel?)));
        let (positions, pixels): (Vec<[f32; 3]>, Vec<u32>) = shown.unzip();
        Self {
            positions: positions.into_flattened(),
            pixels,
            n_all: points.len(),
        }
    }

    /// The number of shown points.
    pub(super) fn len(&self) -> usize {
        self.pixels.len()
    }

    /// The number of points of the rendering.
    pub(super) fn n_all(&self) -> usize {
        self.n_all
    }

    /// The positions and the pixels as payloads of the page.
    pub(super) fn payloads(self) -> [Payload; 2] {
        [
            Payload::of_numbers("cloud-positions", &ArrayValues::F32(self.positions)),
            Payload::of_numbers("cloud-pixels", &ArrayValues::U32(self.pixels)),
        ]
    }

    /// A note on the omitted points, if any.
    pub(super) fn note(&self) -> Option<String> {
        let [shown, all] = [self.len(), self.n_all].map(|n| count(n as u64));
        (self.len() < self.n_all).then(|| {
            format!("The cloud shows {shown} of {all} hit points: those of the shown pixels.")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_shown_pixel_has_its_point() {
        let points: Vec<[f32; 3]> = (0..100_u8).map(|i| [i.into(); 3]).collect();
        let pixels = (0..100).map(|i: u32| i.is_multiple_of(2).then_some(i));
        let cloud = Cloud::of(&points, pixels);
        assert_eq!((cloud.len(), cloud.n_all()), (50, 100));
        assert_eq!(cloud.positions[3..6], [2.0; 3]);
        assert!(cloud.note().unwrap().contains("50 of 100 hit points"));
        assert_eq!(Cloud::of(&[], [].into_iter()).note(), None);
    }
}
