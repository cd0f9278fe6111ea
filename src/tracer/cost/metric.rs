//! The cost metrics of pixels: one table, from which films, files, pictures, tables and pages take
//! names, labels and units.
//!
//! To add a metric, add its row to [`Metric::ALL`]; a counted metric also needs its row in the list
//! of [`Counter`]s, its field in [`Cost`], and the code that counts it.

use std::time::Duration;

use super::{Cost, Counter, StepCounter};
use super::{CostMode, RatioMetric, RatioMetrics};
use base::Keyword;
use base::numbers;

/// A cost metric of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Metric {
    /// Name of the metric's array in files.
    pub name: &'static str,
    /// Name in tables and menus.
    pub label: &'static str,
    /// Name of one value, in a sentence.
    pub title: &'static str,
    /// Description in one line.
    pub about: &'static str,
    /// Unit.
    pub unit: MetricUnit,
    /// How the values of several pixels combine.
    pub aggregation: Aggregation,
    /// True if values usually span decades, so that a logarithmic scale suits.
    pub spans_decades: bool,
    /// Origin of the values.
    pub source: MetricSource,
}

/// The unit of a cost metric.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MetricUnit {
    /// Time.
    Nanoseconds,
    /// A count of the things that the label names.
    Count,
    /// None: a ratio of two metrics.
    Ratio,
}

/// How the values of several pixels combine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Aggregation {
    /// The sum of the values.
    Sum,
    /// The greatest value.
    Max,
    /// The ratio of what the parts combine to.
    Ratio,
}

/// The origin of a metric's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MetricSource {
    /// The clock: the only source with noise.
    Clock,
    /// A counter.
    Counter(Counter),
    /// The sum of the rays of all kinds.
    AllRays,
    /// A count of the observation that follows a rendering, on request.
    Observed(StepCounter),
    /// The ratio of two metrics of the pixel; 0 if the second is 0.
    Ratio(&'static RatioMetric),
    /// The spread of the pixel's samples, on request.
    Noise,
    /// The spread of the samples and a cost, on request.
    Efficiency,
    /// The steps of rays that are traced in lockstep, on request.
    Lanes,
    /// The clock of a device, on request.
    DeviceClock,
}

const fn counter(name: &'static str, label: &'static str, counter: Counter) -> Metric {
    Metric {
        name,
        label,
        title: label,
        about: label,
        unit: MetricUnit::Count,
        aggregation: Aggregation::Sum,
        spans_decades: false,
        source: MetricSource::Counter(counter),
    }
}

const fn observed(name: &'static str, label: &'static str, counter: StepCounter) -> Metric {
    Metric {
        spans_decades: true,
        source: MetricSource::Observed(counter),
        ..self::counter(name, label, Counter::NodeVisits)
    }
}

impl Metric {
    /// Thread time.
    pub const TIME: Self = Self {
        title: "time per pixel",
        about: "thread time spent in the pixel",
        unit: MetricUnit::Nanoseconds,
        spans_decades: true,
        source: MetricSource::Clock,
        ..counter("time_ns", "time", Counter::NodeVisits)
    };
    /// BVH nodes visited.
    pub const NODE_VISITS: Self = Self {
        title: "BVH nodes visited per pixel",
        about: "BVH nodes visited by all rays of the pixel",
        spans_decades: true,
        ..counter("node_visits", "node visits", Counter::NodeVisits)
    };
    /// Ray-primitive tests.
    pub const PRIMITIVE_TESTS: Self = Self {
        title: "primitive tests per pixel",
        about: "tests of all rays of the pixel against primitives",
        spans_decades: true,
        ..counter(
            "primitive_tests",
            "primitive tests",
            Counter::PrimitiveTests,
        )
    };
    /// Rays of all kinds.
    pub const RAYS: Self = Self {
        title: "rays per pixel",
        about: "rays of all kinds",
        source: MetricSource::AllRays,
        ..counter("rays", "rays", Counter::ShadowRays)
    };
    /// Samples, where pixels have different numbers.
    pub const SAMPLES: Self = Self {
        title: "samples per pixel",
        about: "samples, each with its camera ray",
        ..counter("samples", "samples", Counter::Samples)
    };
    /// The longest path.
    pub const DEPTH: Self = Self {
        title: "bounces of the longest path per pixel",
        about: "bounces of the longest path of the pixel",
        aggregation: Aggregation::Max,
        ..counter("depth", "bounces", Counter::Depth)
    };

