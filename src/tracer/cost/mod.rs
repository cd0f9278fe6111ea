//! Cost measurement: counters, the probes that feed them, and the clock.
//!
//! The kernels are generic over a [`Probe`]. With [`Cost`] they count; with
//! [`NoProbe`] the same source compiles to a kernel without counters.

mod arrays;
mod bounces;
mod clock;
mod counter;
mod counters;
mod cost_mode;
mod launch;
mod meter;
mod metric;
mod probe;
mod ratio;
mod stopwatch;
#[cfg(target_arch = "x86_64")]
mod tsc;
mod traversals;

pub use arrays::{PixelArray, WrittenArrays};
pub use bounces::{BounceCounts, N_BOUNCES, RaysByBounce};
pub use clock::Clock;
pub use cost_mode::CostMode;
pub use counter::{Counter, StepCounter, StepCounts};
pub use counters::Counters;
pub use launch::{DeviceLaunch, FollowedPath, KernelWork, MultiprocessorRun, UsedDevice};
pub use meter::Meter;
pub use metric::{Aggregation, Metric, MetricSource, MetricUnit};
pub use probe::{ByPixel, NoProbe, PixelProbe, Probe, StreamProbe};
pub use ratio::{MAX_METRICS, RatioMetric, RatioMetrics};
pub use stopwatch::Stopwatch;
pub use traversals::Traversals;

/// The purpose of a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RayKind {
    /// From the camera.
    Camera,
    /// Toward a light.
    Shadow,
    /// Reflected by a surface.
    Reflection,
    /// Refracted by a surface.
    Refraction,
    /// Scattered by a rough surface, in a random direction.
    Diffuse,
}

impl RayKind {
    /// All kinds, in the order of declaration.
    pub const ALL: [Self; 5] = [
        Self::Camera,
        Self::Shadow,
        Self::Reflection,
        Self::Refraction,
        Self::Diffuse,
    ];

    /// Returns the name in files and on the terminal.
    pub fn name(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Shadow => "shadow",
            Self::Reflection => "reflection",
            Self::Refraction => "refraction",
            Self::Diffuse => "diffuse",
        }
    }
}

/// Counted work, which depends neither on the machine nor on the number of threads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Cost {
    /// BVH nodes visited.
    pub node_visits: u64,
    /// Ray-primitive tests.
    pub primitive_tests: u64,
    /// Rays by kind, in the order of [`RayKind`].
    pub rays: [u64; RayKind::ALL.len()],
    /// Bounces of the longest path.
    pub depth: u64,
}

impl Cost {
    /// Returns the number of rays of one kind.
    pub fn rays_of(&self, kind: RayKind) -> u64 {
        self.rays[kind as usize]
    }

    /// Returns the number of all rays.
    pub fn n_rays(&self) -> u64 {
        self.rays.iter().sum()
    }

    /// Adds the counts of both, and takes the greater depth.
    pub fn with(self, other: Self) -> Self {
        Self {
            node_visits: self.node_visits + other.node_visits,
            primitive_tests: self.primitive_tests + other.primitive_tests,
            rays: std::array::from_fn(|kind| self.rays[kind] + other.rays[kind]),
            depth: self.depth.max(other.depth),
        }
    }
}
