//! Counts of the steps of traversals, hits apart from misses.

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
