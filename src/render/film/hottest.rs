//! The pixels that cost most.

use super::Film;
use tracer::cost::Metric;

/// A pixel and its cost by a [`Metric`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HotPixel {
    /// Column and row, row 0 on top.
    pub place: (u32, u32),
    /// The pixel's cost: nanoseconds, or a count.
    pub value: f64,
}

/// The repeats of a pixel agree if their median absolute deviation is at most this part of their
/// median.
const AGREEMENT: f32 = 0.1;

/// After a single rendering, a time counts if a neighbor's time is at least this part of it: a
/// disturbance seldom meets two neighbors.
const LIKE_A_NEIGHBOR: f32 = 0.5;

/// Pixels of a row that are examined together.
const BLOCK: usize = 64;

impl Film {
    /// Returns the `n` pixels that cost most, the most expensive first; among equal ones the upper
    /// one, then the left one, comes first. Returns fewer where too few cost anything or have a
    /// trustworthy time.
    ///
    /// A time is trustworthy where the repeats agree or, after a single rendering, where a neighbor
    /// took at least half as long.
    pub fn hottest(&self, metric: Metric, n: usize) -> Vec<HotPixel> {
        if metric.is_timed() {
            let first_row = self.row_range().start;
            let mut pixels = self.times().hottest(n);
            pixels
                .iter_mut()
                .for_each(|pixel| pixel.place.1 += first_row);
            return pixels;
        }
        let mut list = HottestList::new(n);
        let mut counts = Vec::new();
        for strip in &self.strips {
            self.counts(strip, metric, &mut counts);
            let rows = counts.chunks_exact(self.grid.width as usize);
            rows.zip(strip.first_row..)
                .for_each(|(row, y)| list.add_row(row, y, |_| true));
        }
        list.pixels
    }

    /// Returns the most expensive pixel by time, if times are trustworthy, and by node visits, or
    /// by primitive tests if there is no hierarchy.
    pub fn hottest_by_metrics(&self) -> [Option<(Metric, HotPixel)>; 2] {
        let by = |metric| Some((metric, self.hottest(metric, 1).into_iter().next()?));
        let mut counted = [Metric::NODE_VISITS, Metric::PRIMITIVE_TESTS].into_iter();
        let count = || counted.find_map(by);
        [
            Metric::measured_by(self.cost).and_then(by),
            self.cost.has_counters().then(count).flatten(),
        ]
    }

    /// Replaces the time of the pixel in column `x` and row `y`, and its deviation if there is one, in nanoseconds.
    pub(crate) fn set_time(&mut self, x: u32, y: u32, [ns, mad_ns]: [f32; 2]) {
        let width = self.grid.width;
        let mut strips = self.strips.iter_mut();
        let Some(strip) = strips.rfind(|strip| strip.first_row <= y) else {
            return;
        };
        let i = ((y - strip.first_row) * width + x) as usize;
        let arrays = [(&mut strip.time_ns, ns), (&mut strip.time_mad_ns, mad_ns)];
        for (array, ns) in arrays {
            array.get_mut(i).into_iter().for_each(|place| *place = ns);
        }
    }

    fn times(&self) -> Times<'_> {
        Times {
            ns: self.rows(|strip| &strip.time_ns).collect(),
            mad_ns: self.rows(|strip| &strip.time_mad_ns).collect(),
            n_repeats: self.n_repeats,
        }
    }
}

/// The times of a picture, row by row, row 0 on top, and their reliability.
#[derive(Debug, Clone)]
pub struct Times<'a> {
    /// The times in nanoseconds.
    pub ns: Vec<&'a [f32]>,
    /// The median absolute deviations of the times; empty if not measured.
    pub mad_ns: Vec<&'a [f32]>,
    /// Number of samples.
    pub n_repeats: u8,
}

impl Times<'_> {
    /// Returns the `n` pixels with the longest trustworthy times, as [`Film::hottest`] does.
    pub fn hottest(&self, n: usize) -> Vec<HotPixel> {
        let mut list = HottestList::new(n);
        for (y, row) in self.ns.iter().enumerate() {
            list.add_row(row, y as u32, |x| self.is_trusted(x, y));
        }
        list.pixels
    }

    fn is_trusted(&self, x: usize, y: usize) -> bool {
        if self.n_repeats <= 1 {
            return self.has_like_neighbor(x, y);
        }
        let mad_ns = self.mad_ns.get(y).map_or(0.0, |row| row[x]);
        mad_ns <= AGREEMENT * self.ns[y][x]
    }

    /// Returns true if a neighbor of this pixel took at least half as long.
    fn has_like_neighbor(&self, x: usize, y: usize) -> bool {
        let around = |at: usize, n: usize| at.saturating_sub(1)..n.min(at + 2);
        let mut places = around(y, self.ns.len())
            .flat_map(|row| around(x, self.ns[row].len()).map(move |column| (column, row)))
            .filter(|&place| place != (x, y));
        let least = LIKE_A_NEIGHBOR * self.ns[y][x];
        places.any(|place| self.ns[place.1][place.0] >= least)
    }
}

