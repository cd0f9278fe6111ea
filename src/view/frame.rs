//! The frame's arrays, thinned out where they are too many for a page.

use crate::output::format::count;
use crate::results::{Array, Frame, Values};
use crate::yaml::Diagnostic;

/// Most pixels of a page: full HD stays whole.
pub(super) const MAX_PIXELS: u64 = 1920 * 1080;

/// Which pixels a page shows: evenly spread columns of evenly spread rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pixels {
    /// Columns and rows of the rendering.
    pub(super) full: [u32; 2],
    /// Columns and rows that are shown, at least one each.
    pub(super) shown: [u32; 2],
}

impl Pixels {
    /// At most `n_most` pixels of a rendering, in its proportions; at least one.
    /// A rendering that is slightly larger loses a few rows, not every second.
    pub(super) fn at_most(n_most: u64, full: [u32; 2]) -> Self {
        let [width, height] = full.map(u64::from);
        let n_most = n_most.clamp(1, (width * height).max(1));
        let share = (n_most as f64 / (width * height).max(1) as f64).sqrt();
        let n_columns = ((width as f64 * share).round() as u64).clamp(1, width.min(n_most));
        let n_rows = (n_most / n_columns).clamp(1, height);
        Self {
            full,
            shown: [n_columns as u32, n_rows as u32],
        }
    }

    pub(super) fn n_shown(self) -> u64 {
        self.shown.map(u64::from).iter().product()
    }

    fn is_whole(self) -> bool {
        self.shown == self.full
    }

    /// The column or row of the rendering that is shown at `i`; `axis` is 0
    /// for columns. The middle one of those that it stands for.
    fn shown_at(self, i: u32, axis: usize) -> u32 {
        let [full, shown] = [self.full[axis], self.shown[axis]].map(u64::from);
        ((2 * u64::from(i) + 1) * full / (2 * shown)) as u32
    }

    /// Where a column or row of the rendering is shown; `None` where it is not.
    fn place(self, at: u32, axis: usize) -> Option<u32> {
        let [full, shown] = [self.full[axis], self.shown[axis]].map(u64::from);
        let near = (u64::from(at) * shown / full) as u32;
        let is_there = |i: &u32| *i < self.shown[axis] && self.shown_at(*i, axis) == at;
        [near, near + 1].into_iter().find(is_there)
    }

    /// Where a pixel of the rendering is shown, as an index into the shown
    /// ones; `None` where it is not.
    pub(super) fn index(self, pixel: u64) -> Option<u32> {
        let width = u64::from(self.full[0]);
        let [i, j] = [
            self.place((pixel % width) as u32, 0)?,
            self.place((pixel / width) as u32, 1)?,
        ];
        Some(j * self.shown[0] + i)
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
            all if self.is_whole() => all,
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
        let [n_columns, n_rows] = self.shown;
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
            [self.full, self.shown].map(|size| size.map(|n| count(n.into())));
        (!self.is_whole()).then(|| {
            format!(
                "The rendering has {width} x {height} pixels. This page shows {n_columns} x \
                 {n_rows} of them, evenly spread; their values are exact."
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_hd_stays_whole_and_a_small_excess_costs_little() {
        let shown = |full| Pixels::at_most(MAX_PIXELS, full).shown;
        assert_eq!(shown([1920, 1080]), [1920, 1080]);
        assert_eq!(shown([640, 480]), [640, 480]);
        assert_eq!(shown([3840, 2160]), [1920, 1080]);
        assert_eq!(shown([7680, 4320]), [1920, 1080]);
        let just_larger = Pixels::at_most(MAX_PIXELS, [1921, 1080]);
        assert!(just_larger.n_shown() > MAX_PIXELS * 99 / 100);
        assert!(just_larger.n_shown() <= MAX_PIXELS);
        assert_eq!(shown([4_000_000, 1])[1], 1);
    }

    #[test]
    fn the_pixels_that_are_picked_have_the_indices_of_their_places() {
        for (full, n_pixels) in [
            ([7, 5], 35),
            ([7, 5], 34),
            ([7, 5], 12),
            ([1, 9], 3),
            ([8, 8], 1),
            ([31, 17], 400),
        ] {
            let pixels = Pixels::at_most(n_pixels, full);
            let all: Vec<u32> = (0..full[0] * full[1]).collect();
            let picked = pixels.pick(&all, 1);
            assert_eq!(picked.len() as u64, pixels.n_shown());
            assert!(pixels.n_shown() <= n_pixels && 2 * pixels.n_shown() >= n_pixels);
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