    /// The standard error of the pixel's light, on request.
    pub const NOISE: Self = Self {
        title: "standard error of the light per pixel",
        about: "standard error of the linear light of the pixel",
        unit: MetricUnit::Ratio,
        aggregation: Aggregation::Ratio,
        spans_decades: true,
        source: MetricSource::Noise,
        ..counter("noise", "noise", Counter::NodeVisits)
    };
    /// One over the variance of a sample and its cost, on request (M. Pharr, W. Jakob, G. Humphreys,
    /// Physically Based Rendering, 4th edition, section 2.1.3).
    pub const EFFICIENCY: Self = Self {
        title: "efficiency of the samples per pixel",
        about: "1 / (variance of a sample × cost of a sample)",
        source: MetricSource::Efficiency,
        name: "efficiency",
        label: "efficiency",
        ..Self::NOISE
    };

    /// The share of idle lanes in the warps that trace the pixel's rays, on request.
    pub const IDLE_LANES: Self = Self {
        title: "share of idle lanes per pixel",
        about: "share of idle lanes in the warps that trace the rays of the pixel",
        spans_decades: false,
        source: MetricSource::Lanes,
        name: "idle_lanes",
        label: "idle lanes",
        ..Self::NOISE
    };

    /// Cycles of a device's clock, on request.
    pub const CYCLES: Self = Self {
        title: "cycles of the device per pixel",
        about: "cycles of the device's clock, each path from its start to its end",
        spans_decades: true,
        source: MetricSource::DeviceClock,
        ..counter("cycles", "cycles", Counter::NodeVisits)
    };

    /// All metrics: in files, tables and menus they have this order, and heatmaps show the first
    /// two that are not zero.
    pub const ALL: [Self; 14] = [
        Self::TIME,
        Self::NODE_VISITS,
        Self::PRIMITIVE_TESTS,
        Self::RAYS,
        Self::SAMPLES,
        Self {
            title: "shadow rays per pixel",
            about: "rays toward lights",
            ..counter("shadow_rays", "shadow rays", Counter::ShadowRays)
        },
        Self {
            title: "reflection rays per pixel",
            about: "rays reflected by surfaces",
            ..counter(
                "reflection_rays",
                "reflection rays",
                Counter::ReflectionRays,
            )
        },
        Self {
            title: "refraction rays per pixel",
            about: "rays refracted by surfaces",
            ..counter(
                "refraction_rays",
                "refraction rays",
                Counter::RefractionRays,
            )
        },
        Self {
            title: "diffuse rays per pixel",
            about: "rays scattered by rough surfaces",
            ..counter("diffuse_rays", "diffuse rays", Counter::DiffuseRays)
        },
        Self::DEPTH,
        Self {
            title: "box tests per pixel",
            about: "tests of all rays of the pixel against the boxes of nodes",
            ..observed("box_tests", "box tests", StepCounter::BoxTests)
        },
        Self {
            title: "box hits per pixel",
            about: "box tests that hit",
            ..observed("box_hits", "box hits", StepCounter::BoxHits)
        },
        Self {
            title: "primitive hits per pixel",
            about: "primitive tests that hit",
            ..observed(
                "primitive_hits",
                "primitive hits",
                StepCounter::PrimitiveHits,
            )
        },
        Self {
            title: "instance visits per pixel",
            about: "traversals of the meshes of instances",
            ..observed(
                "instance_visits",
                "instance visits",
                StepCounter::InstanceVisits,
            )
        },
    ];

    /// Number of metrics that a rendering measures; those of observed rays follow in
    /// [`ALL`](Self::ALL).
    const N_RENDERED: usize = 10;

    /// Returns all metrics that a rendering counts; [`Self::SAMPLES`] only `with_samples`.
    pub fn counted(with_samples: bool) -> impl Iterator<Item = Self> {
        let is_counted =
            move |metric: &Self| !metric.is_timed() && (with_samples || *metric != Self::SAMPLES);
        let rendered = Self::ALL.into_iter().take(Self::N_RENDERED);
        rendered.filter(is_counted)
    }

