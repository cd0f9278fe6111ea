//! Two outputs of the same size → the change of their costs from the first, A, to the second, B.
//! [`foreign`] compares an output with a file of another program.
//!
//! Compares two folders that `raycost render` wrote. A [`Diff`] is printed by [`report()`],
//! serialized by [`DiffJson`] and written to files by [`write()`]. Counters are exact: any change of
//! a counter is a change of the work. Times are noisy: a statistical test of the repeats decides if
//! they changed.

mod noise;
mod group;
mod picture;
mod light;
mod equal_noise;
mod settings;
mod kernels;
mod reached;
mod side;
mod change;
mod gate;
mod report;
mod json;
mod map;
mod volume;
mod state;
mod file;
mod files;
pub mod foreign;

pub use change::Change;
pub use equal_noise::EqualNoise;
pub use files::{refuse_foreign, write};
pub use gate::{Gate, Limit};
pub use group::PixelBounds;
pub use json::DiffJson;
pub use kernels::KernelTimes;
pub use light::LightDifference;
pub use noise::{Noise, Test};
pub use picture::PictureDifference;
pub use report::report;
pub(crate) use report::table;
pub use settings::Setting;
pub(crate) use settings::compare_runs;
pub use side::Side;
pub use state::FILE as STATE;

use group::{Groups, sorted};

use host::text::Diagnostic;
use scene::config::PictureWindow;
use tracer::cost::{Metric, MetricUnit};

/// The changes from A to B.
#[derive(Debug)]
pub struct Diff {
    /// Columns and rows of the pixels that both outputs show.
    pub size: [u32; 2],
    /// The costs of the whole frame.
    pub totals: Totals,
    /// Significance of the change of the time; `None` unless both outputs have times.
    pub noise: Option<Noise>,
    /// The change per pixel of one metric: of the time or, where one is missing, of node visits or
    /// primitive tests, whichever changed more.
    pub change: Change,
    /// The cost of the pixels that show each object, the greatest change first.
    pub objects: Vec<CostGroup>,
    /// The cost of all rays that hit each object, the greatest change first; empty unless both
    /// outputs have `objects.csv`.
    pub reached: Vec<CostGroup>,
    /// The tiles of B, the greatest change first.
    pub tiles: Vec<CostGroup>,
    /// The difference of the pictures.
    pub picture: PictureDifference,
    /// The difference of the light; `None` unless both outputs have the array `radiance`.
    pub light: Option<LightDifference>,
    /// The work for equal noise; `None` unless both outputs have the array `noise` and counters.
    pub equal_noise: Option<EqualNoise>,
    /// Pixels that show different objects in A and B.
    pub n_other_objects: u64,
    /// Pixels with different counters in A and B; `None` unless both outputs have a counter.
    pub n_other_counts: Option<u64>,
    /// The kernels that other devices than the processor ran for A and B.
    pub kernels: Vec<KernelTimes>,
    /// The settings that differ.
    pub settings: Vec<Setting>,
    /// The properties of machine and program that differ.
    pub machine: Vec<Setting>,
}

/// The total of one metric over some pixels, in A and in B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Total {
    /// The metric.
    pub metric: Metric,
    /// The totals of A and B.
    pub cost: [f64; 2],
}

/// The totals of the metrics that both outputs have, in the order of [`Metric::ALL`], and the
/// ratios that their scenes define.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Totals(pub Vec<Total>);

/// The pixels of an object or of a tile, or the rays that hit an object, and their costs.
#[derive(Debug, Clone, PartialEq)]
pub struct CostGroup {
    /// The name of the object or tile.
    pub name: String,
    /// The bounds of a tile; `None` for an object.
    pub bounds: Option<PixelBounds>,
    /// The costs of the group.
    pub totals: Totals,
}

/// Returns `b / a`: 1, no change, if both are 0, and infinite if only `a` is 0.
pub fn ratio([a, b]: [f64; 2]) -> f64 {
    if a == b { 1.0 } else { b / a }
}

