//! The points of a study in the roofline model: their distance from the machine's limits, and the
//! limit that binds.

use std::fmt;

use serde::Serialize;
use serde_json::{Map, Value};

use super::StatisticsRow;
use super::point::label_of;
use super::sample::SampleStatistics;
use base::numbers;
use render::instruments::MachineLimits;

/// A point of a study and its rays' use of the machine. All numbers are medians.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RooflinePoint {
    /// The point's values, by factor name.
    pub point: Map<String, Value>,
    /// CPU time per ray, shading included, in nanoseconds.
    pub render_ns_per_ray: SampleStatistics,
    /// Bytes of nodes and leaves per ray, as if rays shared none.
    pub bytes_per_ray: f64,
    /// Nodes and leaves per ray, fetched one after the other.
    pub fetches_per_ray: f64,
    /// Instructions per ray; `None` if they were not counted.
    pub instructions_per_ray: Option<f64>,
    /// Rays in flight per thread.
    pub rays_in_flight: f64,
    /// Number of threads.
    pub n_threads: f64,
    /// Size of the BVH in bytes.
    pub hierarchy_bytes: f64,
    /// Memory latency of the fetches as a share of the time per ray: the latency of
    /// [`MachineLimits::tree`], with the rays in flight waiting in parallel. An upper bound that
    /// may exceed 1, since coherent rays find more in the caches.
    pub latency_share: f64,
    /// Time to read the bytes at sequential bandwidth, as a share of the time per ray.
    pub bandwidth_share: f64,
    /// Instructions as a share of the peak in that time; if they were not counted, 1 minus the
    /// greater of the other two shares.
    pub instruction_share: f64,
    /// The limit with the greatest share.
    pub bound: Bound,
}

/// The limit that binds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// Executing instructions.
    Instructions,
    /// Memory latency.
    Latency,
    /// Memory bandwidth.
    Bandwidth,
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Instructions => "instructions",
            Self::Latency => "memory latency",
            Self::Bandwidth => "memory bandwidth",
        })
    }
}

impl RooflinePoint {
    /// Computes the shares from the rows of one point; `None` if a metric is missing, as without
    /// counters or without a BVH.
    fn new(rows: &[StatisticsRow], limits: &MachineLimits) -> Option<Self> {
        let statistics = |name: &str| {
            let row = rows.iter().find(|row| row.metric == name)?;
            Some(row.statistics)
        };
        let median = |name| Some(statistics(name)?.median).filter(|&median| median > 0.0);
        let time = statistics("render_ns_per_ray").filter(|time| time.min > 0.0)?;
        let [bytes, fetches] = [median("bytes_per_ray")?, median("fetches_per_ray")?];
        let [in_flight, n_threads] = [median("rays_in_flight")?, median("n_threads")?];
        let hierarchy_bytes = median("bvh_bytes")?;
        let block = limits.tree(hierarchy_bytes, median("bvh_bytes_per_visit")?);
        let ns = time.median;
        let latency = fetches * block.latency_ns / in_flight / ns;
        let bandwidth = bytes / block.bandwidth(n_threads) / ns;
        let n_instructions = median("instructions_per_ray");
        let counted = n_instructions.zip(limits.instructions_per_second);
        let instructions = match counted {
            Some((n, per_second)) => n / (per_second * 1e-9) / ns,
            None => 1.0 - latency.max(bandwidth).min(1.0),
        };
        let bound = match (latency >= bandwidth, instructions >= latency.max(bandwidth)) {
            (_, true) => Bound::Instructions,
            (true, _) => Bound::Latency,
            (false, _) => Bound::Bandwidth,
        };
        Some(Self {
            point: rows.first()?.point.clone(),
            render_ns_per_ray: time,
            bytes_per_ray: bytes,
            fetches_per_ray: fetches,
            instructions_per_ray: n_instructions,
            rays_in_flight: in_flight,
            n_threads,
            hierarchy_bytes,
            latency_share: latency,
            bandwidth_share: bandwidth,
            instruction_share: instructions,
            bound,
        })
    }

    /// Returns the greater of the shares of latency and bandwidth.
    fn memory_share(&self) -> f64 {
        self.latency_share.max(self.bandwidth_share)
    }
}

/// Returns the points that have all metrics of the model, in the order of the rows.
pub fn roofline_points(rows: &[StatisticsRow], limits: &MachineLimits) -> Vec<RooflinePoint> {
    let points = rows.chunk_by(|a, b| a.point == b.point);
    points
        .filter_map(|rows| RooflinePoint::new(rows, limits))
        .collect()
}

