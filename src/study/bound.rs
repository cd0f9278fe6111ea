//! How near runs come to what the machine gives at most, and what holds them.

use std::fmt;

use serde::Serialize;
use serde_json::{Map, Value};

use super::{Block, Limits, Row};
use crate::statistics::SampleStatistics;
use crate::text::numbers;

/// A point of a study and what its rays took, by medians.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Standing {
    /// The point's values by factor.
    pub point: Map<String, Value>,
    /// Time of a thread for a ray and for what is shaded at its end, in
    /// nanoseconds.
    pub render_ns_per_ray: SampleStatistics,
    /// Bytes of nodes and leaves that a ray reads, as if no other ray shared
    /// them.
    pub bytes_per_ray: f64,
    /// Nodes and leaves that a ray comes to, one after the other.
    pub fetches_per_ray: f64,
    /// Instructions for a ray; none where they were not counted.
    pub instructions_per_ray: Option<f64>,
    /// Rays that a thread has in flight.
    pub rays_in_flight: f64,
    /// Threads of the run.
    pub n_threads: f64,
    /// Size of the hierarchy, in bytes.
    pub hierarchy_bytes: f64,
    /// Share of a ray's time that waiting for its fetches would take, as
    /// [`Limits::tree`] has it, the rays in flight waiting side by side. Rays
    /// that go the same way find more in the caches, so it is an upper bound,
    /// and may be above 1.
    pub latency_share: f64,
    /// Share of a ray's time that reading its bytes would take, as fast as memory
    /// gives them in order.
    pub bandwidth_share: f64,
    /// Share of the instructions that a thread can execute in that time; where
    /// they were not counted, what the greater of the other two shares leaves.
    pub instruction_share: f64,
    /// The greatest share.
    pub bound: Bound,
}

/// What holds rays up most.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// The work itself.
    Instructions,
    /// Waiting for memory.
    Latency,
    /// As many bytes as memory gives.
    Bandwidth,
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Instructions => "instructions",
            Self::Latency => "the latency of memory",
            Self::Bandwidth => "its bandwidth",
        })
    }
}

impl Block {
    /// Bytes a nanosecond for each of so many threads.
    pub(super) fn bandwidth(&self, n_threads: f64) -> f64 {
        match n_threads > 1.0 {
            true => self.bandwidth_shared,
            false => self.bandwidth_alone,
        }
    }
}

