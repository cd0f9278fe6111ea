//! The sections on time.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use render::instruments::Stage;
use scene::config::Repeats;

/// A stage of the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StageEntry {
    /// Name.
    pub name: String,
    /// Wall time in milliseconds.
    pub wall_ms: f64,
    /// CPU time of all threads in milliseconds.
    pub cpu_ms: f64,
    /// Page faults, minor and major, if the system reports them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub page_faults: Option<u64>,
    /// Context switches, voluntary and involuntary, if the system reports them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub context_switches: Option<u64>,
    /// Hardware counters by name; empty if there are none.
    #[serde(default)]
    pub events: IndexMap<String, u64>,
    /// Energy of all processor packages of the machine, with its other programs, in joules; `None`
    /// if it was not measured.
    #[serde(default)]
    pub energy_j: Option<f64>,
}

/// The repeated renderings of the picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RepeatsSection {
    /// The requested number.
    pub asked: Option<Repeats>,
    /// The number of renderings.
    pub n: usize,
    /// The time of all pixels in each rendering, in nanoseconds; empty if pixels
    /// were not timed.
    pub busy_ns: Vec<f64>,
    /// The wall time of each rendering in milliseconds.
    pub wall_ms: Vec<f64>,
}

/// The threads' busy time over all renderings, with its parts, which sum to `busy_ns`. All times
/// are in nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ThreadTime {
    /// The threads' CPU time from the start to the end of each tile.
    pub busy_ns: f64,
    /// The pixels' own times.
    pub pixels_ns: f64,
    /// One clock reading per pixel, at the measured cost of a reading; 0 if waves are timed.
    pub clock_ns: f64,
    /// Writing pixels to the film; 0 if waves are timed, whose pixels' times include it.
    pub film_ns: f64,
    /// Warm-up: rendering pixels that are not counted, and the first writes to memory.
    pub warm_up_ns: f64,
    /// The remainder.
    pub unexplained_ns: f64,
    /// The remainder in percent of the busy time.
    pub unexplained_percent: f64,
    /// Time from the start to the end of each tile in which its thread waited for a CPU; not part
    /// of the busy time.
    #[serde(default)]
    pub waiting_ns: f64,
}

impl From<&Stage> for StageEntry {
    fn from(stage: &Stage) -> Self {
        let events = stage.events.iter();
        Self {
            name: stage.name.to_owned(),
            wall_ms: stage.wall_ms,
            cpu_ms: stage.cpu_ms,
            page_faults: stage.system.map(|work| work.page_faults),
            context_switches: stage.system.map(|work| work.context_switches),
            events: events.map(|(name, n)| ((*name).to_owned(), *n)).collect(),
            energy_j: stage.energy_j,
        }
    }
}

impl ThreadTime {
    /// Computes the remainder of the busy time, given its known parts, which are all of it if they
    /// exceed it by a little.
    pub fn new(busy_ns: f64, pixels_ns: f64, clock_ns: f64, film_ns: f64, warm_up_ns: f64) -> Self {
        let known_ns = pixels_ns + clock_ns + film_ns + warm_up_ns;
        let mut time = Self {
            busy_ns: busy_ns.max(known_ns),
            pixels_ns,
            clock_ns,
            film_ns,
            warm_up_ns,
            unexplained_ns: (busy_ns - known_ns).max(0.0),
            unexplained_percent: 0.0,
            waiting_ns: 0.0,
        };
        time.unexplained_percent = time.percent(time.unexplained_ns);
        time
    }

    /// Returns a part in percent of the busy time; 0 if that is zero.
    pub fn percent(&self, part_ns: f64) -> f64 {
        match self.busy_ns {
            0.0 => 0.0,
            busy_ns => 100.0 * part_ns / busy_ns,
        }
    }

    /// Returns the parts, in the order of the fields, in tenths of a percent of the busy time,
    /// rounded so that they add up: those with the largest remainders are rounded up.
    pub fn permille(&self) -> [u32; 5] {
        let parts = [
            self.pixels_ns,
            self.clock_ns,
            self.film_ns,
            self.warm_up_ns,
            self.unexplained_ns,
        ];
        let exact = parts.map(|part_ns| 10.0 * self.percent(part_ns));
        let mut rounded = exact.map(|part| part as u32);
        let n_left = exact.iter().sum::<f64>().round() as u32 - rounded.iter().sum::<u32>();
        let mut order = [0, 1, 2, 3, 4];
        order.sort_by(|&a, &b| exact[b].fract().total_cmp(&exact[a].fract()));
        for part in order.into_iter().take(n_left as usize) {
            rounded[part] += 1;
        }
        rounded
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up_and_none_is_negative() {
        let of = |busy_ns, pixels_ns| ThreadTime::new(busy_ns, pixels_ns, 2.0, 3.0, 1.0);
        for (busy_ns, pixels_ns) in [(100.0, 77.7), (93.0, 96.1), (7.0, 1.0), (1e9, 1.0 / 3.0)] {
            let time = of(busy_ns, pixels_ns);
            let sum = time.pixels_ns + time.clock_ns + time.film_ns + time.warm_up_ns;
            assert!((sum + time.unexplained_ns - time.busy_ns).abs() < 1e-6 * busy_ns);
            assert!(time.unexplained_ns >= 0.0);
            assert_eq!(time.permille().iter().sum::<u32>(), 1000);
        }
        assert_eq!(of(7.0, 1.0).permille(), [143, 286, 428, 143, 0]);
        assert_eq!(ThreadTime::new(0.0, 0.0, 0.0, 0.0, 0.0).permille(), [0; 5]);
    }
}