impl Totals {
    /// Returns the totals of a metric in A and B, if both have it.
    pub fn cost(&self, metric: Metric) -> Option<[f64; 2]> {
        self.total(metric).map(|total| total.cost)
    }

    /// Returns the total of a metric, if both have it.
    pub fn total(&self, metric: Metric) -> Option<&Total> {
        self.0.iter().find(|total| total.metric == metric)
    }

    /// Adds the ratios of totals that both outputs have.
    pub(super) fn add_ratios(&mut self, ratios: &[Metric]) {
        for &metric in ratios {
            let parts = metric
                .parts()
                .map(|parts| parts.map(|part| self.cost(part)));
            if let Some([Some(above), Some(below)]) = parts {
                let ratio = |side: usize| match below[side] {
                    0.0 => 0.0,
                    below => above[side] / below,
                };
                let cost = [0, 1].map(ratio);
                self.0.push(Total { metric, cost });
            }
        }
    }

    /// Returns the sums of node visits and primitive tests in A and B.
    pub fn steps(&self) -> [f64; 2] {
        let costs = [Metric::NODE_VISITS, Metric::PRIMITIVE_TESTS];
        let [visits, tests] = costs.map(|metric| self.cost(metric).unwrap_or_default());
        [visits[0] + tests[0], visits[1] + tests[1]]
    }

    /// Returns the main cost in A and B: the time, or [`Self::steps`] where a time is missing.
    pub fn main(&self) -> [f64; 2] {
        self.cost(Metric::TIME).unwrap_or_else(|| self.steps())
    }
}

impl CostGroup {
    /// Returns the change B - A of the main cost ([`Totals::main`]).
    pub fn change(&self) -> f64 {
        let [a, b] = self.totals.main();
        b - a
    }
}

impl Diff {
    /// Returns the ratio B / A of a metric of the whole frame, as all reports show it: for times
    /// with repeats the Hodges-Lehmann estimate, which lies within the confidence interval shown
    /// beside it; otherwise the ratio of the totals.
    pub fn ratio(&self, total: &Total) -> f64 {
        let test = self.noise.as_ref().and_then(Noise::test);
        match test {
            Some(test) if total.metric == Metric::TIME => test.ratio.estimate,
            _ => ratio(total.cost),
        }
    }

    /// Compares two outputs.
    ///
    /// # Errors
    /// If the outputs show different pixels, have no cost in common, or cannot be read.
    pub fn compare(sides: &[Side; 2]) -> Result<Self, Diagnostic> {
        let size = common_size(sides)?;
        let metrics = common_metrics(sides)?;
        for side in sides {
            side.require(&["RGB", "object", "tile"])?;
            if !metrics.contains(&Metric::TIME) {
                side.require(&[Metric::NODE_VISITS.name, Metric::PRIMITIVE_TESTS.name])?;
            }
        }
        let [a, b] = sides;
        let groups = Groups::sum(sides, metrics)?;
        let mut totals = groups.totals();
        let has_counters = (totals.0.iter()).any(|total| total.metric.unit == MetricUnit::Count);
        let shown = shown_metric(&totals);
        let ratios = common_ratios(sides);
        totals.add_ratios(&ratios);
        totals.0.extend(idle_lanes(sides));
        let objects = sorted(groups.objects(sides), &ratios);
        let tiles = sorted(groups.tiles(), &ratios);
        let noise = match totals.cost(Metric::TIME) {
            // The repeats add up other pixels, too.
            Some(_) if sides.iter().any(Side::is_cut) => Some(Noise::Cut),
            Some(_) => Some(Noise::test_times(&a.repeats()?, &b.repeats()?)),
            None => None,
        };
        let values = [a, b].map(|side| settings::values(side.summary()));
        Ok(Self {
            size,
            totals,
            noise,
            change: Change::measure(sides, shown)?,
            objects,
            reached: sorted(reached::groups(sides)?, &ratios),
            tiles,
            picture: PictureDifference::measure(sides)?,
            light: LightDifference::measure(sides)?,
            equal_noise: EqualNoise::measure(sides)?,
            n_other_objects: groups.n_other_objects,
            n_other_counts: has_counters.then_some(groups.n_other_counts),
            kernels: kernels::compare(sides),
            settings: settings::compare_runs(&values),
            machine: settings::compare_machines(&values),
        })
    }
}

