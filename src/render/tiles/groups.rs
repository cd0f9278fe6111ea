//! Renders groups of neighboring pixels, whose paths are traced together, and times each: pixels
//! get their shares of its time.

use super::TileRenderer;
use super::stopwatch::{SPIKE, Stopwatch, ThreadTimer};
use super::stream::StreamRenderer;
use super::view::View;
use super::wave_times::{ByStage, StageColumns};
use crate::film::{PixelTime, Rendered};
use crate::schedule::Tile;
use tracer::cost::{BounceCounts, Clock, Counters, CpuWait};

/// Disturbed groups that take longer are not rendered again.
const LONG_NS: f32 = 2e5;

/// The part of a thread's time in which doubtful groups are rendered again: some take longer than
/// expected each time.
const MOST_AGAIN: f64 = 0.01;

/// Renders tiles group by group, and times each.
pub(super) struct GroupRenderer<'a> {
    clock: &'a Clock,
    stream: StreamRenderer<'a, Counters>,
    /// Samples of every pixel; 0 if they are counted.
    n_samples: u32,
    groups: Vec<Tile>,
    /// The times of the groups, and the times of their stages.
    times: Vec<PixelTime>,
    stages_ns: Vec<ByStage>,
    /// The counts of the stages for each pixel and for each group.
    counts: StageColumns,
    sums: Vec<ByStage>,
    /// The nanoseconds per count in the last group that was not disturbed and counted any.
    usual: ByStage,
    /// The times of the pixels, row by row, and 1 for each rejected pixel.
    time_ns: Vec<f32>,
    n_rejected: Vec<u8>,
    /// The counters of discarded renderings of pixels.
    uncounted: (Counters, BounceCounts),
    /// True if the thread has rendered a group.
    is_warm: bool,
    /// The nanoseconds in which groups were rendered, and in which some were rendered again.
    total_ns: f64,
    again_ns: f64,
    /// The nanoseconds spent on groups of the last part of a tile, those discarded included.
    in_groups_ns: f64,
    /// Number of pixels that the thread has rendered, and the nanoseconds that it spent on them
    /// outside of groups.
    outside: (f64, f64),
}

impl<'a> GroupRenderer<'a> {
    pub(super) fn new(view: View<'a>, clock: &'a Clock) -> Self {
        Self {
            clock,
            stream: StreamRenderer::timed(view, clock),
            n_samples: view.rounds.n_uniform(),
            groups: Vec::new(),
            times: Vec::new(),
            stages_ns: Vec::new(),
            counts: StageColumns::default(),
            sums: Vec::new(),
            usual: ByStage::default(),
            time_ns: Vec::new(),
            n_rejected: Vec::new(),
            uncounted: (Counters::default(), BounceCounts::new(view.counts_bounces)),
            is_warm: false,
            total_ns: 0.0,
            again_ns: 0.0,
            in_groups_ns: 0.0,
            outside: (0.0, 0.0),
        }
    }

