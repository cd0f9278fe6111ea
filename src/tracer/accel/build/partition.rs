//! Partitioning: moving references to the two sides of a split.

use rayon::prelude::*;

use super::bounds::LaneBounds;
use super::object_split::ObjectSplit;
use super::reference::{Reference, center};
use super::spatial_split::SpatialSplit;
use math::simd::{Arithmetic, InstructionSet, Mask, Simd, SimdKernel};
use world::scene::Primitive;

/// References per task.
const CHUNK: usize = 1 << 12;

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

    /// Measures these references.
    pub(super) fn new(simd: Simd, references: &[Reference]) -> Self {
        let chunks = references.par_chunks(CHUNK);
        let of_chunk = |references: &[Reference]| simd.run(Enclose(references));
        // Maxima and sums of integers are independent of the order.
        chunks.map(of_chunk).reduce(Self::empty, Self::union)
    }

    #[inline(always)]
    fn with<I: InstructionSet>(&mut self, set: I, reference: &Reference) {
        let lanes = reference.lanes(set);
        self.n += 1;
        self.bounds = LaneBounds::from_lanes(self.bounds.lanes(set).max(lanes));
        self.centers = LaneBounds::from_lanes(self.centers.lanes(set).max(center(lanes)));
    }

    /// Returns the subset without references.
    pub(super) fn empty() -> Self {
        Self::EMPTY
    }

    /// Returns the union of the references of both.
    pub(super) fn union(self, other: Self) -> Self {
        Self {
            n: self.n + other.n,
            bounds: self.bounds.union(other.bounds),
            centers: self.centers.union(other.centers),
        }
    }
}

/// Finds the bounds of references.
pub(super) struct Enclose<'a>(pub(super) &'a [Reference]);

impl SimdKernel for Enclose<'_> {
    type Output = Subset;

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) -> Subset {
        let mut subset = Subset::EMPTY;
        for reference in self.0 {
            subset.with(set, reference);
        }
        subset
    }
}

/// The references of the left and of the right side.
pub(super) type Sides<'a> = [&'a mut [Reference]; 2];

/// Moves whole references to the sides of a split; keeps their order.
pub(super) struct Scatter<'a, 'r> {
    pub(super) references: &'a [Reference],
    pub(super) to: Sides<'r>,
    pub(super) split: &'a ObjectSplit,
}

impl SimdKernel for Scatter<'_, '_> {
    /// The boxes around the centers on both sides.
    type Output = [LaneBounds; 2];

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) -> [LaneBounds; 2] {
        let empty = set.splat(f32::NEG_INFINITY);
        let [mut left, mut right] = [empty; 2];
        // A copy, so that it stays in registers while references are written.
        let split = *self.split;
        let mut n_right = 0;
        for (i, reference) in self.references.iter().enumerate() {
            let center = center(reference.lanes(set));
            let is_right = split.right_mask(set, center);
            // Append the reference to its side. No branch on the side: it is unpredictable.
            let side = usize::from(!is_right.none());
            let end = if side == 0 { i - n_right } else { n_right };
            self.to[side][end] = *reference;
            n_right += side;
            // Enlarge the side's box around centers.
            left = left.max(I::Lanes::select(is_right, empty, center));
            right = right.max(I::Lanes::select(is_right, center, empty));
        }
        [left, right].map(LaneBounds::from_lanes)
    }
}

/// Returns the subsets on both sides of a split, given the boxes around their centers.
#[inline(always)]
pub(super) fn subsets(n: usize, split: &ObjectSplit, centers: [LaneBounds; 2]) -> [Subset; 2] {
    let [left, right] = centers;
    [
        Subset {
            n: split.n_left,
            bounds: split.left,
            centers: left,
        },
        Subset {
            n: n - split.n_left,
            bounds: split.right,
            centers: right,
        },
    ]
}

/// Moves references in parallel: gives each chunk a separate slice of either side.
pub(super) fn scatter_in_parallel(
    simd: Simd,
    references: &[Reference],
    to: Sides,
    split: &ObjectSplit,
) -> [LaneBounds; 2] {
    // Count the references of each chunk on the left.
    let chunks = references.par_chunks(CHUNK);
    let n_left = |chunk: &[Reference]| chunk.iter().filter(|r| !split.is_right(r)).count();
    let n_left: Vec<usize> = chunks.clone().map(n_left).collect();
    // Give each chunk its slices.
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
    // Move the references of all chunks.
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

/// Partitions references at a plane; splits references that straddle it.
pub(super) fn by_spatial_split(
    simd: Simd,
    references: &[Reference],
    to: Sides,
    split: &SpatialSplit,
    primitives: &[Primitive],
) -> [Subset; 2] {
    let mut ends = [0; 2];
    // Append the parts of each reference to their sides.
    for reference in references {
        for (side, part) in split.sides(reference, primitives).into_iter().enumerate() {
            if let Some(part) = part {
                to[side][ends[side]] = part;
                ends[side] += 1;
            }
        }
    }
    // If rounding left a side empty, one redundant reference does no harm.
    for side in 0..2 {
        if ends[side] == 0 {
            to[side][0] = to[1 - side][0];
            ends[side] = 1;
        }
    }
    [0, 1].map(|side| simd.run(Enclose(&to[side][..ends[side]])))
}

/// Moves the first half to the left and the second half to the right.
pub(super) fn in_halves(simd: Simd, references: &[Reference], to: Sides) -> [Subset; 2] {
    let (left, right) = references.split_at(references.len() / 2);
    let [to_left, to_right] = to;
    to_left[..left.len()].copy_from_slice(left);
    to_right[..right.len()].copy_from_slice(right);
    [left, right].map(|half| Subset::new(simd, half))
}
