//! Renders groups of neighboring pixels, whose paths are traced together, and times each: pixels
//! get their shares of its time.

use super::TileRenderer;
use super::sample_plan::SamplePlanner;
use super::stream::StreamRenderer;
use super::view::View;
use super::wave_times::{ByStage, StageColumns};
use crate::film::Rendered;
use crate::schedule::Tile;
use base::stop;
use tracer::cost::{Clock, Counters, Stopwatch};

/// Renders tiles group by group, and times each.
pub(super) struct GroupRenderer<'a> {
    stream: StreamRenderer<'a, Counters>,
    /// Plans the samples of pixels, if efficiency decides.
    planner: Option<SamplePlanner<'a>>,
    /// Samples of every pixel; 0 if they are counted.
    n_samples: u32,
    groups: Vec<Tile>,
    /// The nanoseconds of the stages of each group.
    stages_ns: Vec<ByStage>,
    /// The counts of the stages for each pixel and for each group.
    counts: StageColumns,
    sums: Vec<ByStage>,
    /// The times of the pixels, row by row.
    time_ns: Vec<f32>,
    /// True if the thread has rendered a group.
    is_warm: bool,
    warm_up_ns: f64,
    outside: OutsideTime,
}

/// The work of a thread outside of groups: it clears buffers, splits times, and stores pixels.
#[derive(Debug, Default)]
struct OutsideTime {
    /// The nanoseconds spent on groups of the last part of a tile, and to warm up.
    in_groups_ns: f64,
    /// Number of pixels that the thread has rendered, and the nanoseconds outside of groups.
    n_pixels: f64,
    ns: f64,
    /// The nanoseconds that pixels were charged.
    charged_ns: f64,
    /// True if the thread has stored pixels.
    is_warm: bool,
}

impl OutsideTime {
    /// Charges the next pixels the mean until now, in nanoseconds each: all pixels together at most
    /// the time that was spent.
    fn charge(&mut self, n_pixels: usize) -> f32 {
        let n_pixels = n_pixels as f64;
        let mean_ns = self.ns / self.n_pixels.max(1.0);
        let ns = (mean_ns * n_pixels).min(self.ns - self.charged_ns);
        self.charged_ns += ns;
        (ns / n_pixels) as f32
    }

    /// Adds the nanoseconds spent outside of groups for these pixels. Returns those of the first
    /// ones, which include the first writes to memory: they are warm-up and not charged.
    fn add(&mut self, n_pixels: usize, ns: f64) -> f64 {
        let ns = (ns - self.in_groups_ns).max(0.0);
        if !std::mem::replace(&mut self.is_warm, true) {
            return ns;
        }
        self.n_pixels += n_pixels as f64;
        self.ns += ns;
        0.0
    }
}

impl<'a> GroupRenderer<'a> {
    pub(super) fn new(view: View<'a>, clock: &Clock) -> Self {
        Self {
            stream: StreamRenderer::timed(view, clock),
            planner: SamplePlanner::of(view),
            n_samples: view.rounds.n_uniform(),
            groups: Vec::new(),
            stages_ns: Vec::new(),
            counts: StageColumns::default(),
            sums: Vec::new(),
            time_ns: Vec::new(),
            is_warm: false,
            warm_up_ns: 0.0,
            outside: OutsideTime::default(),
        }
    }

    /// Renders a group of a part of a tile twice. Returns the nanoseconds that its pixels took the
    /// second time, row by row.
    pub(super) fn time_group(&mut self, part: &Tile, group: &Tile) -> Vec<f32> {
        self.begin(part, |other| other == group);
        self.is_warm = false;
        self.render_groups(part);
        let rows = part.rows_of(group);
        rows.flat_map(|row| &self.time_ns[row]).copied().collect()
    }

    /// Starts with the groups of a tile that are wanted.
    fn begin(&mut self, tile: &Tile, is_wanted: impl FnMut(&Tile) -> bool) {
        self.groups.clear();
        self.groups
            .extend(tile.groups(self.n_samples).filter(is_wanted));
        self.time_ns.resize(tile.n_pixels(), 0.0);
    }

    /// Renders the groups of a tile, the first of a thread twice, and splits their times. Planning
    /// their samples is part of the warm-up.
    fn render_groups(&mut self, tile: &Tile) {
        let n_pixels = tile.n_pixels();
        let stream = &mut self.stream;
        let begin_ns = stream.stopwatch().cpu_ns();
        if let Some(planner) = &mut self.planner {
            planner.plan(tile, &mut stream.planned);
        }
        if !std::mem::replace(&mut self.is_warm, true) {
            stream.begin(n_pixels);
            stream.render_group(tile, &self.groups[0]);
        }
        self.warm_up_ns = stream.stopwatch().cpu_ns() - begin_ns;
        stream.begin(n_pixels);
        stream.stopwatch().lap();
        self.stages_ns.clear();
        for group in &self.groups {
            if stop::is_requested() {
                break;
            }
            self.stages_ns.push(stream.render_group(tile, group));
        }
        stream.count_stages(tile, &self.groups, &mut self.counts, &mut self.sums);
        self.split(tile);
    }

