//! Object splits: the binned SAH.
//!
//! Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies"
//! (2007): the references are counted in bins by their centers, and only the
//! planes between bins are evaluated.

use super::bounds::LaneBounds;
use super::reference::{Reference, map_reduce};
use crate::simd::{InstructionSet, Simd, SimdKernel};

/// Number of references from which they are binned in parallel.
const PARALLEL: usize = 1 << 16;

/// A split of references by the bins of their centers on one axis.
pub(super) struct ObjectSplit {
    axis: usize,
    grid: CentroidGrid,
    /// References in the bins below it go left.
    first_right_bin: usize,
    pub(super) n_left: usize,
    pub(super) left: LaneBounds,
    pub(super) right: LaneBounds,
    /// For each side: half of the surface area times the number of references.
    pub(super) costs: [f32; 2],
}

impl ObjectSplit {
    /// The cheapest split by the surface area heuristic, with `N` bins per axis,
    /// a power of two; `None` if all centers are in the same bin.
    pub(super) fn best<const N: usize>(
        simd: Simd,
        references: &[Reference],
        centers: &LaneBounds,
    ) -> Option<Self> {
        let grid = CentroidGrid::new::<N>(centers);
        let bins = ObjectBins::<N>::of(simd, references, &grid);
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

    /// The sum of the costs of both sides.
    pub(super) fn cost(&self) -> f32 {
        self.costs[0] + self.costs[1]
    }

    /// Half of the surface area of the intersection of both sides' boxes.
    pub(super) fn overlap(&self) -> f32 {
        let common = self.left.intersection(self.right);
        if common.is_empty() {
            0.0
        } else {
            common.half_area()
        }
    }

    /// Whether the reference goes left.
    #[inline]
    pub(super) fn is_left(&self, reference: &Reference) -> bool {
        self.grid.bin(reference, self.axis) < self.first_right_bin
    }
}

/// The positions of the bins.
#[derive(Clone, Copy)]
struct CentroidGrid {
    /// Twice the least coordinates of the centers.
    from: [f32; 3],
    /// 0 on an axis without extent.
    bins_per_length: [f32; 3],
    mask: u32,
}

impl CentroidGrid {
    fn new<const N: usize>(centers: &LaneBounds) -> Self {
        let bins_per_length = |axis| {
            // Slightly less than N bins, so that the last center is in the last bin.
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
        // From 2^23 on, floats are integers: adding 2^23 rounds, and the low bits
        // are the integer. A conversion would cost more: it has to handle NaN.
        const TWO_TO_23: f32 = 8_388_608.0;
        let bin = (reference.center()[axis] - self.from[axis]) * self.bins_per_length[axis];
        let above = bin - 0.5;
        let rounded = if above > 0.0 { above } else { 0.0 } + TWO_TO_23;
        (rounded.to_bits() & self.mask) as usize
    }
}

/// Numbers of references and the boxes around them, `N` bins on each axis.
struct ObjectBins<const N: usize> {
    boxes: [[LaneBounds; N]; 3],
    counts: [[u32; N]; 3],
}

impl<const N: usize> ObjectBins<N> {
    const EMPTY: Self = Self {
        boxes: [[LaneBounds::EMPTY; N]; 3],
        counts: [[0; N]; 3],
    };

    fn of(simd: Simd, references: &[Reference], grid: &CentroidGrid) -> Self {
        let bin = |references: &[Reference]| simd.run(BinReferences { references, grid });
        map_reduce(references, PARALLEL, bin, Self::merged)
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

    /// The box around a range of bins and their number of references.
    fn sum(&self, axis: usize, range: std::ops::Range<usize>) -> (LaneBounds, usize) {
        let boxes = self.boxes[axis][range.clone()].iter();
        let counts = self.counts[axis][range].iter();
        (
            boxes.fold(LaneBounds::EMPTY, |sum, &bin| sum.union(bin)),
            counts.sum::<u32>() as usize,
        )
    }

    /// The cheapest plane on an axis: the axis, the bin to the right of the plane
    /// and the cost. `None` if all references are in the same bin.
    fn cheapest_plane(&self, axis: usize) -> Option<(usize, usize, f32)> {
        let (boxes, counts) = (&self.boxes[axis], &self.counts[axis]);
        let mut right_costs = [f32::INFINITY; N];
        let (mut bounds, mut n) = (LaneBounds::EMPTY, 0);
        for bin in (1..N).rev() {
            (bounds, n) = (bounds.union(boxes[bin]), n + counts[bin]);
            if n > 0 {
                right_costs[bin] = bounds.half_area() * n as f32;
            }
        }
        let (mut bounds, mut n) = (LaneBounds::EMPTY, 0);
        let mut best: Option<(usize, usize, f32)> = None;
        for bin in 1..N {
            (bounds, n) = (bounds.union(boxes[bin - 1]), n + counts[bin - 1]);
            if n == 0 || right_costs[bin] == f32::INFINITY {
                continue;
            }
            let cost = bounds.half_area() * n as f32 + right_costs[bin];
            if best.is_none_or(|best| cost < best.2) {
                best = Some((axis, bin, cost));
            }
        }
        best
    }
}

/// Counts references in bins.
struct BinReferences<'a, const N: usize> {
    references: &'a [Reference],
    grid: &'a CentroidGrid,
}

impl<const N: usize> SimdKernel for BinReferences<'_, N> {
    type Output = ObjectBins<N>;

    #[inline(always)]
    fn run<I: InstructionSet>(self, _: I) -> ObjectBins<N> {
        let mut bins = ObjectBins::EMPTY;
        for reference in self.references {
            let bounds = reference.bounds();
            for axis in 0..3 {
                // The mask of the grid keeps it below N; `%` removes the bounds check.
                let bin = self.grid.bin(reference, axis) % N;
                bins.boxes[axis][bin] = bins.boxes[axis][bin].union(bounds);
                bins.counts[axis][bin] += 1;
            }
        }
        bins
    }
}