    /// Renders a group of a part of a tile twice. Returns the nanoseconds that its pixels took the
    /// second time, row by row.
    pub(super) fn time_group<'p>(
        &'p mut self,
        part: &'p Tile,
        group: &'p Tile,
        wait: &mut CpuWait,
    ) -> impl Iterator<Item = f32> + use<'p, 'a> {
        self.begin(part, |other| other == group);
        self.render_groups(part, wait);
        self.render_groups(part, wait);
        self.split(part);
        part.rows_of(group)
            .flat_map(|row| &self.time_ns[row])
            .copied()
    }

    /// Starts with the groups of a tile that are wanted.
    fn begin(&mut self, tile: &Tile, is_wanted: impl FnMut(&Tile) -> bool) {
        self.groups.clear();
        self.groups
            .extend(tile.groups(self.n_samples).filter(is_wanted));
        self.times.clear();
        self.times.resize(self.groups.len(), PixelTime::default());
        self.stages_ns.resize(self.groups.len(), ByStage::default());
        self.time_ns.resize(tile.n_pixels(), 0.0);
        self.n_rejected.resize(tile.n_pixels(), 0);
    }

    /// Renders the groups of a tile, and those with disturbed or doubtful times again. Returns the
    /// nanoseconds spent on discarded renderings of pixels.
    fn render_groups(&mut self, tile: &Tile, wait: &mut CpuWait) -> f64 {
        let Self {
            clock,
            stream,
            groups,
            times,
            stages_ns,
            counts,
            sums,
            usual,
            ..
        } = self;
        let n_pixels = tile.n_pixels();
        let mut stopwatch = Stopwatch::new(ThreadTimer { clock, wait });
        let mut warm_up_ns = 0.0;
        if !self.is_warm {
            self.is_warm = true;
            warm_up_ns = stopwatch.time(|_| {
                stream.begin(n_pixels);
                stream.render_group(tile, &groups[0]);
            });
        }
        stream.begin(n_pixels);
        let n_done = stopwatch.time_each(times, |i| {
            stages_ns[i] = stream.render_group(tile, &groups[i]);
        });
        let in_groups: f64 = times.iter().map(|time| f64::from(time.ns)).sum();
        stream.count_stages(tile, groups, counts, sums);
        self.total_ns += in_groups;
        let may_doubt = self.again_ns <= MOST_AGAIN * self.total_ns;
        let is_doubtful = |times: &[PixelTime], i: usize| {
            let expected_ns = dot(&sums[i], usual);
            may_doubt && expected_ns > 0.0 && times[i].ns > SPIKE * expected_ns
        };
        stream.exchange_counters(&mut self.uncounted, false);
        let again_ns = stopwatch.time(|stopwatch| {
            stopwatch.time_again(&mut times[..n_done], LONG_NS, is_doubtful, |i| {
                stream.begin(n_pixels);
                stages_ns[i] = stream.render_group(tile, &groups[i]);
            });
        });
        stream.exchange_counters(&mut self.uncounted, true);
        self.again_ns += again_ns;
        let discarded_ns = warm_up_ns + again_ns;
        self.in_groups_ns = in_groups + discarded_ns;
        discarded_ns
    }

    /// Gives each pixel its share of its group's time, and the mean of the thread's work outside of
    /// groups until now. The stages of a group that was disturbed include the wait for a CPU: they
    /// count as in the group before.
    fn split(&mut self, tile: &Tile) {
        let (n_pixels, ns) = self.outside;
        let outside_ns = (ns / n_pixels.max(1.0)) as f32;
        for (i, group) in self.groups.iter().enumerate() {
            let (time, sums) = (self.times[i], &self.sums[i]);
            if !time.is_rejected || self.usual == ByStage::default() {
                for (stage, usual) in self.usual.iter_mut().enumerate() {
                    if sums[stage] > 0.0 {
                        *usual = self.stages_ns[i][stage] / sums[stage];
                    }
                }
            }
            let scale = time.ns / dot(sums, &self.usual).max(1.0);
            let ns_per_count = self.usual.map(|ns| ns * scale);
            let is_rejected = time.is_rejected && time.ns < LONG_NS;
            for row in tile.rows_of(group) {
                self.n_rejected[row.clone()].fill(is_rejected.into());
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

/// Returns the nanoseconds of these counts.
fn dot(counts: &ByStage, ns_per_count: &ByStage) -> f32 {
    counts.iter().zip(ns_per_count).map(|(n, ns)| n * ns).sum()
}

impl TileRenderer for GroupRenderer<'_> {
    fn render(&mut self, tile: &Tile, wait: &mut CpuWait) -> Rendered<'_> {
        self.begin(tile, |_| true);
        let warm_up_ns = self.render_groups(tile, wait);
        self.split(tile);
        Rendered {
            time_ns: &self.time_ns,
            n_rejected: &self.n_rejected,
            warm_up_ns,
            ..self.stream.rendered()
        }
    }

    fn has_rendered(&mut self, n_pixels: usize, ns: u64) {
        self.outside.0 += n_pixels as f64;
        self.outside.1 += (ns as f64 - self.in_groups_ns).max(0.0);
    }
}
