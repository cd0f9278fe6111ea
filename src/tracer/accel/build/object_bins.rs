//! References counted in bins by their centers, for object splits.

use std::ops::Range;

use super::bounds::LaneBounds;
use super::reference::{Reference, center};
use math::simd::{Arithmetic, InstructionSet, Lanes};

/// From 2^23 on, floats are integers: adding 2^23 rounds, and the low bits are the integer. A
/// conversion would cost more: it has to handle NaN.
pub(super) const TWO_TO_23: f32 = 8_388_608.0;

/// The positions of the bins.
#[derive(Clone, Copy)]
pub(super) struct CentroidGrid {
    /// Twice the least coordinates of the centers, in the upper lanes.
    from: LaneBounds,
    /// 0 on an axis without extent.
    bins_per_length: LaneBounds,
}

impl CentroidGrid {
    #[inline(always)]
    pub(super) fn new<const N: usize>(centers: &LaneBounds) -> Self {
        let (mut from, mut bins_per_length) = ([0.0; 8], [0.0; 8]);
        for axis in 0..3 {
            from[4 + axis] = centers.min(axis);
            // Slightly less than N bins, so that the last center is in the last bin.
            let factor = N as f32 * 0.9999 / centers.extent(axis);
            if factor.is_finite() && factor > 0.0 {
                bins_per_length[4 + axis] = factor;
            }
        }
        Self {
            from: LaneBounds(from),
            bins_per_length: LaneBounds(bins_per_length),
        }
    }

    /// Returns the least [`position`](Self::position) of references in this bin, 1 or higher.
    #[inline(always)]
    pub(super) fn least_position(bin: usize) -> f32 {
        // Halves are rounded to even numbers.
        let position = bin as f32;
        if bin.is_multiple_of(2) {
            position
        } else {
            position.next_up()
        }
    }

    /// Returns the position of a reference on an axis: its bin plus 0.5, before it is rounded.
    #[inline(always)]
    pub(super) fn position(&self, reference: &Reference, axis: usize) -> f32 {
        (reference.center(axis) - self.from.0[4 + axis]) * self.bins_per_length.0[4 + axis]
    }

    /// Returns the [`position`](Self::position) in all lanes, given twice the center.
    #[inline(always)]
    pub(super) fn position_of<I: InstructionSet>(
        &self,
        set: I,
        center: I::Lanes,
        axis: usize,
    ) -> I::Lanes {
        let center = center.permute(&[4 + axis as u32; 8], set.splat_bits(0));
        let above = center - set.splat(self.from.0[4 + axis]);
        above * set.splat(self.bins_per_length.0[4 + axis])
    }

    /// Returns the bins on all axes, in the low bits of the upper lanes.
    #[inline(always)]
    fn bins<I: InstructionSet>(&self, set: I, bounds: I::Lanes) -> [u32; 8] {
        let above = center(bounds) - self.from.lanes(set);
        let position = above * self.bins_per_length.lanes(set);
        let rounded = position + set.splat(TWO_TO_23 - 0.5);
        rounded.max(set.splat(TWO_TO_23)).to_bits()
    }
}

/// Numbers of references and the boxes around them, `N` bins on each axis.
pub(super) struct ObjectBins<const N: usize> {
    bins: [Bin; N],
}

/// Bins with the same number on each axis.
#[derive(Clone, Copy)]
#[repr(C)]
struct Bin {
    boxes: [LaneBounds; 3],
    counts: [u32; 3],
}

impl Bin {
    const EMPTY: Self = Self {
        boxes: [LaneBounds::EMPTY; 3],
        counts: [0; 3],
    };
}

impl<const N: usize> ObjectBins<N> {
    #[inline(always)]
    pub(super) fn fill<I: InstructionSet>(
        set: I,
        references: &[Reference],
        grid: &CentroidGrid,
    ) -> Self {
        let mut bins = [Bin::EMPTY; N];
        for reference in references {
            // Find the reference's bins on the three axes.
            let bounds = reference.lanes(set);
            let indices = grid.bins(set, bounds);
            // Enlarge their boxes, and count.
            for axis in 0..3 {
                // All bins are less than N; `%` removes the bits of 2^23 and the bounds check.
                let bin = &mut bins[indices[4 + axis] as usize % N];
                let sum = bounds.max(bin.boxes[axis].lanes(set));
                bin.boxes[axis] = LaneBounds::from_lanes(sum);
                bin.counts[axis] += 1;
            }
        }
        Self { bins }
    }