/// Returns the limits that bind the points, as a sentence of two lines; `None` without points.
pub fn bottleneck_report(points: &[RooflinePoint]) -> Option<String> {
    let by_memory =
        |a: &&RooflinePoint, b: &&RooflinePoint| a.memory_share().total_cmp(&b.memory_share());
    let worst = points.iter().max_by(by_memory)?;
    let n = |bound| points.iter().filter(|point| point.bound == bound).count();
    let bounds = [Bound::Instructions, Bound::Latency, Bound::Bandwidth];
    let counts = bounds.map(|bound| format!("{} by {bound}", n(bound)));
    let percent = |share: f64| format!("{:.0} %", 100.0 * share.min(1.0));
    let instructions = match worst.instructions_per_ray {
        Some(n) => format!(
            ", its {n:.0} instructions {}",
            percent(worst.instruction_share)
        ),
        None => String::new(),
    };
    Some(format!(
        "{} points are limited: {}\n        \
         memory has the greatest share at {}: {:.0} fetches take up to {} of a ray's {:.0} ns, \
         reading its {} up to {}{instructions}",
        points.len(),
        counts.join(", "),
        label_of(&worst.point),
        worst.fetches_per_ray,
        percent(worst.latency_share),
        worst.render_ns_per_ray.median,
        numbers::bytes(worst.bytes_per_ray.round() as u64),
        percent(worst.bandwidth_share),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use render::instruments::MemoryBlock;

    /// Returns the rows of a point with one run and these metrics.
    fn rows(numbers: &[(&str, f64)]) -> Vec<StatisticsRow> {
        let row = |(metric, value): &(&str, f64)| StatisticsRow {
            point: Map::new(),
            metric: (*metric).to_owned(),
            statistics: SampleStatistics::from_values(&[*value]).unwrap(),
            first_is_slow: false,
            oversubscribed: false,
        };
        numbers.iter().map(row).collect()
    }

    /// Returns memory of one speed: 10 ns, 4 GB/s for one thread and 2 GB/s shared.
    fn limits(instructions_per_second: Option<f64>) -> MachineLimits {
        MachineLimits {
            caches: Vec::new(),
            n_threads: 2,
            blocks: vec![MemoryBlock {
                bytes: 16384.0,
                latency_ns: 10.0,
                bandwidth_alone: 4.0,
                bandwidth_shared: 2.0,
            }],
            instructions_per_second,
        }
    }

    /// Returns a point with 10 fetches of 400 bytes in total within 200 ns, except for the given
    /// metrics.
    fn point(given: &[(&str, f64)], limits: &MachineLimits) -> RooflinePoint {
        let mut numbers = vec![
            ("render_ns_per_ray", 200.0),
            ("bytes_per_ray", 400.0),
            ("fetches_per_ray", 10.0),
            ("rays_in_flight", 1.0),
            ("n_threads", 1.0),
            ("bvh_bytes", 1e6),
            ("bvh_bytes_per_visit", 256.0),
        ];
        for given in given {
            numbers.retain(|(name, _)| *name != given.0);
            numbers.push(*given);
        }
        roofline_points(&rows(&numbers), limits).remove(0)
    }

    #[test]
    fn the_greatest_share_is_the_bound() {
        let uncounted = limits(None);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let alone = point(&[], &uncounted);
        assert!(close(alone.latency_share, 0.5) && close(alone.bandwidth_share, 0.5));
        assert!(close(alone.instruction_share, 0.5));
        let many = point(&[("rays_in_flight", 16.0)], &uncounted);
        assert!(close(many.latency_share, 0.5 / 16.0));
        let shared = point(&[("n_threads", 2.0)], &uncounted);
        assert!(close(shared.bandwidth_share, 1.0));
        assert_eq!(shared.bound, Bound::Bandwidth);
        let waiting = point(
            &[("bytes_per_ray", 40.0), ("fetches_per_ray", 30.0)],
            &uncounted,
        );
        assert_eq!(waiting.bound, Bound::Latency);
        assert!(close(waiting.latency_share, 1.5) && close(waiting.instruction_share, 0.0));
        let slow = point(&[("render_ns_per_ray", 1000.0)], &uncounted);
        assert_eq!(slow.bound, Bound::Instructions);
    }

    #[test]
    fn counted_instructions_are_compared_with_the_peak() {
        let counted = limits(Some(4e9));
        let few = point(&[("instructions_per_ray", 80.0)], &counted);
        assert!((few.instruction_share - 0.1).abs() < 1e-9);
        assert_eq!(few.bound, Bound::Latency);
        let many = point(&[("instructions_per_ray", 600.0)], &counted);
        assert_eq!(many.bound, Bound::Instructions);
        let report = bottleneck_report(&[few, many]).unwrap();
        assert!(
            report.starts_with("2 points are limited: 1 by instructions"),
            "{report}"
        );
        assert!(report.contains("its 600 instructions 75 %"), "{report}");
    }

    #[test]
    fn without_counters_or_a_bvh_there_are_no_points() {
        let rows = rows(&[("render_ns_per_ray", 200.0), ("rays_in_flight", 1.0)]);
        assert_eq!(roofline_points(&rows, &limits(None)), []);
        assert_eq!(bottleneck_report(&[]), None);
    }
}
