//! Surveys a picture band by band.

use super::distances::Distances;
use super::run::PixelHashes;
use super::survey::{ReducedMap, Survey};
use crate::chart::{Histogram, Range};
use math::statistics::FineHistogram;
use render::film::{Film, HotPixel, Strip};
use scene::config::Image;
use tracer::cost::Metric;

/// Maximum side of a map, in pixels.
const MAX_SIDE: u32 = 4096;

/// Surveys the bands of a picture from top to bottom.
pub(crate) struct Surveyor {
    survey: Survey,
    range: Histogram,
    /// The values of the files' first metric, or of the distance.
    shown: Histogram,
    cost: FineHistogram,
    counter: FineHistogram,
    distances: FineHistogram,
    map: ReducedMap,
}

impl Surveyor {
    /// Creates a surveyor for the picture of this film, which has no pixels.
    pub fn new(film: &Film) -> Self {
        let metrics = film.metrics_of_totals();
        let map = ReducedMap::new([film.grid.width, film.grid.height]);
        Self {
            survey: Survey {
                hashes: PixelHashes::default(),
                n_hits: 0,
                time_ns: 0.0,
                time_mad_ns: 0.0,
                n_rejected: 0,
                hottest: [None; 2],
                metrics,
                range: Range::spanning(&[]),
                median: 0.0,
                sum: 0.0,
                shown: film.metrics_in_files_of_totals(),
                shown_range: Range::spanning(&[]),
                counter_ends: [0.0; 2],
                distances: Distances::of_histogram(&FineHistogram::default()),
                map: None,
            },
            range: Histogram::default(),
            shown: Histogram::default(),
            cost: FineHistogram::default(),
            counter: FineHistogram::default(),
            distances: FineHistogram::default(),
            map,
        }
    }

    /// Returns an upper bound of the surveyor's memory in bytes.
    pub(super) fn bytes(image: &Image) -> u64 {
        let map = ReducedMap::new([image.width, image.height]);
        3 * FineHistogram::BYTES + (map.values.len() * size_of::<f32>()) as u64
    }

    /// Takes the next band, on the current rayon pool.
    pub fn add(&mut self, band: &Film) {
        let Self {
            survey,
            range,
            shown,
            cost,
            counter,
            distances,
            map,
        } = self;
        let (metrics, in_files) = (survey.metrics, survey.shown);
        // The statistics are independent of each other: add them in parallel.
        let of_shown = || match in_files[0] {
            Some(first) => for_each_strip(band, first, |_, values| shown.add(values)),
            None => shown.add(band.rows(|strip| &strip.distance).flatten()),
        };
        let of_counters = || {
            if let Some(second) = in_files[1] {
                for_each_strip(band, second, |_, counts| {
                    counter.add(counts.iter().copied());
                });
            }
        };
        let of_distances = || {
            let all = band.values(|strip| &strip.distance);
            distances.add(all.filter(|distance| distance.is_finite()));
        };
        let of_cost = || match metrics {
            Some([first, _]) => for_each_strip(band, first, |strip, values| {
                range.add(values);
                cost.add(values.iter().copied());
                survey.sum += values.iter().copied().map(f64::from).sum::<f64>();
                map.add(strip.first_row, values);
            }),
            None => range.add(band.rows(|strip| &strip.distance).flatten()),
        };
        let of_film = || survey.hashes.add(band);
        rayon::join(
            || rayon::join(of_counters, of_distances),
            || rayon::join(of_cost, || rayon::join(of_film, of_shown)),
        );
        // Add the totals, and keep the most expensive pixels.
        survey.n_hits += band.n_hits() as u64;
        survey.time_ns += band.total_time_ns();
        survey.time_mad_ns += band.total_time_mad_ns();
        survey.n_rejected += band.n_rejected();
        for (so_far, found) in survey.hottest.iter_mut().zip(band.hottest_by_metrics()) {
            *so_far = hotter(*so_far, found);
        }
    }

    /// Returns the survey of all bands.
    pub fn finish(self) -> Survey {
        let Self {
            survey,
            range,
            shown,
            cost,
            counter,
            distances,
            map,
        } = self;
        let quantile = |part: u64| counter.at(counter.n.saturating_sub(1) * part / 200);
        Survey {
            range: Range::of_histogram(&range),
            shown_range: Range::of_histogram(&shown),
            median: cost.at(cost.n / 2).unwrap_or_default(),
            counter_ends: [1, 199].map(|part| quantile(part).unwrap_or_default().into()),
            distances: Distances::of_histogram(&distances),
            map: Some(map.means()),
            ..survey
        }
    }
}

/// Returns the more expensive pixel, the first one if both are equal. Node visits come before
/// primitive tests, the metric of a band without any.
fn hotter(
    first: Option<(Metric, HotPixel)>,
    second: Option<(Metric, HotPixel)>,
) -> Option<(Metric, HotPixel)> {
    let is_second = |(first, hot): (Metric, HotPixel), (second, other): (Metric, HotPixel)| {
        if first == second {
            other.value > hot.value
        } else {
            second == Metric::NODE_VISITS
        }
    };
    match (first, second) {
        (Some(one), Some(other)) if is_second(one, other) => second,
        _ => first.or(second),
    }
}

/// Calls `take` with each strip of a film and a metric of its pixels.
fn for_each_strip(film: &Film, metric: Metric, mut take: impl FnMut(&Strip, &[f32])) {
    let mut values = Vec::new();
    for strip in &film.strips {
        film.costs(strip, metric, &mut values);
        take(strip, &values);
    }
}

impl ReducedMap {
    /// Creates the map of a picture of this size, with sums of zero.
    fn new(picture: [u32; 2]) -> Self {
        Self::of_blocks(picture, Self::side(picture))
    }

    /// Returns the side in pixels of a block for a picture of this size.
    pub(super) fn side(picture: [u32; 2]) -> u32 {
        picture[0].max(picture[1]).div_ceil(MAX_SIDE)
    }

    /// Returns the map of a picture's values for blocks with this side.
    pub(super) fn of_pixels(picture: [u32; 2], side: u32, values: &[f32]) -> Self {
        let mut map = Self::of_blocks(picture, side);
        map.add(0, values);
        map.means()
    }

    fn of_blocks(picture: [u32; 2], side: u32) -> Self {
        let size = picture.map(|n| (n / side).max(1));
        Self {
            side,
            size,
            width: picture[0],
            values: vec![0.0; size[0] as usize * size[1] as usize],
        }
    }

    /// Adds rows of values, starting at this row of the picture. Rows and columns past the last
    /// whole block are left out.
    fn add(&mut self, first_row: u32, values: &[f32]) {
        let [n_columns, n_rows] = self.size.map(|n| n as usize);
        let side = self.side as usize;
        for (row, y) in values.chunks_exact(self.width as usize).zip(first_row..) {
            let block_row = y as usize / side;
            if block_row >= n_rows {
                return;
            }
            let sums = &mut self.values[block_row * n_columns..][..n_columns];
            for (sum, block) in sums.iter_mut().zip(row.chunks_exact(side)) {
                *sum += block.iter().sum::<f32>();
            }
        }
    }

    /// Turns the sums into means.
    fn means(mut self) -> Self {
        let n = (self.side * self.side) as f32;
        self.values.iter_mut().for_each(|value| *value /= n);
        self
    }
}