    pub(super) fn merged(mut self, other: Self) -> Self {
        for (bin, other) in self.bins.iter_mut().zip(other.bins) {
            for axis in 0..3 {
                bin.boxes[axis] = bin.boxes[axis].union(other.boxes[axis]);
                bin.counts[axis] += other.counts[axis];
            }
        }
        self
    }

    /// Returns the cheapest plane between two bins by the surface area heuristic: its axis and the
    /// bin to the right of it. `None` if all references are in the same bin on each axis.
    #[inline(always)]
    pub(super) fn cheapest_plane<I: InstructionSet>(&self, set: I) -> Option<(usize, usize)> {
        // Sweep from the right: the costs of the right side of the plane before each bin.
        let mut right_costs = [[f32::INFINITY; 3]; N];
        let mut right = Sums::new(set);
        for (bin, costs) in right_costs.iter_mut().enumerate().skip(1).rev() {
            *costs = right.add(set, &self.bins[bin]);
        }
        // Sweep from the left: add the costs of the left side, keep the least sum of each axis.
        let mut left = Sums::new(set);
        // Starting from infinity, the first comparison would compile to one that valgrind 3.19 gets
        // wrong for NaN (`vcmpneq_oqps`).
        let (mut least, mut first_right_bins) = ([f32::MAX; 3], [0; 3]);
        for (bin, right_costs) in right_costs.iter().enumerate().skip(1) {
            let costs = left.add(set, &self.bins[bin - 1]);
            for axis in 0..3 {
                let cost = costs[axis] + right_costs[axis];
                // An empty side has a cost of NaN.
                if cost < least[axis] {
                    (least[axis], first_right_bins[axis]) = (cost, bin);
                }
            }
        }
        // Take the cheapest axis.
        let mut axis = usize::from(least[1] < least[0]);
        axis = if least[2] < least[axis] { 2 } else { axis };
        let bin = first_right_bins[axis];
        (bin > 0).then_some((axis, bin))
    }

    /// Returns the box around a range of bins and their number of references.
    #[inline(always)]
    pub(super) fn sum<I: InstructionSet>(
        &self,
        set: I,
        axis: usize,
        bins: Range<usize>,
    ) -> (LaneBounds, usize) {
        let mut bounds = set.splat(f32::NEG_INFINITY);
        let mut n = 0;
        for bin in &self.bins[bins] {
            bounds = bounds.max(bin.boxes[axis].lanes(set));
            n += bin.counts[axis];
        }
        (LaneBounds::from_lanes(bounds), n as usize)
    }
}

/// The union of successive bins on each axis.
struct Sums<L> {
    bounds: [L; 3],
    n: [u32; 3],
}

impl<L: Lanes> Sums<L> {
    #[inline(always)]
    fn new<I: InstructionSet<Lanes = L>>(set: I) -> Self {
        Self {
            bounds: [set.splat(f32::NEG_INFINITY); 3],
            n: [0; 3],
        }
    }

    /// Adds a bin on each axis. Returns the costs of the sums: half of the surface area times the
    /// number of references, NaN if there are none.
    #[inline(always)]
    fn add<I: InstructionSet<Lanes = L>>(&mut self, set: I, bin: &Bin) -> [f32; 3] {
        let mut costs = [0.0; 3];
        for (axis, cost) in costs.iter_mut().enumerate() {
            self.bounds[axis] = self.bounds[axis].max(bin.boxes[axis].lanes(set));
            self.n[axis] += bin.counts[axis];
            *cost = LaneBounds::from_lanes(self.bounds[axis]).half_area() * self.n[axis] as f32;
        }
        costs
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn references_go_right_from_the_least_position_of_a_bin(
            bin in 1_usize..32,
            steps in -2_i32..=2,
            anywhere in 0.0_f32..32.0,
        ) {
            let near = f32::from_bits((bin as f32).to_bits().wrapping_add_signed(steps));
            for position in [near, anywhere] {
                let own = (position - 0.5).round_ties_even() as usize;
                prop_assert_eq!(CentroidGrid::least_position(bin) <= position, own >= bin);
            }
        }
    }
}
