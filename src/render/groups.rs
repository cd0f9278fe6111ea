//! Renders groups of neighboring pixels, whose paths are traced together, and times each:
//! pixels get their shares of its time.

use super::TileRenderer;
use super::stopwatch::{LONG_NS, Stopwatch, ThreadTimer};
use super::stream::StreamRenderer;
use super::view::View;
use super::wave_times::ByStage;
use crate::cost::{BounceCounts, Clock, Counters, CpuWait};
use crate::film::{PixelTime, Rendered};
use crate::schedule::Tile;

/// Renders tiles group by group, and times each.
pub(super) struct GroupRenderer<'a> {
    clock: &'a Clock,
    stream: StreamRenderer<'a, Counters>,
    /// Samples of every pixel; 0 if they are counted.
    n_samples: u32,
    groups: Vec<Tile>,
    /// The times of the groups, and those of their stages.
    times: Vec<PixelTime>,
    stages_ns: Vec<ByStage>,
    /// What the stages counted of each group.
    counts: Vec<ByStage>,
    /// The nanoseconds per count in the last group that was not disturbed and counted any.
    usual: ByStage,
    /// The times of the pixels, row by row.
    of_pixels: Vec<PixelTime>,
    /// The counters of what is rendered again, which count for nothing.
    uncounted: (Counters, BounceCounts),
    /// Whether the thread has rendered a group.
    is_warm: bool,
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
            counts: Vec::new(),
            usual: ByStage::default(),
            of_pixels: Vec::new(),
            uncounted: (Counters::default(), BounceCounts::new(view.counts_bounces)),
            is_warm: false,
        }
    }

    /// Renders the group of a pixel of this part of a tile twice; returns the nanoseconds that
    /// the pixel took the second time.
    pub(super) fn time_pixel(&mut self, part: &Tile, at: (u32, u32), wait: &mut CpuWait) -> f32 {
        self.begin(part, |group| group.has(at));
        self.render_groups(part, wait);
        self.render_groups(part, wait);
        self.split(part);
        self.of_pixels[part.index(at) as usize].ns
    }

    /// Begins with those groups of a tile that are wanted.
    fn begin(&mut self, tile: &Tile, is_wanted: impl FnMut(&Tile) -> bool) {
        self.groups.clear();
        self.groups
            .extend(tile.groups(self.n_samples).filter(is_wanted));
        self.times.clear();
        self.times.resize(self.groups.len(), PixelTime::default());
        self.stages_ns.resize(self.groups.len(), ByStage::default());
        self.of_pixels.clear();
        self.of_pixels.resize(tile.n_pixels(), PixelTime::default());
    }

    /// Renders the groups of a tile, and those again whose times are disturbed or doubtful.
    /// Returns the nanoseconds in which pixels were rendered that count for nothing.
    fn render_groups(&mut self, tile: &Tile, wait: &mut CpuWait) -> f64 {
        let Self {
            clock,
            stream,
            groups,
            times,
            stages_ns,
            counts,
            ..
        } = self;
        let n_pixels = tile.n_pixels();
        let mut stopwatch = Stopwatch::new(ThreadTimer { clock, wait });
        let mut warm_up_ns = 0.0;
        stream.begin(n_pixels);
        if !self.is_warm {
            self.is_warm = true;
            warm_up_ns = stopwatch.time(|_| {
                stream.render_group(tile, &groups[0]);
            });
            stream.begin(n_pixels);
        }
        let n_done = stopwatch.time_each(times, |i| {
            stages_ns[i] = stream.render_group(tile, &groups[i]);
        });
        counts.clear();
        counts.extend(groups.iter().map(|group| sum(stream, tile, group)));
        let work = |i: usize| counts[i].iter().sum::<f64>().max(1.0) as f32;
        stream.exchange_counters(&mut self.uncounted, false);
        let again_ns = stopwatch.time(|stopwatch| {
            stopwatch.time_again(&mut times[..n_done], work, |i| {
                stream.begin(n_pixels);
                stages_ns[i] = stream.render_group(tile, &groups[i]);
            });
        });
        stream.exchange_counters(&mut self.uncounted, true);
        warm_up_ns + again_ns
    }

    /// Gives each pixel its share of its group's time. The stages of a group that was disturbed
    /// include the wait for a CPU: they count as in the group before.
    fn split(&mut self, tile: &Tile) {
        for (i, group) in self.groups.iter().enumerate() {
            let (time, counts) = (self.times[i], &self.counts[i]);
            if !time.is_rejected || self.usual == ByStage::default() {
                for (stage, usual) in self.usual.iter_mut().enumerate() {
                    if counts[stage] > 0.0 {
                        *usual = self.stages_ns[i][stage] / counts[stage];
                    }
                }
            }
            let terms = counts.iter().zip(self.usual);
            let modeled_ns: f64 = terms.map(|(n, ns)| n * ns).sum();
            let scale = f64::from(time.ns) / modeled_ns.max(1.0);
            let is_rejected = time.is_rejected && time.ns < LONG_NS;
            for at in group.pixels() {
                let pixel = tile.index(at);
                let terms = self.stream.counts(pixel).into_iter().zip(self.usual);
                let ns: f64 = terms.map(|(n, ns)| n * ns).sum();
                let ns = ((ns * scale) as f32).max(1.0);
                self.of_pixels[pixel as usize] = PixelTime { ns, is_rejected };
            }
        }
    }
}

/// What the stages counted of a group.
fn sum(stream: &StreamRenderer<Counters>, tile: &Tile, group: &Tile) -> ByStage {
    let mut sums = ByStage::default();
    for at in group.pixels() {
        let counts = stream.counts(tile.index(at));
        sums.iter_mut().zip(counts).for_each(|(sum, n)| *sum += n);
    }
    sums
}

impl TileRenderer for GroupRenderer<'_> {
    fn render(&mut self, tile: &Tile, wait: &mut CpuWait) -> Rendered<'_> {
        self.begin(tile, |_| true);
        let warm_up_ns = self.render_groups(tile, wait);
        self.split(tile);
        Rendered {
            times: &self.of_pixels,
            warm_up_ns,
            ..self.stream.rendered()
        }
    }
}
