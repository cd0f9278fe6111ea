//! Instruments that watch the whole process: stages and their times, resources
//! of the operating system, hardware counters, and a sampling profiler.

mod hardware;
mod resources;
mod profile;
mod stages;

pub use hardware::{Counts, HardwareCounters};
pub(crate) use profile::FILE as PROFILE;
pub use profile::{NoProfiler, Profiler};
pub use resources::SystemWork;
pub(crate) use resources::peak_memory_bytes;
pub use stages::{Stage, Stages};
