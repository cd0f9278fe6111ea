//! The cheapest way to part references in two.
//!
//! Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies"
//! (2007): the references are counted into bins by their centres, and only
//! planes between bins are weighed.

use rayon::prelude::*;

use super::reference::{Corners, Reference};
use crate::accel::simd::{InstructionSet, Simd, Work};

/// From so many references on they are counted in parallel.
const PARALLEL: usize = 1 << 16;

/// A way to part references in two: by the bin of their centres on one axis.
pub(super) struct Split {
    axis: usize,
    grid: Grid,
    /// References in lower bins go left.
    first_right_bin: usize,
    pub(super) n_left: usize,
    pub(super) left: Corners,
    pub(super) right: Corners,
    /// Of both sides: half of the area times the number of references.
    pub(super) costs: [f32; 2],
}

impl Split {
    /// The cheapest one by the surface area heuristic, over `N` bins an axis, a
    /// power of two; `None` if all centres coincide, in the bins' view.
    pub(super) fn best<const N: usize>(
        simd: Simd,
        references: &[Reference],
        centers: &Corners,
    ) -> Option<Self> {
        let grid = Grid::new::<N>(centers);
        let bins = Bins::<N>::of(simd, references, &grid);
        let candidates = (0..3).filter(|&axis| grid.bins_per_length[axis] > 0.0);
        let (axis, first_right_bin, _) = candidates
            .filter_map(|axis| bins.cheapest_plane(axis))
            .min_by(|a, b| a.2.total_cmp(&b.2))?;
        let (left, n_left) = bins.sum(axis, 0..first_right_bin);
        let (right, n_right) = bins.sum(axis, first_right_bin..N);
        Some(Self {
            axis,
            grid,
            first_right_bin,
            n_left,
            left,
            right,
            costs: [
                left.half_area() * n_left as f32,
                right.half_area() * n_right as f32,
            ],
        })
    }

    /// The costs of both sides together.
    pub(super) fn cost(&self) -> f32 {
        self.costs[0] + self.costs[1]
    }

    /// Half of the area of what both sides' boxes have in common.
    pub(super) fn overlap(&self) -> f32 {
        let common = self.left.intersection(self.right);
        match common.is_empty() {
            true => 0.0,
            false => common.half_area(),
        }
    }

    /// On which side the reference goes.
    #[inline]
    pub(super) fn is_left(&self, reference: &Reference) -> bool {
        self.grid.bin(reference, self.axis) < self.first_right_bin
    }
}

/// Where the bins are.
#[derive(Clone, Copy)]
struct Grid {
    /// Least centres, all doubled.
    from: [f32; 3],
    /// 0 on an axis of no use.
    bins_per_length: [f32; 3],
    mask: u32,
}

impl Grid {
    fn new<const N: usize>(centers: &Corners) -> Self {
        let bins_per_length = |axis| {
            // A little less, so that the last centre falls into the last bin.
            let factor = N as f32 * 0.9999 / centers.extent(axis);
            if factor.is_finite() && factor > 0.0 {
                factor
            } else {
                0.0
            }
        };
        Self {
            from: std::array::from_fn(|axis| centers.min(axis)),
            bins_per_length: std::array::from_fn(bins_per_length),
            mask: N as u32 - 1,
        }
    }

    /// The bin on an axis.
    #[inline]
    fn bin(&self, reference: &Reference, axis: usize) -> usize {
        // Beyond 2^23 floats are integers: adding it rounds, and the last bits
        // are the number; cheaper than a conversion, which has to mind NaN.
        const TWO_TO_23: f32 = 8_388_608.0;
        let bin = (reference.center()[axis] - self.from[axis]) * self.bins_per_length[axis];
        let above = bin - 0.5;
        let rounded = if above > 0.0 { above } else { 0.0 } + TWO_TO_23;
        (rounded.to_bits() & self.mask) as usize
    }
}

/// Counts references, from `parallel` of them on in parallel. What is merged
/// are maxima and sums of integers, the same in any order.
pub(super) fn tally<T: Send>(
    references: &[Reference],
    parallel: usize,
    of_few: impl Fn(&[Reference]) -> T + Send + Sync,
    merged: impl Fn(T, T) -> T + Send + Sync,
) -> T {
    if references.len() < parallel {
        return of_few(references);
    }
    references
        .par_chunks(parallel / 4)
        .map(&of_few)
        .reduce(|| of_few(&[]), merged)
}

/// Numbers of references and the boxes around them, `N` on each axis.
struct Bins<const N: usize> {
    boxes: [[Corners; N]; 3],
    counts: [[u32; N]; 3],
}

impl<const N: usize> Bins<N> {
    const EMPTY: Self = Self {
        boxes: [[Corners::EMPTY; N]; 3],
        counts: [[0; N]; 3],
    };

    fn of(simd: Simd, references: &[Reference], grid: &Grid) -> Self {
        let of_few = |references: &[Reference]| simd.run(Count { references, grid });
        tally(references, PARALLEL, of_few, Self::merged)
    }

    fn merged(mut self, other: Self) -> Self {
        for axis in 0..3 {
            for bin in 0..N {
                self.boxes[axis][bin] = self.boxes[axis][bin].union(other.boxes[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
        self
    }

    /// The box around some bins and their number of references.
    fn sum(&self, axis: usize, range: std::ops::Range<usize>) -> (Corners, usize) {
        let boxes = self.boxes[axis][range.clone()].iter();
        let counts = self.counts[axis][range].iter();
        (
            boxes.fold(Corners::EMPTY, |sum, &bin| sum.union(bin)),
            counts.sum::<u32>() as usize,
        )
    }

    /// The axis, the cheapest plane's right bin and the cost: areas times
    /// numbers. `None` if one bin holds all.
    fn cheapest_plane(&self, axis: usize) -> Option<(usize, usize, f32)> {
        let (boxes, counts) = (&self.boxes[axis], &self.counts[axis]);
        let mut right_costs = [f32::INFINITY; N];
        let (mut corners, mut n) = (Corners::EMPTY, 0);
        for bin in (1..N).rev() {
            (corners, n) = (corners.union(boxes[bin]), n + counts[bin]);
            if n > 0 {
                right_costs[bin] = corners.half_area() * n as f32;
            }
        }
        let (mut corners, mut n) = (Corners::EMPTY, 0);
        let mut best: Option<(usize, usize, f32)> = None;
        for bin in 1..N {
            (corners, n) = (corners.union(boxes[bin - 1]), n + counts[bin - 1]);
            if n == 0 || right_costs[bin] == f32::INFINITY {
                continue;
            }
            let cost = corners.half_area() * n as f32 + right_costs[bin];
            if best.is_none_or(|best| cost < best.2) {
                best = Some((axis, bin, cost));
            }
        }
        best
    }
}

/// Counts references into bins.
struct Count<'a, const N: usize> {
    references: &'a [Reference],
    grid: &'a Grid,
}

impl<const N: usize> Work for Count<'_, N> {
    type Output = Bins<N>;

    #[inline(always)]
    fn run<I: InstructionSet>(self, _: I) -> Bins<N> {
        let mut bins = Bins::EMPTY;
        for reference in self.references {
            let corners = reference.corners();
            for axis in 0..3 {
                // The mask of the grid says that it is less than N.
                let bin = self.grid.bin(reference, axis) % N;
                bins.boxes[axis][bin] = bins.boxes[axis][bin].union(corners);
                bins.counts[axis][bin] += 1;
            }
        }
        bins
    }
}
