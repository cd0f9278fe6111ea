//! The hit points, thinned out where they are too many for a page.

use super::frame::Pixels;
use super::payload::Payload;
use crate::output::format::count;
use crate::results::{Hits, Values};
use crate::sampling::uniform;
use crate::yaml::Diagnostic;

/// About how many points a page shows at most: what a laptop turns smoothly.
const MAX_POINTS: usize = 400_000;

/// Points and the pixels that they belong to.
#[derive(Debug)]
pub(super) struct Cloud {
    /// Three numbers a point, in world space.
    positions: Vec<f32>,
    /// Indices into the pixels that are shown.
    pixels: Vec<u32>,
    /// How many the rendering has.
    n_all: usize,
}

impl Cloud {
    /// Reads the points of the pixels that are shown.
    pub(super) fn read(hits: &mut Hits, pixels: &Pixels) -> Result<Self, Diagnostic> {
        let points = hits.read_points()?;
        let of_points = hits.read("pixel")?.values;
        let of_points = of_points.iter().map(|pixel| pixels.index(pixel as u64));
        Ok(Self::at_most(MAX_POINTS, &points, of_points))
    }

    /// About `n_most` of the points. A hash of the pixel chooses: even steps
    /// would show as stripes.
    fn at_most(
        n_most: usize,
        points: &[[f32; 3]],
        pixels: impl Iterator<Item = Option<u32>>,
    ) -> Self {
        let shown = points.iter().zip(pixels);
        let shown = shown.filter_map(|(point, pixel)| Some((point, pixel?)));
        let shown: Vec<(&[f32; 3], u32)> = shown.collect();
        let share = n_most as f32 / shown.len().max(1) as f32;
        let is_chosen = |pixel: u32| share >= 1.0 || uniform([pixel.into(), 0, 0])[0] < share;
        let chosen = || shown.iter().filter(|(_, pixel)| is_chosen(*pixel));
        Self {
            positions: chosen().flat_map(|(point, _)| *point).copied().collect(),
            pixels: chosen().map(|(_, pixel)| *pixel).collect(),
            n_all: points.len(),
        }
    }

    /// How many points are shown.
    pub(super) fn len(&self) -> usize {
        self.pixels.len()
    }

    /// How many the rendering has.
    pub(super) fn n_all(&self) -> usize {
        self.n_all
    }

    pub(super) fn payloads(self) -> [Payload; 2] {
        [
            Payload::of_numbers("cloud-positions", &Values::F32(self.positions)),
            Payload::of_numbers("cloud-pixels", &Values::U32(self.pixels)),
        ]
    }

    /// What is left out, if anything.
    pub(super) fn note(&self) -> Option<String> {
        let [shown, all] = [self.len(), self.n_all].map(|n| count(n as u64));
        (self.len() < self.n_all).then(|| {
            format!("The cloud shows {shown} of {all} hit points, chosen by a hash of the pixel.")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(n_most: usize, n: u32) -> Cloud {
        let points: Vec<[f32; 3]> = (0..n).map(|i| [i as f32; 3]).collect();
        let pixels = (0..n).map(|i| i.is_multiple_of(2).then_some(i));
        Cloud::at_most(n_most, &points, pixels)
    }

    #[test]
    fn few_points_are_all_shown() {
        let cloud = cloud(50, 100);
        assert_eq!((cloud.len(), cloud.n_all()), (50, 100));
        assert_eq!(cloud.positions[3..6], [2.0; 3]);
        assert_eq!(Cloud::at_most(1, &[], [].into_iter()).note(), None);
    }

    #[test]
    fn of_many_points_the_same_share_is_chosen_each_time() {
        let cloud_again = cloud(1000, 20_000);
        let cloud = cloud(1000, 20_000);
        assert!((900..1100).contains(&cloud.len()), "{}", cloud.len());
        assert_eq!(cloud.pixels, cloud_again.pixels);
        // From everywhere, and each with its own position.
        let first_half = cloud.pixels.iter().filter(|&&pixel| pixel < 10_000);
        assert!((400..600).contains(&first_half.count()));
        let positions = cloud.positions.chunks(3).zip(&cloud.pixels);
        assert!(
            positions
                .into_iter()
                .all(|(p, &pixel)| p == [pixel as f32; 3])
        );
        assert!(
            cloud
                .note()
                .is_some_and(|note| note.contains("of 20,000 hit points"))
        );
    }
}
