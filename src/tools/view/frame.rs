//! The frame's arrays, subsampled if the frame is too large for a page.

use base::numbers::count;
use host::text::Diagnostic;
use output::results::{FrameFile, LoadedArray};

/// Greatest number of pixels of a page: full HD.
pub(super) const MAX_PIXELS: u64 = 1920 * 1080;

/// The pixels that a page shows: the intersections of evenly spaced columns and rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ShownPixels {
    /// Columns and rows of the rendering.
    pub(super) full: [u32; 2],
    /// Shown columns and rows, at least one each.
    pub(super) shown: [u32; 2],
}

impl ShownPixels {
    /// Selects at most `n_most` pixels, at least one, with the aspect ratio of the rendering. A
    /// rendering that is slightly too large loses a few rows and columns, not every second one.
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

    /// Returns the number of shown pixels.
    pub(super) fn n_shown(self) -> u64 {
        self.shown.map(u64::from).iter().product()
    }

    fn is_whole(self) -> bool {
        self.shown == self.full
    }

    /// Returns the column (`axis` 0) or row (`axis` 1) of the rendering that is shown at `i`: the
    /// middle one of the columns or rows that it represents.
    fn shown_at(self, i: u32, axis: usize) -> u32 {
        let [full, shown] = [self.full[axis], self.shown[axis]].map(u64::from);
        ((2 * u64::from(i) + 1) * full / (2 * shown)) as u32
    }

    /// Returns the shown column or row of one of the rendering; `None` if it is not shown.
    fn place(self, at: u32, axis: usize) -> Option<u32> {
        let [full, shown] = [self.full[axis], self.shown[axis]].map(u64::from);
        let near = (u64::from(at) * shown / full) as u32;
        let is_there = |i: &u32| *i < self.shown[axis] && self.shown_at(*i, axis) == at;
        [near, near + 1].into_iter().find(is_there)
    }

    /// Returns the index of a pixel of the rendering among the shown ones; `None` if it is not
    /// shown.
    pub(super) fn index(self, pixel: u64) -> Option<u32> {
        let width = u64::from(self.full[0]);
        let [i, j] = [
            self.place((pixel % width) as u32, 0)?,
            self.place((pixel / width) as u32, 1)?,
        ];
        Some(j * self.shown[0] + i)
    }

    /// Reads the shown pixels of every array of the frame.
    pub(super) fn read(self, frame: &FrameFile) -> Result<Vec<LoadedArray>, Diagnostic> {
        let names: Vec<String> = frame
            .arrays()
            .iter()
            .map(|info| info.name.clone())
            .collect();
        let [columns, rows] = [0, 1].map(|axis| self.all_shown(axis));
        let read = |name: &String| {
            if self.is_whole() {
                frame.read(name)
            } else {
                frame.read_selected(name, &columns, &rows)
            }
        };
        names.iter().map(read).collect()
    }

    /// Returns the shown columns or rows.
    fn all_shown(self, axis: usize) -> Vec<u32> {
        let n = self.shown[axis];
        (0..n).map(|i| self.shown_at(i, axis)).collect()
    }

    /// Returns a note on the omitted pixels, if any.
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
    fn full_hd_is_shown_whole_and_a_small_excess_loses_few_pixels() {
        let shown = |full| ShownPixels::at_most(MAX_PIXELS, full).shown;
        assert_eq!(shown([1920, 1080]), [1920, 1080]);
        assert_eq!(shown([640, 480]), [640, 480]);
        assert_eq!(shown([3840, 2160]), [1920, 1080]);
        assert_eq!(shown([7680, 4320]), [1920, 1080]);
        let just_larger = ShownPixels::at_most(MAX_PIXELS, [1921, 1080]);
        assert!(just_larger.n_shown() > MAX_PIXELS * 99 / 100);
        assert!(just_larger.n_shown() <= MAX_PIXELS);
        assert_eq!(shown([4_000_000, 1])[1], 1);
    }

    #[test]
    fn shown_pixels_have_consecutive_indices() {
        for (full, n_pixels) in [
            ([7, 5], 35),
            ([7, 5], 34),
            ([7, 5], 12),
            ([1, 9], 3),
            ([8, 8], 1),
            ([31, 17], 400),
        ] {
            let pixels = ShownPixels::at_most(n_pixels, full);
            let all: Vec<u32> = (0..full[0] * full[1]).collect();
            let [columns, rows] = [0, 1].map(|axis| pixels.all_shown(axis));
            let in_row = |&y: &u32| columns.iter().map(move |&x| y * full[0] + x);
            let shown_pixels: Vec<u32> = rows.iter().flat_map(in_row).collect();
            assert_eq!(shown_pixels.len() as u64, pixels.n_shown());
            assert!(pixels.n_shown() <= n_pixels && 2 * pixels.n_shown() >= n_pixels);
            for (index, &pixel) in shown_pixels.iter().enumerate() {
                assert_eq!(pixels.index(pixel.into()), Some(index as u32));
            }
            let shown = all.iter().filter_map(|&pixel| pixels.index(pixel.into()));
            assert_eq!(shown.count(), shown_pixels.len());
        }
    }
}
