//! Splitting the references of a node with one thread or with all of them.

use super::bounds::LaneBounds;
use super::object_split::ObjectSplit;
use super::partition::{Scatter, Sides, scatter_in_parallel};
use super::reference::Reference;
use math::simd::{InstructionSet, Simd, SimdKernel};

/// Number of references from which they are moved in parallel.
const PARALLEL: usize = 1 << 15;

/// One or more threads.
pub(super) trait Workers: Copy {
    /// Returns the cheapest object split of references, by the box around their centers.
    fn object_split(self, references: &[Reference], centers: &LaneBounds) -> Option<ObjectSplit>;

    /// Moves references to the sides of a split. Returns the boxes around their centers.
    fn scatter(self, references: &[Reference], to: Sides, split: &ObjectSplit) -> [LaneBounds; 2];
}

/// The current thread, which runs a kernel.
#[derive(Clone, Copy)]
pub(super) struct OneThread<I>(pub(super) I);

impl<I: InstructionSet> Workers for OneThread<I> {
    #[inline(always)]
    fn object_split(self, references: &[Reference], centers: &LaneBounds) -> Option<ObjectSplit> {
        match references.len() {
            0..16 => ObjectSplit::best::<I, 8>(self.0, references, centers),
            16..128 => ObjectSplit::best::<I, 16>(self.0, references, centers),
            _ => ObjectSplit::best::<I, 32>(self.0, references, centers),
        }
    }

    #[inline(always)]
    fn scatter(self, references: &[Reference], to: Sides, split: &ObjectSplit) -> [LaneBounds; 2] {
        let scatter = Scatter {
            references,
            to,
            split,
        };
        scatter.run(self.0)
    }
}

/// All threads.
impl Workers for Simd {
    fn object_split(self, references: &[Reference], centers: &LaneBounds) -> Option<ObjectSplit> {
        ObjectSplit::best_of_many(self, references, centers)
    }

    fn scatter(self, references: &[Reference], to: Sides, split: &ObjectSplit) -> [LaneBounds; 2] {
        if references.len() < PARALLEL {
            return self.run(Scatter {
                references,
                to,
                split,
            });
        }
        scatter_in_parallel(self, references, to, split)
    }
}
