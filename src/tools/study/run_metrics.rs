//! The metrics of one run.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::StudyMetric;
use output::summary::{ScheduleSection, StageEntry, Summary};
use tracer::accel::RAYS_IN_FLIGHT;

/// Values by name, in a fixed order; a name ends with its unit.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct RunMetrics(pub IndexMap<String, f64>);

impl RunMetrics {
    /// Takes the metrics of a run from its summary and the wall time of its whole process in
    /// milliseconds.
    pub fn from_summary(summary: &Summary, process_ms: f64) -> Self {
        let mut metrics = Self::default();
        metrics.add("process_ms", Some(process_ms));
        for stage in &summary.stages {
            metrics.add_stage(stage);
        }
        let schedule = summary.schedule.as_ref();
        let load = |part: fn(&ScheduleSection) -> Option<f64>| schedule.and_then(part);
        metrics.add("load_imbalance", load(|schedule| schedule.load_imbalance));
        metrics.add("idle_share", load(|schedule| schedule.idle_share));
        metrics.add_count("peak_memory_bytes", summary.peak_memory_bytes);
        metrics.add_count("n_primitives", Some(summary.n_primitives));
        metrics.add_count("n_pixels", summary.n_pixels);
        metrics.add_count("n_hits", Some(summary.n_hits));
        let cost = &summary.cost;
        for name in cost.totals.iter().flat_map(IndexMap::keys) {
            metrics.add(name, cost.total(name));
        }
        metrics.add("mrays_per_second", cost.mrays_per_second);
        let bvh = serde_json::to_value(summary.acceleration.bvh).unwrap_or_default();
        for (name, value) in bvh.as_object().into_iter().flatten() {
            metrics.add(&format!("bvh_{name}"), value.as_f64());
        }
        for file in &summary.files {
            let name = file.name.replace('.', "_");
            metrics.add_count(&format!("{name}_bytes"), Some(file.bytes));
            metrics.add(&format!("{name}_write_ms"), file.write_ms);
        }
        metrics.add_ratios();
        metrics.add_costs_per_ray(summary);
        metrics.add_scaling(summary);
        metrics
    }

    /// Takes the metrics of another program: the lines of its output that are the name of a metric
    /// and a number. Without `render_wall_ms` among them, that is the wall time of the whole
    /// process, `process_ms`.
    pub fn parse(output: &str, process_ms: f64) -> Self {
        let known = StudyMetric::all();
        let mut metrics = Self::default();
        metrics.add("process_ms", Some(process_ms));
        metrics.add("render_wall_ms", Some(process_ms));
        for line in output.lines() {
            let Some((name, value)) = line.split_once(' ') else {
                continue;
            };
            let value = value
                .trim()
                .parse()
                .ok()
                .filter(|value: &f64| value.is_finite());
            if known.iter().any(|metric| metric.name == name) {
                metrics.add(name, value);
            }
        }
        metrics.add_ratios();
        metrics
    }

    fn add_stage(&mut self, stage: &StageEntry) {
        let name = &stage.name;
        self.add(&format!("{name}_wall_ms"), Some(stage.wall_ms));
        self.add(&format!("{name}_cpu_ms"), Some(stage.cpu_ms));
        self.add_count(&format!("{name}_page_faults"), stage.page_faults);
        self.add_count(&format!("{name}_context_switches"), stage.context_switches);
        for (event, count) in &stage.events {
            self.add_count(&format!("{name}_{event}"), Some(*count));
        }
        self.add(&format!("{name}_energy_j"), stage.energy_j);
    }