/// Chooses the metric of [`Diff::change`]. A metric whose total is 0 in A or B is not chosen:
/// without a hierarchy, for example, there are no node visits.
fn shown_metric(totals: &Totals) -> Metric {
    let is_in_both = |total: &&Total| total.cost.iter().all(|&cost| cost > 0.0);
    let change = |total: &Total| (total.cost[1] - total.cost[0]).abs();
    let steps = [Metric::PRIMITIVE_TESTS, Metric::NODE_VISITS];
    let in_both = || totals.0.iter().filter(is_in_both);
    let shown = in_both().find(|total| total.metric == Metric::TIME);
    let shown = shown.or_else(|| {
        let steps = in_both().filter(|total| steps.contains(&total.metric));
        steps.max_by(|x, y| change(x).total_cmp(&change(y)))
    });
    let shown = shown.or(totals.0.first());
    shown.map_or(Metric::NODE_VISITS, |total| total.metric)
}

/// Returns the metrics that both outputs have.
///
/// # Errors
/// If an output has no metric at all.
fn common_metrics(sides: &[Side; 2]) -> Result<Vec<Metric>, Diagnostic> {
    for side in sides {
        if !Metric::ALL.iter().any(|metric| side.has(*metric)) {
            let message = format!("`{}` holds no cost to compare", side.name());
            let help = match side.summary().arrays {
                None => "render it again without `--no-cost`",
                Some(_) => {
                    "add costs, such as `node_visits` and `primitive_tests`, to \
                            `output.arrays`, and render it again"
                }
            };
            return Err(Diagnostic::new(message).with_help(help));
        }
    }
    let is_common = |metric: &Metric| sides.iter().all(|side| side.has(*metric));
    Ok(Metric::ALL.into_iter().filter(is_common).collect())
}

/// Returns the metrics that the scenes of both outputs define in the same way, and that both have.
fn common_ratios(sides: &[Side; 2]) -> Vec<Metric> {
    let [a, b] = sides.each_ref().map(|side| {
        let metrics = Metric::ratios(side.summary().cost.ratio_metrics());
        metrics
            .filter(|metric| side.has(*metric))
            .collect::<Vec<_>>()
    });
    a.into_iter().filter(|metric| b.contains(metric)).collect()
}

/// Returns the shares of idle lanes; `None` unless both outputs have them, of the same pixels.
fn idle_lanes(sides: &[Side; 2]) -> Option<Total> {
    let metric = Metric::IDLE_LANES;
    if sides.iter().any(|side| side.is_cut() || !side.has(metric)) {
        return None;
    }
    let share = |side: &Side| side.summary().cost.total(metric.name);
    let [a, b] = sides.each_ref().map(share);
    let cost = [a?, b?];
    Some(Total { metric, cost })
}

fn common_size([a, b]: &[Side; 2]) -> Result<[u32; 2], Diagnostic> {
    if (a.size(), a.origin(), a.window().picture) == (b.size(), b.origin(), b.window().picture) {
        return Ok(a.size());
    }
    let what = if a.window().picture == b.window().picture {
        "outputs show no pixel in common"
    } else {
        "pictures differ in size"
    };
    let message = format!(
        "the {what}: `{}` has {}, `{}` has {} pixels",
        a.name(),
        a.place(),
        b.name(),
        b.place()
    );
    let PictureWindow { picture, origin } = a.window();
    let mut flags = format!("--width {} --height {}", picture[0], picture[1]);
    if a.size() != picture {
        let ([x, y], [width, height]) = (origin, a.size());
        flags += &format!(" --crop {x},{y},{width},{height}");
    }
    Err(Diagnostic::new(message).with_help(format!("render B again with `{flags}`")))
}