    /// Returns the metrics that a scene defines.
    pub fn ratios(metrics: RatioMetrics) -> impl Iterator<Item = Self> + Clone {
        let ratio = |ratio: &'static RatioMetric| Self {
            about: &ratio.definition,
            unit: MetricUnit::Ratio,
            aggregation: Aggregation::Ratio,
            source: MetricSource::Ratio(ratio),
            ..counter(&ratio.name, &ratio.label, Counter::NodeVisits)
        };
        metrics.list().iter().map(ratio)
    }

    /// Returns every metric that a film of this scene may have: the scene's own metrics, then
    /// [`ALL`](Self::ALL), then the spread of samples, idle lanes and the clock of a
    /// device.
    pub fn with_own(metrics: RatioMetrics) -> impl Iterator<Item = Self> + Clone {
        Self::ratios(metrics).chain(Self::ALL).chain([
            Self::NOISE,
            Self::EFFICIENCY,
            Self::IDLE_LANES,
            Self::CYCLES,
        ])
    }

    /// Returns the metric of [`ALL`](Self::ALL) with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|metric| metric.name == name)
    }

    /// Returns the metrics of which this one is the ratio.
    pub fn parts(self) -> Option<[Self; 2]> {
        let MetricSource::Ratio(ratio) = self.source else {
            return None;
        };
        let [above, below] = ratio.parts;
        Some([Self::named(above.name())?, Self::named(below.name())?])
    }

    /// Returns the metrics of observed rays.
    pub fn observed() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().skip(Self::N_RENDERED)
    }

    /// Returns the metric of the times that a mode measures, if any.
    pub fn measured_by(mode: CostMode) -> Option<Self> {
        match mode {
            CostMode::None | CostMode::Counters => None,
            CostMode::SingleRayTime | CostMode::Time => Some(Self::TIME),
        }
    }

    /// Returns true if the values come from the clock.
    pub fn is_timed(self) -> bool {
        self.source == MetricSource::Clock
    }

    /// Returns the value of a counted cost; 0 for a time, for counts of observed rays and for
    /// ratios.
    pub fn value(self, cost: &Cost) -> u64 {
        match self.source {
            MetricSource::Clock | MetricSource::Observed(_) | MetricSource::Ratio(_) => 0,
            MetricSource::Noise | MetricSource::Efficiency => 0,
            MetricSource::Lanes | MetricSource::DeviceClock => 0,
            MetricSource::Counter(counter) => cost.get(counter),
            MetricSource::AllRays => cost.n_rays(),
        }
    }

    /// Combines the values of two pixels or groups of pixels; NaN for a ratio, whose parts have to
    /// be combined.
    #[inline]
    pub fn combine(self, a: f64, b: f64) -> f64 {
        match self.aggregation {
            Aggregation::Sum => a + b,
            Aggregation::Max => a.max(b),
            Aggregation::Ratio => f64::NAN,
        }
    }

    /// Returns the unit in legends: "ns", or the label of a count.
    pub const fn unit_label(self) -> &'static str {
        match self.unit {
            MetricUnit::Nanoseconds => "ns",
            MetricUnit::Count | MetricUnit::Ratio => self.label,
        }
    }

    /// Formats a value for people, a time with its unit.
    pub fn format(self, value: f64) -> String {
        match self.unit {
            MetricUnit::Nanoseconds => numbers::duration(Duration::from_nanos(value as u64)),
            MetricUnit::Count => numbers::count(value as u64),
            MetricUnit::Ratio => format!("{value:.3}"),
        }
    }

    /// Formats a change of a value, with its sign.
    pub fn format_change(self, change: f64) -> String {
        match change {
            0.0 => "0".to_owned(),
            ..0.0 => format!("-{}", self.format(-change)),
            _ => format!("+{}", self.format(change)),
        }
    }
}

/// The metrics that a rendering measures.
impl Keyword for Metric {
    const KEYWORDS: &'static [Self] = Self::ALL.split_at(Self::N_RENDERED).0;

    fn name(self) -> &'static str {
        self.name
    }

    fn help(self) -> &'static str {
        self.about
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use StepCounter::{BoxHits, BoxTests, InstanceVisits, PrimitiveHits};

    #[test]
    fn every_counter_is_a_metric_and_every_metric_has_its_value() {
        let counters = Metric::ALL.iter().filter_map(|metric| match metric.source {
            MetricSource::Counter(counter) => Some(counter),
            _ => None,
        });
        assert!(counters.eq(Counter::ALL));
        let cost = Cost {
            node_visits: 1,
            primitive_tests: 2,
            rays: [10, 20, 30, 40, 50],
            depth: 3,
        };
        let values = Metric::ALL.map(|metric| metric.value(&cost));
        assert_eq!(values, [0, 1, 2, 150, 10, 20, 30, 40, 50, 3, 0, 0, 0, 0]);
        let observed = Metric::observed().map(|metric| metric.source);
        let counters = [BoxTests, BoxHits, PrimitiveHits, InstanceVisits];
        assert!(observed.eq(counters.map(MetricSource::Observed)));
    }

    #[test]
    fn values_and_changes_have_units() {
        assert_eq!(Metric::TIME.format(1500.0), "1.50 µs");
        assert_eq!(Metric::RAYS.format_change(-1500.0), "-1,500");
        assert_eq!(Metric::TIME.format_change(2.0), "+2 ns");
        assert_eq!(Metric::DEPTH.combine(3.0, 2.0), 3.0);
        assert_eq!(Metric::RAYS.combine(3.0, 2.0), 5.0);
    }
}
