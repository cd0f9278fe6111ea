//! Instruments that watch the whole process: stages and their times, resources of the operating
//! system, hardware counters, energy, a sampling profiler, and the limits of the machine for the roofline
//! model.

mod energy;
mod hardware;
mod machine_limits;
mod memory_benchmark;
mod resources;
mod profile;
mod stages;
mod time_left;

pub use hardware::{Counts, EVENTS, HardwareCounters};
pub use machine_limits::{DataCache, MachineLimits, MemoryBlock, MemoryLevel};
pub use profile::{NoProfiler, Profiler};
pub use resources::SystemWork;
pub use resources::peak_memory_bytes;
pub use stages::{STAGES, Stage, Stages};
pub use time_left::TimeLeft;
