//! What work costs: counters, the probes that feed them, the clock, and the
//! choice among them.
//!
//! The kernels are generic over a [`Probe`]. With [`Cost`] they count; with
//! [`NoProbe`] the same source compiles to a kernel without counters.

mod clock;
mod counter;
mod counters;
mod cpu;
mod interruption;
mod meter;
mod probe;

pub use clock::{Clock, Instant};
pub use counter::Counter;
pub use counters::Counters;
pub use interruption::Interruptions;
pub use meter::Meter;
pub use probe::{ByPixel, NoProbe, PixelProbe, Probe, StreamProbe, Traversals};

/// Why a ray was shot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RayKind {
    /// From the camera.
    Camera,
    /// Toward a light.
    Shadow,
    /// Mirrored off a surface.
    Reflection,
    /// Through a surface.
    Refraction,
}

impl RayKind {
    /// All, in their order.
    pub const ALL: [Self; 4] = [
        Self::Camera,
        Self::Shadow,
        Self::Reflection,
        Self::Refraction,
    ];
}

/// Counted work: the same at any thread count and on any machine.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Cost {
    /// BVH nodes entered.
    pub node_visits: u64,
    /// Ray-primitive tests.
    pub primitive_tests: u64,
    /// Rays by kind, in the order of [`RayKind`].
    pub rays: [u64; 4],
    /// Longest path in bounces.
    pub depth: u64,
}

impl Cost {
    /// Rays of this kind.
    pub fn rays_of(&self, kind: RayKind) -> u64 {
        self.rays[kind as usize]
    }

    /// All rays.
    pub fn n_rays(&self) -> u64 {
        self.rays.iter().sum()
    }

    /// All counts by their names in files.
    pub fn by_name(&self) -> [(&'static str, u64); 7] {
        [
            ("node_visits", self.node_visits),
            ("primitive_tests", self.primitive_tests),
            ("rays", self.n_rays()),
            ("shadow_rays", self.rays_of(RayKind::Shadow)),
            ("reflection_rays", self.rays_of(RayKind::Reflection)),
            ("refraction_rays", self.rays_of(RayKind::Refraction)),
            ("depth", self.depth),
        ]
    }

    /// The counts of both; of two paths the longer one.
    pub fn with(self, other: Self) -> Self {
        Self {
            node_visits: self.node_visits + other.node_visits,
            primitive_tests: self.primitive_tests + other.primitive_tests,
            rays: std::array::from_fn(|kind| self.rays[kind] + other.rays[kind]),
            depth: self.depth.max(other.depth),
        }
    }
}
