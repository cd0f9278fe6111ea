//! The counters of a pixel.

use super::{Cost, RayKind};

/// Defines the enum from one list. A row has the counter and its field of [`Cost`].
macro_rules! counters {
    ($($(#[$doc:meta])* $counter:ident: |$cost:ident| $field:expr,)*) => {
        /// A counter of each pixel.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Counter {
            $($(#[$doc])* $counter,)*
        }

        impl Counter {
            /// All counters, in the order of declaration.
            pub const ALL: [Self; [$(Self::$counter),*].len()] = [$(Self::$counter),*];
        }

        impl Cost {
            /// Returns one of the counters.
            pub fn get(&self, counter: Counter) -> u64 {
                match counter {
                    $(Counter::$counter => { let $cost = self; $field })*
                }
            }

            /// Returns one of the counters for writing.
            pub(super) fn get_mut(&mut self, counter: Counter) -> &mut u64 {
                match counter {
                    $(Counter::$counter => { let $cost = self; &mut $field })*
                }
            }
        }
    };
}

counters! {
    /// BVH nodes visited.
    NodeVisits: |cost| cost.node_visits,
    /// Ray-primitive tests.
    PrimitiveTests: |cost| cost.primitive_tests,
    /// Samples, each of which has one camera ray. Not counted where all pixels have the same
    /// number.
    Samples: |cost| cost.rays[RayKind::Camera as usize],
    /// Rays toward lights.
    ShadowRays: |cost| cost.rays[RayKind::Shadow as usize],
    /// Reflected rays.
    ReflectionRays: |cost| cost.rays[RayKind::Reflection as usize],
    /// Refracted rays.
    RefractionRays: |cost| cost.rays[RayKind::Refraction as usize],
    /// Scattered rays.
    DiffuseRays: |cost| cost.rays[RayKind::Diffuse as usize],
    /// Bounces of the longest path.
    Depth: |cost| cost.depth,
}

impl Counter {
    /// Returns the counter of rays of one kind.
    #[inline]
    pub fn rays(kind: RayKind) -> Self {
        match kind {
            RayKind::Camera => Self::Samples,
            RayKind::Shadow => Self::ShadowRays,
            RayKind::Reflection => Self::ReflectionRays,
            RayKind::Refraction => Self::RefractionRays,
            RayKind::Diffuse => Self::DiffuseRays,
        }
    }
}

/// A count of steps that only the observation of a pixel finds. Rendering kernels do not count it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepCounter {
    /// Tests of the boxes of a visited node's children.
    BoxTests,
    /// Box tests whose box the ray enters before its limit at that time.
    BoxHits,
    /// Tests of primitives, except for instances, that the ray hits before its limit at that time.
    PrimitiveHits,
    /// Visits of instances: the ray traverses the hierarchy of the instance's mesh.
    InstanceVisits,
}

/// The counts of a pixel, in the order of [`StepCounter`]; they saturate at 2^32 - 1.
pub type StepCounts = [u32; 4];
