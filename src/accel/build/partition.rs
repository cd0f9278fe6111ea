//! Partitions references: moves them to the two sides of a split.

use rayon::prelude::*;

use super::bounds::LaneBounds;
use super::object_split::ObjectSplit;
use super::reference::Reference;
use super::spatial_split::SpatialSplit;
use crate::scene::Primitive;
use crate::simd::{InstructionSet, Simd, SimdKernel};

/// Number of references from which they are moved in parallel.
const PARALLEL: usize = 1 << 16;
const CHUNK: usize = PARALLEL / 4;

/// The size and the bounds of a subset of the references.
#[derive(Clone, Copy)]
pub(super) struct Subset {
    pub(super) n: usize,
    pub(super) bounds: LaneBounds,
    /// The box around the centers, times two.
    pub(super) centers: LaneBounds,
}

impl Subset {
    const EMPTY: Self = Self {
        n: 0,
        bounds: LaneBounds::EMPTY,
        centers: LaneBounds::EMPTY,
    };

    /// That of these references.
    pub(super) fn of(references: &[Reference]) -> Self {
        let chunks = references.par_chunks(CHUNK);
        let of_chunk = |chunk: &[Reference]| chunk.iter().fold(Self::EMPTY, Self::with);
        // Maxima and sums of integers are independent of the order.
        chunks.map(of_chunk).reduce(|| Self::EMPTY, Self::union)
    }

    fn with(self, reference: &Reference) -> Self {
        Self {
            n: self.n + 1,
            bounds: self.bounds.union(reference.bounds()),
            centers: self.centers.union(reference.center_bounds()),
        }
    }

    fn union(self, other: Self) -> Self {
        Self {
            n: self.n + other.n,
            bounds: self.bounds.union(other.bounds),
            centers: self.centers.union(other.centers),
        }
    }
}

/// Where the references of the left and of the right side go.
pub(super) type Sides<'a> = [&'a mut [Reference]; 2];

/// Partitions whole references; keeps their order.
pub(super) fn by_object_split(
    simd: Simd,
    references: &[Reference],
    to: Sides,
    split: &ObjectSplit,
) -> [Subset; 2] {
    let [left, right] = if references.len() < PARALLEL {
        simd.run(Scatter {
            references,
            to,
            split,
        })
    } else {
        scatter_in_parallel(simd, references, to, split)
    };
    [
        Subset {
            n: split.n_left,
            bounds: split.left,
            centers: left,
        },
        Subset {
            n: references.len() - split.n_left,
            bounds: split.right,
            centers: right,
        },
    ]
}

/// Moves references; returns the boxes around the centers on both sides.
struct Scatter<'a, 'r> {
    references: &'a [Reference],
    to: Sides<'r>,
    split: &'a ObjectSplit,
}

impl SimdKernel for Scatter<'_, '_> {
    type Output = [LaneBounds; 2];

    #[inline(always)]
    fn run<I: InstructionSet>(self, _: I) -> [LaneBounds; 2] {
        let mut ends = [0; 2];
        let mut centers = [LaneBounds::EMPTY; 2];
        for reference in self.references {
            // No branch on the side: it is unpredictable.
            let side = usize::from(!self.split.is_left(reference));
            self.to[side][ends[side]] = *reference;
            ends[side] += 1;
            centers[side] = centers[side].union(reference.center_bounds());
        }
        centers
    }
}

/// Gives each chunk its own slice of either side.
fn scatter_in_parallel(
    simd: Simd,
    references: &[Reference],
    to: Sides,
    split: &ObjectSplit,
) -> [LaneBounds; 2] {
    let chunks = references.par_chunks(CHUNK);
    let n_left = |chunk: &[Reference]| chunk.iter().filter(|r| split.is_left(r)).count();
    let n_left: Vec<usize> = chunks.clone().map(n_left).collect();
    let [mut left, mut right] = to;
    let mut take = |(n_left, chunk): (usize, &[Reference])| {
        let n_right = chunk.len() - n_left;
        Some([
            left.split_off_mut(..n_left)?,
            right.split_off_mut(..n_right)?,
        ])
    };
    let slices: Option<Vec<Sides>> = n_left
        .into_iter()
        .zip(references.chunks(CHUNK))
        .map(&mut take)
        .collect();
    chunks
        .zip(slices.expect("both sides were counted"))
        .map(|(references, to)| {
            simd.run(Scatter {
                references,
                to,
                split,
            })
        })
        .reduce(
            || [LaneBounds::EMPTY; 2],
            |[a, b], [c, d]| [a.union(c), b.union(d)],
        )
}

/// Partitions references at a plane; splits those that straddle it.
pub(super) fn by_spatial_split(
    references: &[Reference],
    to: Sides,
    split: &SpatialSplit,
    primitives: &[Primitive],
) -> [Subset; 2] {
    let mut subsets = [Subset::EMPTY; 2];
    for reference in references {
        for (side, part) in split.sides(reference, primitives).into_iter().enumerate() {
            if let Some(part) = part {
                to[side][subsets[side].n] = part;
                subsets[side] = subsets[side].with(&part);
            }
        }
    }
    // If rounding left a side empty, one redundant reference does no harm.
    for side in 0..2 {
        if subsets[side].n == 0 {
            to[side][0] = to[1 - side][0];
            subsets[side] = Subset::EMPTY.with(&to[side][0]);
        }
    }
    subsets
}

/// Moves the first half to the left and the second half to the right.
pub(super) fn in_halves(references: &[Reference], to: Sides) -> [Subset; 2] {
    let (left, right) = references.split_at(references.len() / 2);
    let [to_left, to_right] = to;
    to_left[..left.len()].copy_from_slice(left);
    to_right[..right.len()].copy_from_slice(right);
    [left, right].map(Subset::of)
}
