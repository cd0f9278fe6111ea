//! Statistics of all pixels together, for the files.

use rayon::prelude::*;

use super::distances::Distances;
use super::reduced_map::ReducedMap;
use super::run::PixelHashes;
use crate::chart::Range;
use math::statistics::{Histogram, sum};
use render::film::{Film, HotPixel, Strip};
use tracer::cost::Metric;

/// Parts per thread in which the pixels are counted: more of them share the work more evenly.
const PARTS_PER_THREAD: usize = 2;

/// Statistics of all pixels of a picture together. Quantiles are exact to .05 %, and exact for
/// counts up to 4096: one pass finds them, even over a picture that does not fit into memory.
#[derive(Debug, Clone)]
pub struct Survey {
    pub(super) hashes: PixelHashes,
    pub(super) n_hits: u64,
    /// The number of pixels whose noise fell below a limit; 0 unless samples are counted.
    pub(super) n_below_noise: u64,
    /// The sum of the times in nanoseconds.
    pub time_ns: f64,
    /// The sum of the times' median absolute deviations in nanoseconds.
    pub time_mad_ns: f64,
    /// The most expensive pixel by time, if times can be trusted, and by node visits, or by
    /// primitive tests without a hierarchy.
    pub hottest: [Option<(Metric, HotPixel)>; 2],
    /// The two metrics of heatmaps; `None` without cost.
    pub(super) metrics: Option<[Metric; 2]>,
    /// The range of the first heatmap metric; of the distance without cost.
    pub(super) range: Range,
    pub(super) median: f32,
    pub(super) sum: f64,
    /// The two metrics of the files that states show; the files may leave out the heatmaps'
    /// metrics.
    pub(super) shown: [Option<Metric>; 2],
    /// The range of the first shown metric; of the distance without one.
    pub(super) shown_range: Range,
    /// The range of the second shown metric.
    pub(super) counter_range: Range,
    pub(super) distances: Distances,
    /// The first heatmap metric as a map that fits into memory; `None` if the film has all pixels.
    pub(super) map: Option<ReducedMap>,
}

impl Survey {
    /// Surveys a film that has all pixels, on the current rayon pool.
    pub fn measure(film: &Film) -> Self {
        let mut surveyor = Surveyor::new(film);
        surveyor.add(film);
        surveyor.finish()
    }
}

/// Surveys a picture, band by band from top to bottom.
pub(super) struct Surveyor {
    metrics: Option<[Metric; 2]>,
    shown: [Option<Metric>; 2],
    hashes: PixelHashes,
    n_hits: u64,
    n_below_noise: u64,
    /// The sums of the times and of their deviations.
    times: [f64; 2],
    hottest: [Option<(Metric, HotPixel)>; 2],
    histograms: SurveyHistograms,
    map: Option<ReducedMap>,
}

/// The values of some pixels.
#[derive(Default)]
struct SurveyHistograms {
    /// The first heatmap metric, and its sum in each strip.
    cost: Histogram,
    sums: Vec<f64>,
    /// The first shown metric, if it is another one.
    shown: Histogram,
    /// The second shown metric.
    counter: Histogram,
    distances: Histogram,
}

impl Surveyor {
    /// Creates a surveyor for the picture of this film: of its pixels, if it has them, or of bands
    /// that are read later.
    pub fn new(film: &Film) -> Self {
        Self {
            metrics: film.heatmap_metrics(),
            shown: film.metrics_in_files(),
            hashes: PixelHashes::default(),
            n_hits: 0,
            n_below_noise: 0,
            times: [0.0; 2],
            hottest: [None; 2],
            histograms: SurveyHistograms::default(),
            map: (!film.has_rows()).then(|| ReducedMap::new([film.grid.width, film.grid.height])),
        }
    }