    /// Adds time, instructions, bytes and fetches per ray.
    ///
    /// Bytes and fetches count nodes and leaves of the BVH as if each ray fetched them separately,
    /// although rays in a packet share them. Each primitive test, also outside the BVH, counts as
    /// the mean over all leaves.
    fn add_costs_per_ray(&mut self, summary: &Summary) {
        let rays_in_flight = match summary.cost.kernel.as_deref() {
            Some("stream") => Some(RAYS_IN_FLIGHT as f64),
            kernel => kernel.map(|_| 1.0),
        };
        self.add("rays_in_flight", rays_in_flight);
        self.add("n_threads", Some(summary.threads.used as f64));
        let n_repeats = summary.repeats.as_ref().map_or(1, |repeats| repeats.n) as f64;
        let of = |name: &str| self.0.get(name).copied();
        let per_ray = |name| Some(of(name)? / n_repeats / of("rays")?);
        let fetched = |per_visit: Option<f64>, per_test: Option<f64>| {
            let of_nodes = of("node_visits_per_ray")? * per_visit?;
            Some(of_nodes + of("primitive_tests_per_ray")? * per_test?)
        };
        let bytes = fetched(of("bvh_bytes_per_visit"), of("bvh_bytes_per_test"));
        let leaves_per_test = of("bvh_n_leaves").zip(of("bvh_n_references"));
        let leaves_per_test = leaves_per_test.map(|(leaves, tests)| leaves / tests);
        let found = [
            (
                "render_ns_per_ray",
                per_ray("render_cpu_ms").map(|ms| 1e6 * ms),
            ),
            ("instructions_per_ray", per_ray("render_instructions")),
            ("bytes_per_ray", bytes),
            ("fetches_per_ray", fetched(Some(1.0), leaves_per_test)),
        ];
        for (name, value) in found {
            self.add(name, value.filter(|value| value.is_finite()));
        }
    }

    /// Adds the throughput, the part of the run that threads and ranks share, and the efficiency of
    /// ranks with its parts.
    ///
    /// The useful time of a rank is the mean busy time of its threads; load balance is the mean of
    /// all threads over the longest of a rank, communication efficiency the longest over the wall
    /// time of the rendering, and parallel efficiency their product: POP Centre of Excellence,
    /// "Standard Metrics for Performance Audits of Parallel Applications".
    fn add_scaling(&mut self, summary: &Summary) {
        let of = |name: &str| self.0.get(name).copied();
        let wall_ms = of("render_wall_ms").filter(|&ms| ms > 0.0);
        let all_ms: f64 = summary.stages.iter().map(|stage| stage.wall_ms).sum();
        let pixels = of("n_pixels").zip(wall_ms);
        self.add("pixels_per_second", pixels.map(|(n, ms)| n / ms * 1e3));
        self.add("render_share", wall_ms.map(|ms| ms / all_ms));
        let Some(ranks) = &summary.ranks else { return };
        let n_threads: u32 = ranks.of_rank.iter().map(|rank| rank.threads).sum();
        let busy_ms: f64 = ranks.of_rank.iter().map(|rank| rank.busy_ms).sum();
        let mean_ms = busy_ms / f64::from(n_threads.max(1));
        let longest_ms = mean_ms * (1.0 + ranks.load_imbalance);
        self.add_count("n_ranks", Some(ranks.n.into()));
        self.add_count("sent_bytes", Some(ranks.sent_bytes));
        for (name, part, whole) in [
            ("load_balance", mean_ms, Some(longest_ms)),
            ("communication_efficiency", longest_ms, wall_ms),
            ("parallel_efficiency", mean_ms, wall_ms),
        ] {
            let ratio = whole.map(|whole| part / whole);
            self.add(name, ratio.filter(|ratio| ratio.is_finite()));
        }
    }

    /// Adds metrics that are quotients of two others.
    fn add_ratios(&mut self) {
        for (name, part, whole) in [
            ("hit_share", "n_hits", "n_pixels"),
            ("node_visits_per_ray", "node_visits", "rays"),
            ("primitive_tests_per_ray", "primitive_tests", "rays"),
            ("ns_per_ray", "time_ns", "rays"),
        ] {
            let value = |name| self.0.get(name).copied();
            let ratio = value(part)
                .zip(value(whole))
                .map(|(part, whole)| part / whole);
            self.add(name, ratio.filter(|ratio| ratio.is_finite()));
        }
    }

    /// Adds a count, if there is one.
    fn add_count(&mut self, name: &str, n: Option<u64>) {
        self.add(name, n.map(|n| n as f64));
    }

    /// Adds a metric if it has a value.
    fn add(&mut self, name: &str, value: Option<f64>) {
        if let Some(value) = value {
            self.0.insert(name.to_owned(), value);
        }
    }
}
