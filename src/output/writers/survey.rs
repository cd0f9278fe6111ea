//! Statistics of all pixels together, for the files.

use super::distances::Distances;
use super::run::PixelHashes;
use crate::chart::Range;
use math::statistics::{floats_at, lower_edge};
use render::film::{Film, HotPixel};
use tracer::cost::Metric;

/// Statistics of all pixels of a picture together. Quantiles are exact to .05 %, and exact for
/// counts up to 4096: one pass finds them, even over a picture that does not fit into memory.
#[derive(Debug, Clone)]
pub struct Survey {
    pub(super) hashes: PixelHashes,
    pub(super) n_hits: u64,
    /// The sum of the times in nanoseconds.
    pub time_ns: f64,
    /// The sum of the times' median absolute deviations in nanoseconds.
    pub time_mad_ns: f64,
    /// Number of rejected times.
    pub n_rejected: u64,
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
    /// The 0.5 % and the 99.5 % quantile of the second shown metric.
    pub(super) counter_ends: [f64; 2],
    pub(super) distances: Distances,
    /// The first heatmap metric as a map that fits into memory; `None` if the film has all pixels.
    pub(super) map: Option<ReducedMap>,
}

/// The map of a picture that does not fit into memory, as means of blocks of pixels.
#[derive(Debug, Clone)]
pub(super) struct ReducedMap {
    /// Pixels along the side of a block.
    pub(super) side: u32,
    /// Columns and rows.
    pub(super) size: [u32; 2],
    /// Columns of the picture.
    pub(super) width: u32,
    pub(super) values: Vec<f32>,
}

impl Survey {
    /// Surveys a film that has all pixels, on the current rayon pool.
    pub fn measure(film: &Film) -> Self {
        let metrics = film.heatmap_metrics();
        let shown = film.metrics_in_files();
        let mut hashes = PixelHashes::default();
        // Survey hashes, distances and counts, and concurrently the cost of heatmaps.
        let ((distances, counter_ends), (range, median, sum)) = rayon::join(
            || {
                hashes.add(film);
                let ends = shown[1].map(|second| counter_ends(&film.metric(second)));
                (Distances::collect(film), ends.unwrap_or_default())
            },
            || match metrics {
                Some([first, _]) => {
                    let values = film.metric(first);
                    let sum = values.iter().copied().map(f64::from).sum();
                    let [median] = floats_at(&values, [values.len() / 2]).unwrap_or_default();
                    (Range::spanning(&values), lower_edge(median), sum)
                }
                None => {
                    let distances = film.rows(|strip| &strip.distance).flatten();
                    (Range::spanning(distances), 0.0, 0.0)
                }
            },
        );
        // Files that leave out the heatmaps' metrics show another one.
        let shown_range = match shown[0] {
            Some(first) if metrics.is_none_or(|[metric, _]| metric != first) => {
                Range::spanning(&film.metric(first))
            }
            Some(_) => range,
            None if metrics.is_none() => range,
            None => Range::spanning(film.rows(|strip| &strip.distance).flatten()),
        };
        Self {
            hashes,
            n_hits: film.n_hits() as u64,
            time_ns: film.total_time_ns(),
            time_mad_ns: film.total_time_mad_ns(),
            n_rejected: film.n_rejected(),
            hottest: film.hottest_by_metrics(),
            metrics,
            range,
            median,
            sum,
            shown,
            shown_range,
            counter_ends,
            distances,
            map: None,
        }
    }
}

/// Returns the 0.5 % and the 99.5 % quantile of counts.
fn counter_ends(counts: &[f32]) -> [f64; 2] {
    let indices = [1, 199].map(|part| counts.len().saturating_sub(1) * part / 200);
    let ends = floats_at(counts, indices).unwrap_or_default();
    ends.map(|count| lower_edge(count).into())
}
