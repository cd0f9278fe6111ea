//! The frame's arrays, thinned out where they are too many for a page.

use crate::output::format::count;
use crate::results::{Array, Frame, Values};
use crate::yaml::Diagnostic;

/// Most pixels of a page: full HD stays whole.
const MAX_PIXELS: u64 = 1920 * 1080;

/// Which pixels a page shows: every `step`th of every `step`th row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pixels {
    /// Columns and rows of the rendering.
    pub(super) full: [u32; 2],
    pub(super) step: u32,
}

impl Pixels {
    pub(super) fn of(frame: &Frame) -> Self {
        Self::at_most(MAX_PIXELS, [frame.width(), frame.height()])
    }

    fn at_most(n_pixels: u64, full: [u32; 2]) -> Self {
        let with = |step| Self { full, step };
        let fits =
            |pixels: &Self| pixels.shown().map(u64::from).iter().product::<u64>() <= n_pixels;
        (1..).map(with).find(fits).unwrap_or(with(1))
    }

    /// Columns and rows that are shown.
    pub(super) fn shown(self) -> [u32; 2] {
        self.full.map(|n| n.div_ceil(self.step))
    }

    /// The column or row of the rendering that is shown at `i`; `axis` is 0
    /// for columns. The middle one of each step, as far as there is one.
    fn shown_at(self, i: u32, axis: usize) -> u32 {
        (i * self.step)
            .saturating_add(self.step / 2)
            .min(self.full[axis] - 1)
    }

    /// Where a pixel of the rendering is shown, as an index into the shown
    /// ones; `None` where it is not.
    pub(super) fn index(self, pixel: u64) -> Option<u32> {
        let width = u64::from(self.full[0]);
        let (x, y) = ((pixel % width) as u32, (pixel / width) as u32);
        let [i, j] = [x, y].map(|n| n / self.step);
        let is_shown = self.shown_at(i, 0) == x && self.shown_at(j, 1) == y;
        is_shown.then(|| j * self.shown()[0] + i)
    }

    /// Reads every array of the frame, the pixels that are shown alone.
    pub(super) fn read(self, frame: &mut Frame) -> Result<Vec<Array>, Diagnostic> {
        let names: Vec<String> = frame
            .arrays()
            .iter()
            .map(|info| info.name.clone())
            .collect();
        let read = |name: &String| Ok(self.thin(frame.read(name)?));
        names.iter().map(read).collect()
    }

    fn thin(self, array: Array) -> Array {
        let Array {
            name,
            n_components,
            values,
        } = array;
        let values = match values {
            all if self.step == 1 => all,
            Values::U8(all) => Values::U8(self.pick(&all, n_components)),
            Values::I32(all) => Values::I32(self.pick(&all, n_components)),
            Values::U32(all) => Values::U32(self.pick(&all, n_components)),
            Values::I64(all) => Values::I64(self.pick(&all, n_components)),
            Values::U64(all) => Values::U64(self.pick(&all, n_components)),
            Values::F32(all) => Values::F32(self.pick(&all, n_components)),
            Values::F64(all) => Values::F64(self.pick(&all, n_components)),
        };
        Array {
            name,
            n_components,
            values,
        }
    }

    fn pick<T: Copy>(self, all: &[T], n_components: usize) -> Vec<T> {
        let [n_columns, n_rows] = self.shown();
        let row_length = self.full[0] as usize * n_components;
        let row = |j| {
            let begin = self.shown_at(j, 1) as usize * row_length;
            &all[begin..begin + row_length]
        };
        let pixel = |i| {
            let begin = self.shown_at(i, 0) as usize * n_components;
            begin..begin + n_components
        };
        (0..n_rows)
            .map(row)
            .flat_map(|row| (0..n_columns).flat_map(move |i| &row[pixel(i)]))
            .copied()
            .collect()
    }

    /// What is left out, if anything.
    pub(super) fn note(self) -> Option<String> {
        let [[width, height], [n_columns, n_rows]] =
            [self.full, self.shown()].map(|size| size.map(|n| count(n.into())));
        (self.step > 1).then(|| {
            format!(
                "The rendering has {width} x {height} pixels. This page shows one in {} of each \
                 row and column, {n_columns} x {n_rows}; their values are exact.",
                self.step
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_hd_stays_whole() {
        let step = |full| Pixels::at_most(MAX_PIXELS, full).step;
        assert_eq!(step([1920, 1080]), 1);
        assert_eq!((step([3840, 2160]), step([1921, 1080])), (2, 2));
        assert_eq!(step([7680, 4320]), 4);
    }

    #[test]
    fn the_pixels_that_are_picked_have_the_indices_of_their_places() {
        for (full, n_pixels) in [([7, 5], 35), ([7, 5], 12), ([1, 9], 3), ([8, 8], 1)] {
            let pixels = Pixels::at_most(n_pixels, full);
            let all: Vec<u32> = (0..full[0] * full[1]).collect();
            let picked = pixels.pick(&all, 1);
            assert_eq!(picked.len() as u32, pixels.shown().iter().product::<u32>());
            for (index, &pixel) in picked.iter().enumerate() {
                assert_eq!(pixels.index(pixel.into()), Some(index as u32));
            }
            let shown = all.iter().filter_map(|&pixel| pixels.index(pixel.into()));
            assert_eq!(shown.count(), picked.len());
            let pairs: Vec<u32> = all.iter().flat_map(|&n| [n, n + 100]).collect();
            let expected: Vec<u32> = picked.iter().flat_map(|&n| [n, n + 100]).collect();
            assert_eq!(pixels.pick(&pairs, 2), expected);
        }
    }
}