    /// Takes the next band, on the current rayon pool.
    pub fn add(&mut self, band: &Film) {
        let n_parts = PARTS_PER_THREAD * rayon::current_num_threads();
        let parts = band
            .strips
            .par_chunks(band.strips.len().div_ceil(n_parts).max(1));
        let (metrics, shown) = (self.metrics, self.shown);
        let parts = parts.map(|strips| SurveyHistograms::new(band, strips, metrics, shown));
        let (hottest, parts) = rayon::join(
            || band.hottest_by_metrics(),
            || parts.collect::<Vec<SurveyHistograms>>(),
        );
        parts.into_iter().for_each(|part| self.histograms.add(part));
        for (so_far, found) in self.hottest.iter_mut().zip(hottest) {
            *so_far = hotter(*so_far, found);
        }
        if let (Some(map), Some([first, _])) = (&mut self.map, metrics) {
            for_each_strip(band, &band.strips, first, |strip, values| {
                map.add(strip.first_row, values);
            });
        }
        self.hashes.add(band);
        self.n_hits += band.n_hits() as u64;
        self.n_below_noise += band.n_below_noise();
        self.times[0] += band.total_time_ns();
        self.times[1] += band.total_time_mad_ns();
    }

    /// Returns the survey of all bands.
    pub fn finish(self) -> Survey {
        let SurveyHistograms {
            cost,
            sums,
            shown,
            counter,
            distances,
        } = self.histograms;
        let of_distances = || Range::from_histogram(&distances);
        let range = self
            .metrics
            .map_or_else(of_distances, |_| Range::from_histogram(&cost));
        let shown_range = match self.shown[0] {
            Some(first) if is_first(self.metrics, first) => range,
            Some(_) => Range::from_histogram(&shown),
            None => of_distances(),
        };
        let [time_ns, time_mad_ns] = self.times;
        Survey {
            hashes: self.hashes,
            n_hits: self.n_hits,
            n_below_noise: self.n_below_noise,
            time_ns,
            time_mad_ns,
            hottest: self.hottest,
            metrics: self.metrics,
            range,
            median: cost.at(cost.n / 2).unwrap_or_default(),
            sum: sums.into_iter().sum(),
            shown: self.shown,
            shown_range,
            counter_range: Range::from_histogram(&counter),
            distances: Distances::from_histogram(&distances),
            map: self.map.map(ReducedMap::means),
        }
    }
}

impl SurveyHistograms {
    /// Counts the values of some strips of a film.
    fn new(
        film: &Film,
        strips: &[Strip],
        metrics: Option<[Metric; 2]>,
        in_files: [Option<Metric>; 2],
    ) -> Self {
        let mut histograms = Self::default();
        if let Some([first, _]) = metrics {
            for_each_strip(film, strips, first, |_, values| {
                histograms.cost.add(values.iter().copied());
                histograms.sums.push(sum(values));
            });
        }
        let [first, second] = in_files;
        let other = first.filter(|&first| !is_first(metrics, first));
        let shown = [
            (other, &mut histograms.shown),
            (second, &mut histograms.counter),
        ];
        for (metric, histogram) in shown {
            if let Some(metric) = metric {
                for_each_strip(film, strips, metric, |_, values| {
                    histogram.add(values.iter().copied());
                });
            }
        }
        for strip in strips {
            histograms.distances.add(strip.distance.iter().copied());
        }
        histograms
    }

    /// Adds the values of the next strips.
    fn add(&mut self, next: Self) {
        self.cost.merge(&next.cost);
        self.sums.extend(next.sums);
        self.shown.merge(&next.shown);
        self.counter.merge(&next.counter);
        self.distances.merge(&next.distances);
    }
}

/// Returns true if this is the first metric of heatmaps.
fn is_first(metrics: Option<[Metric; 2]>, metric: Metric) -> bool {
    metrics.is_some_and(|[first, _]| first == metric)
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

/// Calls `take` with each of a film's strips and a metric of its pixels.
fn for_each_strip(
    film: &Film,
    strips: &[Strip],
    metric: Metric,
    mut take: impl FnMut(&Strip, &[f32]),
) {
    let mut values = Vec::new();
    for strip in strips {
        film.costs(strip, metric, &mut values);
        take(strip, &values);
    }
}
