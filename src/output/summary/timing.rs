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
    /// The number of pixel times without an undisturbed measurement.
    pub n_rejected: Option<u64>,
}

/// The threads' busy time over all renderings, with its parts, which sum to `busy_ns`. All times
/// are in nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ThreadTime {
    /// Time from the start to the end of each tile in which its thread had a CPU.
    pub busy_ns: f64,
    /// The pixels' own times.
    pub pixels_ns: f64,
    /// One clock reading per pixel, at the measured cost of a reading; 0 if waves are timed.
    pub clock_ns: f64,
    /// Writing pixels to the film; 0 if waves are timed, whose pixels' times include it.
    pub film_ns: f64,
    /// Rendering pixels that are not counted: warm-up before a tile's first pixel is timed, and
    /// pixels that are timed again.
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
    /// Computes the remainder of the busy time, given its known parts.
    pub fn new(busy_ns: f64, pixels_ns: f64, clock_ns: f64, film_ns: f64, warm_up_ns: f64) -> Self {
        let mut time = Self {
            busy_ns,
            pixels_ns,
            clock_ns,
            film_ns,
            warm_up_ns,
            unexplained_ns: busy_ns - pixels_ns - clock_ns - film_ns - warm_up_ns,
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
}
