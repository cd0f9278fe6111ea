//! The list of metrics that runs may have: name, unit and meaning.
//!
//! [`RunMetrics`](super::RunMetrics) computes the metrics of a run; a test checks that all are listed.

use output::writers;
use render::instruments::{EVENTS, STAGES};
use tracer::cost::{Aggregation, Metric};

/// A metric of the runs of a study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StudyMetric {
    /// Name of the metric in plots and tables.
    pub name: String,
    /// Unit; "1" for ratios.
    pub unit: &'static str,
    /// Meaning in one line.
    pub about: String,
    /// The factors that a study needs for the metric.
    pub need: MetricNeed,
}

/// The factors that a study needs for a metric.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MetricNeed {
    /// None.
    Nothing,
    /// `threads` or `ranks`.
    ThreadsOrRanks,
    /// `ranks`.
    RanksOnly,
    /// `cost`.
    Cost,
    /// `steps`.
    Steps,
}

/// Name, unit and meaning.
type Row = (&'static str, &'static str, &'static str);

/// Metrics of each run.
#[rustfmt::skip]
const OF_RUNS: [Row; 22] = [
    ("process_ms", "ms", "wall time of the whole process, its start included"),
    ("load_imbalance", "1", "longest busy time of a thread over the mean of all, minus 1"),
    ("idle_share", "1", "share of the threads' time without a tile"),
    ("peak_memory_bytes", "bytes", "greatest memory of the process"),
    ("n_threads", "count", "threads that rendered, of all ranks"),
    ("n_primitives", "count", "primitives in the scene"),
    ("n_pixels", "count", "pixels in the picture"),
    ("n_hits", "count", "pixels that hit something"),
    ("hit_share", "1", "share of the pixels that hit something"),
    ("camera_rays", "count", "rays from the camera"),
    ("node_visits_per_ray", "count", "BVH nodes visited per ray"),
    ("primitive_tests_per_ray", "count", "primitives tested per ray"),
    ("ns_per_ray", "ns", "sum of the pixels' times per ray"),
    ("render_ns_per_ray", "ns", "CPU time of the stage `render` per ray"),
    ("instructions_per_ray", "count", "instructions of the stage `render` per ray"),
    ("bytes_per_ray", "bytes", "bytes of BVH nodes and leaves that a ray reads"),
    ("fetches_per_ray", "count", "BVH nodes and leaves that a ray reads"),
    ("idle_lanes", "1", "share of idle lanes in the warps of the rays, with the output `lanes`"),
    ("rays_in_flight", "count", "rays that a thread traces at a time"),
    ("mrays_per_second", "10^6/s", "million rays per second of wall time"),
    ("pixels_per_second", "1/s", "pixels per second of wall time"),
    ("render_share", "1", "share of the stage `render` in the wall time of all stages"),
];

/// Metrics of the BVH, after `bvh_`.
#[rustfmt::skip]
const OF_BVH: [Row; 10] = [
    ("n_nodes", "count", "nodes of up to eight children"),
    ("n_leaves", "count", "leaves of up to eight primitives"),
    ("n_references", "count", "primitives in all leaves, those in several counted each time"),
    ("depth", "count", "steps from the root to the deepest leaf"),
    ("sah_cost", "count", "nodes and primitives of a ray, by the surface area heuristic"),
    ("leaf_cost", "count", "primitives of a ray, by the surface area heuristic: a part of `bvh_sah_cost`"),
    ("epo", "count", "end-point overlap, with `--also bvh`: visits of nodes without the surface on which a ray ends"),
    ("bytes", "bytes", "memory of nodes and leaves"),
    ("bytes_per_visit", "bytes", "bytes that a visit to a node reads"),
    ("bytes_per_test", "bytes", "bytes of a leaf per primitive"),
];

/// Metrics of a study over threads or ranks.
#[rustfmt::skip]
const OF_SCALING: [Row; 2] = [
    ("speedup", "1", "pixels per second over the rate with the fewest threads"),
    ("scaling_efficiency", "1", "speedup over the ratio of threads"),
];

/// The metric of what measuring adds.
pub(super) const OVERHEAD: &str = "measuring_overhead";

/// Metrics of a study over cost modes.
#[rustfmt::skip]
const OF_COST: [Row; 1] = [
    (OVERHEAD, "1", "CPU time of the stage `render` over that with `cost: none`, minus 1"),
];

/// Metrics of a study with steps.
#[rustfmt::skip]
const OF_STEPS: [Row; 3] = [
    ("speedup_over_step", "1", "wall time of the stage `render` in the step before over this one"),
    ("speedup_over_start", "1", "wall time of the stage `render` in the first step over this one"),
    ("picture_difference", "1", "greatest difference from the picture of the last step, 0 to 255"),
];

/// Metrics of runs on ranks.
#[rustfmt::skip]
const OF_RANKS: [Row; 5] = [
    ("n_ranks", "count", "processes that rendered"),
    ("sent_bytes", "bytes", "bytes that all ranks sent"),
    ("load_balance", "1", "mean busy time of all threads over the longest mean of a rank"),
    ("communication_efficiency", "1", "longest mean busy time of a rank over the wall time"),
    ("parallel_efficiency", "1", "load balance times communication efficiency"),
];

/// Metrics of each stage, prefixed with its name.
#[rustfmt::skip]
const OF_STAGES: [Row; 5] = [
    ("wall_ms", "ms", "wall time"),
    ("cpu_ms", "ms", "CPU time of all threads"),
    ("page_faults", "count", "page faults"),
    ("context_switches", "count", "context switches"),
    ("energy_j", "J", "energy of the machine's processor packages, where it reports it"),
];

/// Metrics of each file, prefixed with its name, with `_` for `.`.
#[rustfmt::skip]
const OF_FILES: [Row; 2] = [
    ("bytes", "bytes", "length"),
    ("write_ms", "ms", "wall time of writing, beside other files"),
];

impl StudyMetric {
    /// Lists all metrics.
    pub fn all() -> Vec<Self> {
        let stages = STAGES.iter().flat_map(|(stage, _)| {
            let of_stage = Self::stages().into_iter();
            of_stage.map(move |metric| metric.after(stage))
        });
        let files = file_names().flat_map(|file| {
            let of_file = OF_FILES.map(Self::from_row).into_iter();
            of_file.map(move |metric| metric.after(&file))
        });
        Self::without_families()
            .into_iter()
            .chain(stages)
            .chain(files)
            .collect()
    }

    /// Describes all metrics in lines of name, unit and meaning.
    pub fn table() -> String {
        let stages = STAGES.map(|(stage, work)| format!("  {stage:<24}{work}\n"));
        let files: Vec<String> = file_names().collect();
        let line = |metric: &Self| {
            let Self {
                name,
                unit,
                about,
                need,
            } = metric;
            let need = match need {
                MetricNeed::Nothing => "",
                MetricNeed::ThreadsOrRanks => ", in studies of `threads` or `ranks`",
                MetricNeed::RanksOnly => ", in studies of `ranks`",
                MetricNeed::Cost => ", in studies of `cost`",
                MetricNeed::Steps => ", in studies with `steps`",
            };
            format!("{name:<26}{unit:<8}{about}{need}\n")
        };
        let lines = |metrics: &[Self]| metrics.iter().map(line).collect::<String>();
        let of_stages: Vec<Self> = (Self::stages().into_iter())
            .map(|metric| metric.after("STAGE"))
            .collect();
        let of_files = OF_FILES
            .map(Self::from_row)
            .map(|metric| metric.after("FILE"));
        format!(
            "{}\nof each STAGE:\n{}\nSTAGE is one of:\n{}\nof each FILE:\n{}\nFILE is one \
             of {}\n",
            lines(&Self::without_families()),
            lines(&of_stages),
            stages.concat(),
            lines(&of_files),
            files.join(", "),
        )
    }

    /// Returns the metrics that belong neither to stages nor to files.
    fn without_families() -> Vec<Self> {
        let with = |need| {
            move |row| Self {
                need,
                ..Self::from_row(row)
            }
        };
        let runs = OF_RUNS.map(Self::from_row).into_iter();
        let costs = Metric::ALL.into_iter().map(Self::from_metric);
        let bvh = OF_BVH.map(Self::from_row).map(|metric| metric.after("bvh"));
        let scaling = OF_SCALING.map(with(MetricNeed::ThreadsOrRanks));
        let cost = OF_COST.map(with(MetricNeed::Cost));
        let steps = OF_STEPS.map(with(MetricNeed::Steps));
        let ranks = OF_RANKS.map(with(MetricNeed::RanksOnly));
        runs.chain(costs)
            .chain(bvh)
            .chain(scaling)
            .chain(cost)
            .chain(steps)
            .chain(ranks)
            .collect()
    }

    /// Returns the metrics of a stage without its name.
    fn stages() -> Vec<Self> {
        let event = |name: &&'static str| {
            let counted = name.replace('_', " ");
            let about = format!("{counted} in hardware, where the machine counts them");
            Self {
                about,
                ..Self::from_row((*name, "count", ""))
            }
        };
        let of_system = OF_STAGES.map(Self::from_row).into_iter();
        of_system.chain(EVENTS.iter().map(event)).collect()
    }

    fn from_metric(metric: Metric) -> Self {
        let unit = if metric.is_timed() { "ns" } else { "count" };
        let over = match metric.aggregation {
            Aggregation::Sum => "sum over all pixels",
            Aggregation::Max => "greatest of all pixels",
            Aggregation::Ratio => "ratio of the sums over all pixels",
        };
        let about = format!("{over}: {}", metric.about);
        Self {
            about,
            ..Self::from_row((metric.name, unit, ""))
        }
    }

    fn from_row(row: Row) -> Self {
        let (name, unit, about) = row;
        Self {
            name: name.to_owned(),
            unit,
            about: about.to_owned(),
            need: MetricNeed::Nothing,
        }
    }

    /// Returns the metric of a stage or a file, with its prefix.
    fn after(self, prefix: &str) -> Self {
        let name = format!("{prefix}_{}", self.name);
        Self { name, ..self }
    }
}

/// Returns the names of all output files, in the form used in names of metrics.
fn file_names() -> impl Iterator<Item = String> {
    // The last file, which lists the others, is not among them.
    let listed = writers::files().filter(|file| file.name != output::summary::FILE);
    listed.map(|file| file.name.replace('.', "_"))
}