/// Returns the `n` pixels of the highest counts, given row by row, row 0 on top, as
/// [`Film::hottest`] does.
pub fn highest_counts<'a>(rows: impl Iterator<Item = &'a [u32]>, n: usize) -> Vec<HotPixel> {
    let mut list = HottestList::new(n);
    for (row, y) in rows.zip(0..) {
        list.add_row(row, y, |_| true);
    }
    list.pixels
}

/// The most expensive pixels so far, the most expensive first.
struct HottestList {
    most: usize,
    pixels: Vec<HotPixel>,
}

impl HottestList {
    fn new(most: usize) -> Self {
        Self {
            most,
            pixels: Vec::new(),
        }
    }

    /// Adds the pixels of a row, given their costs, if `is_trusted` by column.
    fn add_row<T>(&mut self, row: &[T], y: u32, is_trusted: impl Fn(usize) -> bool)
    where
        T: Copy + Into<f64>,
    {
        for (first, block) in (0..).step_by(BLOCK).zip(row.chunks(BLOCK)) {
            // Most blocks have none. Without an early end, the loop compiles to vector instructions.
            let least = self.least();
            let exceeds = block
                .iter()
                .fold(false, |any, &value| any | (value.into() > least));
            if !exceeds {
                continue;
            }
            for (x, &value) in (first..).zip(block) {
                self.add((x as u32, y), value.into(), || is_trusted(x));
            }
        }
    }

    /// Returns the cost that a pixel has to exceed.
    fn least(&self) -> f64 {
        match self.pixels.last() {
            Some(last) if self.pixels.len() == self.most => last.value,
            _ => 0.0,
        }
    }

    /// Adds a pixel if it costs more than one of the list and `is_trusted`, which is called last.
    /// Pixels come row by row.
    fn add(&mut self, place: (u32, u32), value: f64, is_trusted: impl FnOnce() -> bool) {
        if value <= self.least() || self.most == 0 || !is_trusted() {
            return;
        }
        let position = self.pixels.partition_point(|pixel| pixel.value >= value);
        if self.pixels.len() == self.most {
            self.pixels.pop();
        }
        self.pixels.insert(position, HotPixel { place, value });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::TileGrid;
    use scene::config::CostMode;

    const WIDTH: u32 = 9;

    /// Returns a film of 9 x 7 pixels of 100 ns, except for these.
    fn film(n_repeats: u8, times: &[((u32, u32), f32)]) -> Film {
        let mut film = Film::new(TileGrid::new(WIDTH, 7, 4), 1, CostMode::Time);
        film.n_repeats = n_repeats;
        for strip in &mut film.strips {
            strip.time_ns.fill(100.0);
            strip.time_mad_ns = vec![1.0; strip.time_ns.len()];
        }
        for &(place, ns) in times {
            *at(&mut film, place).0 = ns;
        }
        film
    }

    /// Returns the time and the deviation of a pixel.
    fn at(film: &mut Film, (x, y): (u32, u32)) -> (&mut f32, &mut f32) {
        let mut strips = film.strips.iter_mut();
        let strip = strips.rfind(|strip| strip.first_row <= y).unwrap();
        let i = ((y - strip.first_row) * WIDTH + x) as usize;
        let [times, deviations] = [&mut strip.time_ns, &mut strip.time_mad_ns];
        (&mut times[i], &mut deviations[i])
    }

    fn places(film: &Film, n: usize) -> Vec<(u32, u32)> {
        let hottest = film.hottest(Metric::TIME, n);
        hottest.iter().map(|pixel| pixel.place).collect()
    }

    #[test]
    fn the_most_expensive_come_first_and_of_equal_ones_the_upper_left() {
        let film = film(3, &[((4, 6), 900.0), ((8, 2), 700.0), ((2, 5), 700.0)]);
        let expected = [(4, 6), (8, 2), (2, 5), (0, 0), (1, 0)];
        for n in 0..=5 {
            assert_eq!(places(&film, n), expected[..n]);
        }
        assert_eq!(places(&film, 1000).len(), 63);
        assert_eq!(film.hottest(Metric::TIME, 1)[0].value, 900.0);
    }

    #[test]
    fn a_pixel_whose_repeats_differ_is_passed_over() {
        let mut film = film(3, &[((1, 1), 900.0), ((3, 6), 300.0)]);
        *at(&mut film, (1, 1)).1 = 91.0;
        assert_eq!(places(&film, 1), [(3, 6)]);
        *at(&mut film, (1, 1)).1 = 90.0;
        assert_eq!(places(&film, 1), [(1, 1)]);
    }

    #[test]
    fn after_one_rendering_a_speck_is_passed_over() {
        let specks = [((5, 4), 9000.0), ((0, 0), 8000.0), ((7, 6), 4000.0)];
        let pair = [((2, 3), 500.0), ((3, 4), 260.0)];
        let film = film(1, &[&specks[..], &pair[..]].concat());
        assert_eq!(places(&film, 1), [(2, 3)]);
    }

    #[test]
    fn what_costs_nothing_is_not_named() {
        let film = film(1, &[]);
        assert!(film.hottest(Metric::DEPTH, 3).is_empty());
        assert_eq!(film.hottest(Metric::RAYS, 1)[0].value, 1.0);
    }
}