    /// Gives each pixel its share of its group's time, and of the work outside of groups.
    fn split(&mut self, tile: &Tile) {
        self.outside.in_groups_ns = self.warm_up_ns;
        let outside_ns = self.outside.charge(tile.n_pixels());
        for ((group, sums), stages_ns) in self.groups.iter().zip(&self.sums).zip(&self.stages_ns) {
            let group_ns: f32 = stages_ns.iter().sum();
            self.outside.in_groups_ns += f64::from(group_ns);
            let ns_per_count = ns_per_count(stages_ns, sums);
            for row in tile.rows_of(group) {
                let time_ns = &mut self.time_ns[row.clone()];
                time_ns.fill(outside_ns);
                for (column, ns_per_count) in self.counts.iter().zip(ns_per_count) {
                    for (ns, n) in time_ns.iter_mut().zip(&column[row.clone()]) {
                        *ns += n * ns_per_count;
                    }
                }
            }
        }
        self.time_ns.iter_mut().for_each(|ns| *ns = ns.max(1.0));
    }
}

/// Returns the nanoseconds per count of each stage. The time of stages without counts is part of
/// the others, so that the counts take the time of all stages.
fn ns_per_count(stages_ns: &ByStage, sums: &ByStage) -> ByStage {
    let counted = stages_ns.iter().zip(sums).filter(|(_, sum)| **sum > 0.0);
    let counted_ns: f32 = counted.map(|(ns, _)| ns).sum();
    let scale = stages_ns.iter().sum::<f32>() / counted_ns.max(f32::MIN_POSITIVE);
    std::array::from_fn(|stage| match sums[stage] {
        0.0 => 0.0,
        sum => scale * stages_ns[stage] / sum,
    })
}

impl TileRenderer for GroupRenderer<'_> {
    fn render(&mut self, tile: &Tile) {
        self.begin(tile, |_| true);
        self.render_groups(tile);
    }

    fn rendered(&mut self) -> Rendered<'_> {
        Rendered {
            time_ns: &self.time_ns,
            warm_up_ns: self.warm_up_ns,
            ..self.stream.rendered()
        }
    }

    fn stopwatch(&mut self) -> &mut Stopwatch {
        self.stream.stopwatch()
    }

    fn add_rendered(&mut self, n_pixels: usize, ns: f64) -> f64 {
        self.outside.add(n_pixels, ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shares_of_pixels_add_up_to_the_group() {
        let stages_ns = [9000.0, 700.0, 55.0, 1200.0];
        for sums in [
            [50.0, 8.0, 3.0, 256.0],
            [50.0, 0.0, 0.0, 256.0],
            [0.0, 0.0, 0.0, 1.0],
        ] {
            let per_count = ns_per_count(&stages_ns, &sums);
            let sum: f32 = sums.iter().zip(per_count).map(|(n, ns)| n * ns).sum();
            assert!((sum - 10_955.0).abs() < 0.01, "{sum}");
        }
        // A share is proportional to the time of its own stage.
        let per_count = ns_per_count(&stages_ns, &[10.0, 10.0, 10.0, 10.0]);
        assert_eq!(per_count, [900.0, 70.0, 5.5, 120.0]);
        assert_eq!(ns_per_count(&stages_ns, &[0.0; 4]), [0.0; 4]);
    }

    #[test]
    fn work_outside_of_groups_is_charged_once() {
        let mut outside = OutsideTime::default();
        let (mut charged, mut warm_up_ns) = (0.0, 0.0);
        // The first writes to memory take longer.
        for (i, n_pixels) in [256, 256, 256, 64, 256, 256, 256, 64, 256]
            .into_iter()
            .enumerate()
        {
            charged += f64::from(outside.charge(n_pixels)) * n_pixels as f64;
            assert!(charged <= outside.ns * (1.0 + 1e-6));
            outside.in_groups_ns = 9000.0;
            let ns = 8.0 * n_pixels as f64 + if i == 0 { 90_000.0 } else { 0.0 };
            warm_up_ns += outside.add(n_pixels, 9000.0 + ns);
        }
        assert_eq!(warm_up_ns, 92_048.0);
        // What the last pixels took is charged to the next ones.
        assert!(
            (charged + 8.0 * 256.0 - outside.ns).abs() < 1.0,
            "{charged} of {}",
            outside.ns
        );
    }
}