impl Standing {
    /// What holds the point's numbers up; `None` if they were not all measured,
    /// as without counters or a hierarchy.
    fn of(rows: &[Row], limits: &Limits) -> Option<Self> {
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

    /// The greater of both shares of memory.
    fn memory_share(&self) -> f64 {
        self.latency_share.max(self.bandwidth_share)
    }
}

/// The points of a study's rows that can be held against the limits.
pub fn standings(rows: &[Row], limits: &Limits) -> Vec<Standing> {
    let points = rows.chunk_by(|a, b| a.point == b.point);
    points
        .filter_map(|rows| Standing::of(rows, limits))
        .collect()
}

/// What holds the points up, in a sentence of two lines; `None` without any.
pub fn verdict(standings: &[Standing]) -> Option<String> {
    let by_memory = |a: &&Standing, b: &&Standing| a.memory_share().total_cmp(&b.memory_share());
    let worst = standings.iter().max_by(by_memory)?;
    let n = |bound| {
        standings
            .iter()
            .filter(|standing| standing.bound == bound)
            .count()
    };
    let bounds = [Bound::Instructions, Bound::Latency, Bound::Bandwidth];
    let told = bounds.map(|bound| format!("by {bound} at {}", n(bound)));
    let percent = |share: f64| format!("{:.0} %", 100.0 * share.min(1.0));
    let point: Vec<String> = worst.point.iter().map(named).collect();
    let counted = match worst.instructions_per_ray {
        Some(n) => format!(
            ", its {n:.0} instructions {}",
            percent(worst.instruction_share)
        ),
        None => String::new(),
    };
    Some(format!(
        "of {} points {}\n        \
         memory counts most at {}: {:.0} fetches take up to {} of a ray's {:.0} ns, \
         reading its {} up to {}{counted}",
        standings.len(),
        told.join(", "),
        point.join(", "),
        worst.fetches_per_ray,
        percent(worst.latency_share),
        worst.render_ns_per_ray.median,
        numbers::bytes(worst.bytes_per_ray.round() as u64),
        percent(worst.bandwidth_share),
    ))
}

/// "threads 2", "cost time".
fn named((name, value): (&String, &Value)) -> String {
    match value {
        Value::String(text) => format!("{name} {text}"),
        number => format!("{name} {number}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point of which each number was measured once.
    fn rows(numbers: &[(&str, f64)]) -> Vec<Row> {
        let row = |(metric, value): &(&str, f64)| Row {
            point: Map::new(),
            metric: (*metric).to_owned(),
            statistics: SampleStatistics::of(&[*value]).unwrap(),
            first_is_slow: false,
            oversubscribed: false,
        };
        numbers.iter().map(row).collect()
    }

    /// Memory of one speed: 10 ns, 4 GB/s alone and 2 GB/s shared.
    fn limits(instructions_per_second: Option<f64>) -> Limits {
        Limits {
            caches: Vec::new(),
            n_threads: 2,
            blocks: vec![Block {
                bytes: 16384.0,
                latency_ns: 10.0,
                bandwidth_alone: 4.0,
                bandwidth_shared: 2.0,
            }],
            instructions_per_second,
        }
    }

    /// 10 fetches of 400 bytes in all within 200 ns, but for what is given.
    fn standing(given: &[(&str, f64)], limits: &Limits) -> Standing {
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
        standings(&rows(&numbers), limits).remove(0)
    }

    #[test]
    fn the_greatest_share_is_the_bound() {
        let uncounted = limits(None);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let alone = standing(&[], &uncounted);
        assert!(close(alone.latency_share, 0.5) && close(alone.bandwidth_share, 0.5));
        assert!(close(alone.instruction_share, 0.5));
        let many = standing(&[("rays_in_flight", 16.0)], &uncounted);
        assert!(close(many.latency_share, 0.5 / 16.0));
        let shared = standing(&[("n_threads", 2.0)], &uncounted);
        assert!(close(shared.bandwidth_share, 1.0));
        assert_eq!(shared.bound, Bound::Bandwidth);
        let waiting = standing(
            &[("bytes_per_ray", 40.0), ("fetches_per_ray", 30.0)],
            &uncounted,
        );
        assert_eq!(waiting.bound, Bound::Latency);
        assert!(close(waiting.latency_share, 1.5) && close(waiting.instruction_share, 0.0));
        let slow = standing(&[("render_ns_per_ray", 1000.0)], &uncounted);
        assert_eq!(slow.bound, Bound::Instructions);
    }

    #[test]
    fn counted_instructions_are_held_against_the_peak() {
        let counted = limits(Some(4e9));
        let few = standing(&[("instructions_per_ray", 80.0)], &counted);
        assert!((few.instruction_share - 0.1).abs() < 1e-9);
        assert_eq!(few.bound, Bound::Latency);
        let many = standing(&[("instructions_per_ray", 600.0)], &counted);
        assert_eq!(many.bound, Bound::Instructions);
        let told = verdict(&[few, many]).unwrap();
        assert!(
            told.starts_with("of 2 points by instructions at 1"),
            "{told}"
        );
        assert!(told.contains("its 600 instructions 75 %"), "{told}");
    }

    #[test]
    fn without_counters_or_a_hierarchy_there_is_nothing_to_tell() {
        let rows = rows(&[("render_ns_per_ray", 200.0), ("rays_in_flight", 1.0)]);
        assert_eq!(standings(&rows, &limits(None)), []);
        assert_eq!(verdict(&[]), None);
    }
}
