//! Moves references to the two sides of a split.

use rayon::prelude::*;

use super::bins::Split;
use super::cuts::Cut;
use super::reference::{Corners, Reference};
use crate::accel::simd::{InstructionSet, Simd, Work};
use crate::scene::Primitive;

/// From so many references on they are moved in parallel.
const PARALLEL: usize = 1 << 16;
const CHUNK: usize = PARALLEL / 4;

/// The references on one side.
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub(super) n: usize,
    pub(super) bounds: Corners,
    /// The box around the doubled centres.
    pub(super) centers: Corners,
}

impl Part {
    const EMPTY: Self = Self {
        n: 0,
        bounds: Corners::EMPTY,
        centers: Corners::EMPTY,
    };

    /// All of these.
    pub(super) fn of(references: &[Reference]) -> Self {
        let chunks = references.par_chunks(CHUNK);
        let of_chunk = |chunk: &[Reference]| chunk.iter().fold(Self::EMPTY, Self::with);
        // Maxima and sums of integers: the same in any order.
        chunks.map(of_chunk).reduce(|| Self::EMPTY, Self::union)
    }

    fn with(self, reference: &Reference) -> Self {
        Self {
            n: self.n + 1,
            bounds: self.bounds.union(reference.corners()),
            centers: self.centers.union(reference.center_corners()),
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

/// The beginnings of the room on the left and on the right.
pub(super) type Sides<'a> = [&'a mut [Reference]; 2];

/// Moves whole references, in their order.
pub(super) fn by_bins(simd: Simd, references: &[Reference], to: Sides, split: &Split) -> [Part; 2] {
    let [left, right] = match references.len() < PARALLEL {
        true => simd.run(Deal {
            references,
            to,
            split,
        }),
        false => deal_in_parallel(simd, references, to, split),
    };
    [
        Part {
            n: split.n_left,
            bounds: split.left,
            centers: left,
        },
        Part {
            n: references.len() - split.n_left,
            bounds: split.right,
            centers: right,
        },
    ]
}

/// Moves references; gives the boxes around the centres on both sides.
struct Deal<'a, 'r> {
    references: &'a [Reference],
    to: Sides<'r>,
    split: &'a Split,
}

impl Work for Deal<'_, '_> {
    type Output = [Corners; 2];

    #[inline(always)]
    fn run<I: InstructionSet>(self, _: I) -> [Corners; 2] {
        let mut ends = [0; 2];
        let mut centers = [Corners::EMPTY; 2];
        for reference in self.references {
            // No branch on the side, which nobody can foretell.
            let side = usize::from(!self.split.is_left(reference));
            self.to[side][ends[side]] = *reference;
            ends[side] += 1;
            centers[side] = centers[side].union(reference.center_corners());
        }
        centers
    }
}

/// Each chunk has its own stretch on either side.
fn deal_in_parallel(
    simd: Simd,
    references: &[Reference],
    to: Sides,
    split: &Split,
) -> [Corners; 2] {
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
    let stretches: Option<Vec<Sides>> = n_left
        .into_iter()
        .zip(references.chunks(CHUNK))
        .map(&mut take)
        .collect();
    chunks
        .zip(stretches.expect("both sides were counted"))
        .map(|(references, to)| {
            simd.run(Deal {
                references,
                to,
                split,
            })
        })
        .reduce(
            || [Corners::EMPTY; 2],
            |[a, b], [c, d]| [a.union(c), b.union(d)],
        )
}

/// Moves references to the sides of a plane, those across it in two parts.
pub(super) fn by_cut(
    references: &[Reference],
    to: Sides,
    cut: &Cut,
    primitives: &[Primitive],
) -> [Part; 2] {
    let mut parts = [Part::EMPTY; 2];
    for reference in references {
        for (side, part) in cut.sides(reference, primitives).into_iter().enumerate() {
            if let Some(part) = part {
                to[side][parts[side].n] = part;
                parts[side] = parts[side].with(&part);
            }
        }
    }
    // If rounding left a side empty, a test too many does no harm.
    for side in 0..2 {
        if parts[side].n == 0 {
            to[side][0] = to[1 - side][0];
            parts[side] = Part::EMPTY.with(&to[side][0]);
        }
    }
    parts
}

/// Moves the references as they stand, half to each side.
pub(super) fn by_halves(references: &[Reference], to: Sides) -> [Part; 2] {
    let (left, right) = references.split_at(references.len() / 2);
    let [to_left, to_right] = to;
    to_left[..left.len()].copy_from_slice(left);
    to_right[..right.len()].copy_from_slice(right);
    [left, right].map(Part::of)
}
