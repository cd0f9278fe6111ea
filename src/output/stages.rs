//! The parts of a run, and what each took.

use std::ops::Range;
use std::time::{Duration, Instant};

use cpu_time::ProcessTime;
use serde::Serialize;

use super::hardware::{Counts, HardwareCounters};
use super::resources::SystemWork;

/// A part of the run and its time.
#[derive(Debug, Clone, Serialize)]
pub struct Stage {
    /// What was done.
    pub name: &'static str,
    /// From when to when.
    #[serde(skip)]
    pub span: Range<Instant>,
    /// Time on the wall, in milliseconds.
    pub wall_ms: f64,
    /// Time of all threads together, in milliseconds.
    pub cpu_ms: f64,
    /// What the operating system had to do in it, where that is known.
    #[serde(flatten)]
    pub system: Option<SystemWork>,
    /// What the processor counted in it; empty where it counts nothing.
    pub events: Counts,
}

/// A stopwatch that is pressed at the end of each stage.
#[derive(Debug)]
pub struct Stages {
    /// When the first one began.
    pub begin: Instant,
    wall: Instant,
    cpu: ProcessTime,
    system: Option<SystemWork>,
    hardware: HardwareCounters,
    counts: Counts,
    /// The stages that have ended.
    pub ended: Vec<Stage>,
}

impl Stages {
    /// Starts the first stage now, watched by these counters.
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
        });
        (self.wall, self.cpu) = (wall, cpu);
        (self.system, self.counts) = (system, counts);
    }

    /// Time on the wall of the stage with this name; zero if it never was.
    pub fn wall(&self, name: &str) -> Duration {
        let stage = self.ended.iter().find(|stage| stage.name == name);
        Duration::from_secs_f64(stage.map_or(0.0, |stage| stage.wall_ms / 1e3))
    }

    /// Why the processor counts nothing, if so.
    pub(super) fn no_hardware_counters(&self) -> Option<&str> {
        self.hardware.why_not()
    }
}

/// To a thousandth.
pub(super) fn milliseconds(elapsed: Duration) -> f64 {
    (elapsed.as_secs_f64() * 1e6).round() / 1e3
}
