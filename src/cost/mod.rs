//! What work costs: counters, the probes that feed them, and the clock.
//!
//! The kernels are generic over a [`Probe`]. With [`Cost`] they count; with
//! [`NoProbe`] the same source compiles to a kernel without counters.

mod clock;
mod probe;

pub use clock::{Clock, Instant};
pub use probe::{NoProbe, Probe};

/// Why a ray was shot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

    /// Adds the counts of other work; the longer path stays.
    pub fn add(&mut self, other: &Self) {
        self.node_visits += other.node_visits;
        self.primitive_tests += other.primitive_tests;
        for (mine, theirs) in self.rays.iter_mut().zip(other.rays) {
            *mine += theirs;
        }
        self.depth = self.depth.max(other.depth);
    }
}
