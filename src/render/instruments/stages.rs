//! The stages of a run and their times.

use std::ops::Range;
use std::time::{Duration, Instant};

use cpu_time::ProcessTime;

use super::hardware::{Counts, HardwareCounters};
use super::resources::SystemWork;
use base::numbers::milliseconds;

/// The names of the stages that a rendering of a still may have, in order, each with a description
/// of its work.
pub const STAGES: [(&str, &str); 11] = [
    ("start", "loading the program"),
    ("read", "reading the scene and its files"),
    ("build", "building the BVH"),
    ("calibrate", "measuring the clock"),
    ("order", "estimating the cost of tiles"),
    ("render", "rendering"),
    ("observe", "attributing costs to objects and nodes"),
    ("lanes", "putting rays in the lanes of warps"),
    ("survey", "reading the pixels of a picture in pieces"),
    ("write", "writing the files"),
    ("profile", "writing the profile"),
];

/// A stage of a run.
#[derive(Debug, Clone)]
pub struct Stage {
    /// Name of the stage.
    pub name: &'static str,
    /// Start and end of the stage.
    pub span: Range<Instant>,
    /// Wall time in milliseconds.
    pub wall_ms: f64,
    /// CPU time of all threads in milliseconds.
    pub cpu_ms: f64,
    /// The work of the operating system, if known.
    pub system: Option<SystemWork>,
    /// Hardware counters; empty if there are none.
    pub events: Counts,
    /// The energy of all processor packages of the machine in joules, if it is measured.
    pub energy_j: Option<f64>,
}

/// Measures consecutive stages.
#[derive(Debug)]
pub struct Stages {
    /// The start of the first stage.
    pub begin: Instant,
    wall: Instant,
    cpu: ProcessTime,
    system: Option<SystemWork>,
    hardware: HardwareCounters,
    counts: Counts,
    /// The stages that have ended.
    pub ended: Vec<Stage>,
}

impl Default for Stages {
    /// Starts the first stage, without hardware counters.
    fn default() -> Self {
        Self::start(HardwareCounters::none())
    }
}

impl Stages {
    /// Starts the first stage.
    pub fn start(mut hardware: HardwareCounters) -> Self {
        let begin = Instant::now();
        Self {
            counts: hardware.read(),
            hardware,
            begin,
            wall: begin,
            cpu: ProcessTime::now(),
            system: SystemWork::so_far(),
            ended: Vec::new(),
        }
    }

    /// Starts with a stage `start`, from the start of the process until now: loading the program
    /// and reading the command line. The system reports only its CPU time, which stands for its
    /// wall time, too.
    pub fn with_start(hardware: HardwareCounters) -> Self {
        let mut stages = Self::start(hardware);
        let elapsed = stages.cpu.as_duration();
        if let Some(begin) = stages.begin.checked_sub(elapsed) {
            stages.ended.push(Stage {
                name: "start",
                span: begin..stages.begin,
                wall_ms: milliseconds(elapsed),
                cpu_ms: milliseconds(elapsed),
                system: stages.system,
                events: Counts::new(),
                energy_j: None,
            });
            stages.begin = begin;
        }
        stages
    }

    /// Ends the running stage and starts the next one.
    pub fn end(&mut self, name: &'static str) {
        let (wall, cpu) = (Instant::now(), ProcessTime::now());
        let (system, counts) = (SystemWork::so_far(), self.hardware.read());
        let before = |name| self.counts.get(name).copied().unwrap_or_default();
        let events = counts
            .iter()
            .map(|(name, count)| (*name, count - before(name)));
        self.ended.push(Stage {
            name,
            span: self.wall..wall,
            wall_ms: milliseconds(wall - self.wall),
            cpu_ms: milliseconds(cpu.duration_since(self.cpu)),
            system: system
                .zip(self.system)
                .map(|(now, before)| now.since(before)),
            events: events.collect(),
            energy_j: self.hardware.energy_since(),
        });
        (self.wall, self.cpu) = (wall, cpu);
        (self.system, self.counts) = (system, counts);
    }

    /// Returns the wall time of the stage with this name; zero if there was none.
    pub fn wall(&self, name: &str) -> Duration {
        let stage = self.ended.iter().find(|stage| stage.name == name);
        Duration::from_secs_f64(stage.map_or(0.0, |stage| stage.wall_ms / 1e3))
    }

    /// Returns the reason why there are no hardware counters, if there are none.
    pub fn no_hardware_counters(&self) -> Option<&str> {
        self.hardware.why_not()
    }

    /// Returns the reason why no energy is measured, if it is not.
    pub fn no_energy(&self) -> Option<&str> {
        self.hardware.why_no_energy()
    }
}
