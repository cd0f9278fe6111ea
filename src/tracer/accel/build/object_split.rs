//! Object splits: the binned SAH.
//!
//! Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies" (2007): the references are
//! counted in bins by their centers, and only the planes between bins are evaluated.

use super::bounds::LaneBounds;
use super::object_bins::{CentroidGrid, ObjectBins};
use super::reference::{Reference, map_reduce};
use math::simd::{Arithmetic, InstructionSet, Simd, SimdKernel};

/// Number of references from which they are binned in parallel.
const PARALLEL: usize = 1 << 15;

/// A split of references by the bins of their centers on one axis.
#[derive(Clone, Copy)]
pub(super) struct ObjectSplit {
    axis: usize,
    grid: CentroidGrid,
    /// References from this position on go right.
    first_right: f32,
    pub(super) n_left: usize,
    pub(super) left: LaneBounds,
    pub(super) right: LaneBounds,
    /// For each side: half of the surface area times the number of references.
    pub(super) costs: [f32; 2],
}

impl ObjectSplit {
    /// Returns the cheapest split by the surface area heuristic, with `N` bins per axis, a power of
    /// two, or `None` if all centers are in the same bin.
    #[inline(always)]
    pub(super) fn best<I: InstructionSet, const N: usize>(
        set: I,
        references: &[Reference],
        centers: &LaneBounds,
    ) -> Option<Self> {
        let grid = CentroidGrid::new::<N>(centers);
        let bins = ObjectBins::<N>::fill(set, references, &grid);
        Self::cheapest(set, &bins, &grid)
    }

    /// Returns the cheapest split between two of these bins.
    #[inline(always)]
    fn cheapest<I: InstructionSet, const N: usize>(
        set: I,
        bins: &ObjectBins<N>,
        grid: &CentroidGrid,
    ) -> Option<Self> {
        let (axis, first_right_bin) = bins.cheapest_plane(set)?;
        let (left, n_left) = bins.sum(set, axis, 0..first_right_bin);
        let (right, n_right) = bins.sum(set, axis, first_right_bin..N);
        Some(Self {
            axis,
            grid: *grid,
            first_right: CentroidGrid::least_position(first_right_bin),
            n_left,
            left,
            right,
            costs: [
                left.half_area() * n_left as f32,
                right.half_area() * n_right as f32,
            ],
        })
    }

    /// Computes [`best`](Self::best) with 32 bins, in parallel.
    pub(super) fn best_of_many(
        simd: Simd,
        references: &[Reference],
        centers: &LaneBounds,
    ) -> Option<Self> {
        let grid = &CentroidGrid::new::<32>(centers);
        let bin = |references: &[Reference]| simd.run(BinReferences { references, grid });
        let bins = map_reduce(references, PARALLEL, bin, ObjectBins::merged);
        simd.run(CheapestSplit { bins: &bins, grid })
    }

    /// Returns the sum of the costs of both sides.
    #[inline(always)]
    pub(super) fn cost(&self) -> f32 {
        self.costs[0] + self.costs[1]
    }

    /// Returns half of the surface area of the intersection of both sides' boxes.
    pub(super) fn overlap(&self) -> f32 {
        let common = self.left.intersection(self.right);
        if common.is_empty() {
            0.0
        } else {
            common.half_area()
        }
    }

    /// Returns true if the reference goes right.
    #[inline(always)]
    pub(super) fn is_right(&self, reference: &Reference) -> bool {
        self.first_right <= self.grid.position(reference, self.axis)
    }

    /// Returns all lanes true if the reference with twice this center goes right, else none.
    #[inline(always)]
    pub(super) fn right_mask<I: InstructionSet>(
        &self,
        set: I,
        center: I::Lanes,
    ) -> <I::Lanes as Arithmetic>::Mask {
        let position = self.grid.position_of(set, center, self.axis);
        set.splat(self.first_right).le(position)
    }
}

/// Counts references in bins.
struct BinReferences<'a> {
    references: &'a [Reference],
    grid: &'a CentroidGrid,
}

impl SimdKernel for BinReferences<'_> {
    type Output = ObjectBins<32>;

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) -> ObjectBins<32> {
        ObjectBins::fill(set, self.references, self.grid)
    }
}

/// Finds the cheapest split.
struct CheapestSplit<'a> {
    bins: &'a ObjectBins<32>,
    grid: &'a CentroidGrid,
}

impl SimdKernel for CheapestSplit<'_> {
    type Output = Option<ObjectSplit>;

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) -> Option<ObjectSplit> {
        ObjectSplit::cheapest(set, self.bins, self.grid)
    }
}
