//! The metrics of one run.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::accel::RAYS_IN_FLIGHT;

/// Values by name, in a fixed order; a name ends with its unit.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct RunMetrics(pub IndexMap<String, f64>);

impl RunMetrics {
    /// Takes the metrics of a run from its `summary.json` and the wall time of its whole
    /// process in milliseconds.
    pub fn of(summary: &Value, process_ms: f64) -> Self {
        let mut metrics = Self::default();
        metrics.add("process_ms", Some(process_ms));
        for stage in items(&summary["stages"]) {
            let name = stage["name"].as_str().unwrap_or_default();
            for part in ["wall_ms", "cpu_ms", "page_faults", "context_switches"] {
                metrics.add(&format!("{name}_{part}"), stage[part].as_f64());
            }
            for (event, count) in stage["events"].as_object().into_iter().flatten() {
                metrics.add(&format!("{name}_{event}"), count.as_f64());
            }
        }
        for part in ["load_imbalance", "idle_share"] {
            metrics.add(part, summary["schedule"][part].as_f64());
        }
        metrics.add("peak_memory_bytes", summary["peak_memory_bytes"].as_f64());
        metrics.add("n_primitives", summary["n_primitives"].as_f64());
        metrics.add("n_pixels", summary["n_pixels"].as_f64());
        metrics.add("n_hits", summary["n_hits"].as_f64());
        for (name, total) in summary["cost"]["totals"].as_object().into_iter().flatten() {
            metrics.add(name, total.as_f64());
        }
        metrics.add(
            "mrays_per_second",
            summary["cost"]["mrays_per_second"].as_f64(),
        );
        for (name, value) in summary["acceleration"]["bvh"]
            .as_object()
            .into_iter()
            .flatten()
        {
            metrics.add(&format!("bvh_{name}"), value.as_f64());
        }
        for file in items(&summary["files"]) {
            let name = file["file"].as_str().unwrap_or_default().replace('.', "_");
            for part in ["bytes", "write_ms"] {
                metrics.add(&format!("{name}_{part}"), file[part].as_f64());
            }
        }
        metrics.add_ratios();
        metrics.add_costs_per_ray(summary);
        metrics
    }

    /// Adds time, instructions, bytes and fetches per ray.
    ///
    /// Bytes and fetches count nodes and leaves of the BVH as if each ray fetched its own,
    /// although rays in a packet share them. Each primitive test, also outside the BVH,
    /// counts as the mean over all leaves.
    fn add_costs_per_ray(&mut self, summary: &Value) {
        let rays_in_flight = match summary["cost"]["kernel"].as_str() {
            Some("stream") => Some(RAYS_IN_FLIGHT as f64),
            kernel => kernel.map(|_| 1.0),
        };
        self.add("rays_in_flight", rays_in_flight);
        self.add("n_threads", summary["threads"]["used"].as_f64());
        let n_repeats = summary["repeats"]["n"].as_f64().unwrap_or(1.0);
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

    /// Adds a metric if it has a value.
    fn add(&mut self, name: &str, value: Option<f64>) {
        if let Some(value) = value {
            self.0.insert(name.to_owned(), value);
        }
    }
}

fn items(list: &Value) -> impl Iterator<Item = &Value> {
    list.as_array().into_iter().flatten()
}
