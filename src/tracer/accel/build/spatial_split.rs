//! Spatial splits: planes that split the primitives that straddle them.
//!
//! Stich, Friedrich and Dietrich, "Spatial Splits in Bounding Volume Hierarchies" (HPG 2009): space
//! is divided into bins, each with a box around the parts of the primitives inside the bin. A plane
//! between two bins splits the primitives that straddle it. Their boxes shrink on both sides, which
//! can outweigh the cost of the duplicate reference.

use super::bounds::LaneBounds;
use super::object_bins::TWO_TO_23;
use super::reference::{Reference, center, map_reduce};
use math::simd::{Arithmetic, InstructionSet, Lanes, Real, Simd, SimdKernel};
use world::geometry::{Shape, Triangle};
use world::scene::Primitive;

/// Bins per axis, a power of two.
const N_BINS: usize = 16;
/// Number of references from which they are binned in parallel.
const PARALLEL: usize = 1 << 12;

/// A plane between two bins on one axis.
pub(super) struct SpatialSplit {
    grid: SpatialGrid,
    axis: usize,
    first_right_bin: usize,
    /// Upper bounds of the numbers of references on the two sides: a box may extend into a bin that
    /// its triangle does not reach.
    pub(super) counts: [usize; 2],
    /// The sum over both sides of half of the surface area times the number of references.
    pub(super) cost: f32,
}

impl SpatialSplit {
    /// Returns the cheapest split by the surface area heuristic that duplicates at most
    /// `max_duplicates` references, or `None` if there is none.
    pub(super) fn cheapest(
        simd: Simd,
        references: &[Reference],
        primitives: &[Primitive],
        bounds: &LaneBounds,
        max_duplicates: usize,
    ) -> Option<Self> {
        let grid = &SpatialGrid::new(bounds);
        let bin = |references: &[Reference]| {
            simd.run(BinParts {
                references,
                primitives,
                grid,
            })
        };
        let bins = map_reduce(references, PARALLEL, bin, SpatialBins::merged);
        simd.run(CheapestPlane {
            bins: &bins,
            grid,
            n_most: references.len() + max_duplicates,
        })
    }

    /// Returns the parts of the reference on the left and on the right.
    #[inline]
    pub(super) fn sides(
        &self,
        reference: &Reference,
        primitives: &[Primitive],
    ) -> [Option<Reference>; 2] {
        match self.is_on_sides(reference) {
            [true, false] => return [Some(*reference), None],
            [false, true] => return [None, Some(*reference)],
            _ => {}
        }
        let position = self.grid.position(self.first_right_bin, self.axis);
        match reference.split(primitives, self.axis, position) {
            [None, None] => [Some(*reference), None],
            parts => parts,
        }
    }

    /// Returns, for the left and for the right side, true if a part of the reference goes there.
    #[inline]
    pub(super) fn is_on_sides(&self, reference: &Reference) -> [bool; 2] {
        // By bins, as the references were counted.
        let [first, last] = self.grid.bins_on(reference, self.axis);
        [first < self.first_right_bin, last >= self.first_right_bin]
    }
}

/// The positions of the bins on the axes.
#[derive(Clone, Copy)]
struct SpatialGrid {
    /// The least coordinates, negated in the lower lanes.
    from: LaneBounds,
    /// Negated in the lower lanes; 0 on an axis of hardly any extent.
    bins_per_length: LaneBounds,
    bin_length: [f32; 3],
}

impl SpatialGrid {
    fn new(bounds: &LaneBounds) -> Self {
        let extents = [0, 1, 2].map(|axis| bounds.extent(axis));
        let least = 1e-6 * extents.into_iter().fold(0.0, f32::max);
        let from = [0, 1, 2].map(|axis| bounds.min(axis));
        let bins_per_length = extents.map(|extent| {
            if extent > least {
                N_BINS as f32 / extent
            } else {
                0.0
            }
        });
        Self {
            from: LaneBounds::new(from, from),
            bins_per_length: LaneBounds::new(bins_per_length, bins_per_length),
            bin_length: extents.map(|extent| extent / N_BINS as f32),
        }
    }

    /// Returns the bins of the reference's least coordinates on all axes in the low bits of the
    /// lower lanes, and of its greatest in the upper lanes. Both are equal for a primitive that
    /// cannot be split.
    #[inline(always)]
    fn bins<I: InstructionSet>(&self, set: I, reference: &Reference) -> [u32; 8] {
        let mut bounds = reference.lanes(set);
        if !reference.is_triangle() {
            bounds = center(bounds) * set.splat(0.5);
        }
        let bins = (bounds - self.from.lanes(set)) * self.bins_per_length.lanes(set);
        let bins = bins.max(set.splat(0.0)).min(set.splat(N_BINS as f32 - 1.0));
        (bins.trunc() + set.splat(TWO_TO_23)).to_bits()
    }

    /// Returns the bins of the reference's least and greatest coordinate on an axis, as
    /// [`bins`](Self::bins) does.
    #[inline]
    fn bins_on(&self, reference: &Reference, axis: usize) -> [usize; 2] {
        let bounds = reference.bounds();
        if reference.is_triangle() {
            [bounds.min(axis), bounds.max(axis)].map(|x| self.bin(x, axis))
        } else {
            [self.bin(0.5 * reference.center(axis), axis); 2]
        }
    }

    #[inline(always)]
    fn bin(&self, x: f32, axis: usize) -> usize {
        let bin = (x - self.from.max(axis)) * self.bins_per_length.max(axis);
        // A conversion to `usize` would take more instructions.
        (bin as i32).clamp(0, N_BINS as i32 - 1) as usize
    }

    /// Returns the least coordinate of a bin.
    #[inline(always)]
    fn position(&self, bin: usize, axis: usize) -> f32 {
        self.from.max(axis) + bin as f32 * self.bin_length[axis]
    }
}

/// For each bin on each axis, the numbers of references that start and end in it, and the box
/// around their parts inside it.
struct SpatialBins([AxisBins; 3]);

struct AxisBins {
    boxes: [LaneBounds; N_BINS],
    n_begin: [u32; N_BINS],
    n_end: [u32; N_BINS],
}

impl AxisBins {
    const EMPTY: Self = Self {
        boxes: [LaneBounds::EMPTY; N_BINS],
        n_begin: [0; N_BINS],
        n_end: [0; N_BINS],
    };

    /// Enlarges the box of a bin.
    #[inline(always)]
    fn grow<I: InstructionSet>(&mut self, set: I, bin: usize, part: I::Lanes) {
        let sum = &mut self.boxes[bin % N_BINS];
        *sum = LaneBounds::from_lanes(sum.lanes(set).max(part));
    }
}

/// Counts references in bins.
struct BinParts<'a> {
    references: &'a [Reference],
    primitives: &'a [Primitive],
    grid: &'a SpatialGrid,
}

impl SimdKernel for BinParts<'_> {
    type Output = SpatialBins;

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) -> SpatialBins {
        let mut bins = [AxisBins::EMPTY; 3];
        for reference in self.references {
            let own = reference.lanes(set);
            let numbers = self.grid.bins(set, reference);
            let is_in_one = (0..3).all(|axis| numbers[axis] == numbers[4 + axis]);
            let triangle = if is_in_one {
                None
            } else {
                self.triangle(set, reference)
            };
            for (axis, bins) in bins.iter_mut().enumerate() {
                // Count the reference where it starts and where it ends.
                let [first, last] = [0, 4].map(|half| numbers[half + axis] as usize % N_BINS);
                bins.n_begin[first] += 1;
                bins.n_end[last] += 1;
                // Enlarge the box of each bin by the part of the reference inside it.
                match &triangle {
                    Some(triangle) if first < last => {
                        let cut = CutTriangle::new(set, triangle, axis);
                        cut.grow(set, self.grid, bins, [first, last], own);
                    }
                    _ => bins.grow(set, first, own),
                }
            }
        }
        SpatialBins(bins)
    }
}

/// A triangle, and its vertices as boxes.
type TriangleLanes<'a, L> = (&'a Triangle, [L; 3]);

impl BinParts<'_> {
    /// Returns the triangle of the reference, or `None` if it is to another primitive.
    #[inline(always)]
    fn triangle<I: InstructionSet>(
        &self,
        set: I,
        reference: &Reference,
    ) -> Option<TriangleLanes<'_, I::Lanes>> {
        let primitive = &self.primitives[reference.primitive() as usize];
        let Some(Shape::Triangle(triangle)) = primitive.world_shape() else {
            return None;
        };
        let [a, b, c] = triangle.vertices.map(|vertex| vertex.to_array());
        let corner = |vertex| LaneBounds::new(vertex, vertex).lanes(set);
        Some((triangle, [corner(a), corner(b), corner(c)]))
    }
}

/// A triangle that is cut at planes across an axis.
struct CutTriangle<L> {
    axis: usize,
    /// The vertices by ascending coordinate, as boxes, and their coordinates.
    vertices: [L; 3],
    x: [f32; 3],
    /// Changes per length from the first vertex to the last one, from the first to the second, and
    /// from the second to the last.
    slopes: [L; 3],
}

impl<L: Lanes> CutTriangle<L> {
    #[inline(always)]
    fn new<I: InstructionSet<Lanes = L>>(
        set: I,
        (triangle, corners): &TriangleLanes<L>,
        axis: usize,
    ) -> Self {
        // Sort without branches: they are unpredictable.
        let x = triangle.vertices.map(|vertex| vertex[axis]);
        let low = usize::from(x[1] < x[0]);
        let low = if x[2] < x[low] { 2 } else { low };
        let high = usize::from(x[1] >= x[0]);
        let high = if x[2] >= x[high] { 2 } else { high };
        let order = [low, 3 - low - high, high];
        let vertices = [corners[order[0]], corners[order[1]], corners[order[2]]];
        let mut slopes = [set.splat(0.0); 3];
        for (slope, [from, to]) in slopes.iter_mut().zip([[0, 2], [0, 1], [1, 2]]) {
            let length = x[order[to]] - x[order[from]];
            *slope = (vertices[to] - vertices[from]) * set.splat(1.0 / length);
        }
        Self {
            axis,
            vertices,
            x: order.map(|i| x[i]),
            slopes,
        }
    }

    /// Enlarges the boxes of these bins by the parts of the triangle inside each of them and inside
    /// `own`. Rounding is ignored: they only serve to choose a plane.
    #[inline(always)]
    fn grow<I: InstructionSet<Lanes = L>>(
        &self,
        set: I,
        grid: &SpatialGrid,
        bins: &mut AxisBins,
        [first, last]: [usize; 2],
        own: L,
    ) {
        // A part extends from one plane to the next, and around the vertices between them.
        let of_vertices = self.x.map(|x| grid.bin(x, self.axis));
        let mut below = set.splat(f32::NEG_INFINITY);
        for bin in first..last + 2 {
            let mut above = set.splat(f32::NEG_INFINITY);
            if of_vertices[0] < bin && bin <= of_vertices[2] {
                above = self.section(set, grid.position(bin, self.axis));
            }
            if bin > first {
                bins.grow(set, bin - 1, below.max(above).min(own));
            }
            below = above;
        }
        for (vertex, bin) in self.vertices.into_iter().zip(of_vertices) {
            if first <= bin && bin <= last {
                bins.grow(set, bin, vertex.min(own));
            }
        }
    }

    /// Returns the box around the line in which the plane at `position`, which is between two
    /// vertices, cuts the triangle.
    #[inline(always)]
    fn section<I: InstructionSet<Lanes = L>>(&self, set: I, position: f32) -> L {
        let [a, b, _] = self.vertices;
        let from_first = set.splat(position - self.x[0]);
        let long = a + self.slopes[0] * from_first;
        let short = if position < self.x[1] {
            a + self.slopes[1] * from_first
        } else {
            b + self.slopes[2] * set.splat(position - self.x[1])
        };
        // NaN where two vertices are in the plane: then the other is taken.
        short.max(long)
    }
}

impl SpatialBins {
    fn merged(mut self, other: Self) -> Self {
        for (bins, other) in self.0.iter_mut().zip(other.0) {
            for bin in 0..N_BINS {
                bins.boxes[bin] = bins.boxes[bin].union(other.boxes[bin]);
                bins.n_begin[bin] += other.n_begin[bin];
                bins.n_end[bin] += other.n_end[bin];
            }
        }
        self
    }
}

/// Finds the cheapest plane with at most `n_most` references on both sides.
struct CheapestPlane<'a> {
    bins: &'a SpatialBins,
    grid: &'a SpatialGrid,
    n_most: usize,
}

impl SimdKernel for CheapestPlane<'_> {
    type Output = Option<SpatialSplit>;

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) -> Option<SpatialSplit> {
        let mut cheapest: Option<SpatialSplit> = None;
        for (axis, bins) in self.bins.0.iter().enumerate() {
            // Sweep from the right: cost and count of the right side of the plane before each bin.
            let mut right = [(0.0, 0); N_BINS];
            let (mut bounds, mut n_right) = (set.splat(f32::NEG_INFINITY), 0);
            for bin in (1..N_BINS).rev() {
                bounds = bounds.max(bins.boxes[bin].lanes(set));
                n_right += bins.n_end[bin] as usize;
                let half_area = LaneBounds::from_lanes(bounds).half_area();
                right[bin] = (half_area * n_right as f32, n_right);
            }
            // Sweep from the left: each plane that leaves both sides occupied is a candidate.
            let (mut bounds, mut n_left) = (set.splat(f32::NEG_INFINITY), 0);
            for (bin, &(right_cost, n_right)) in right.iter().enumerate().skip(1) {
                bounds = bounds.max(bins.boxes[bin - 1].lanes(set));
                n_left += bins.n_begin[bin - 1] as usize;
                let half_area = LaneBounds::from_lanes(bounds).half_area();
                let cost = half_area * n_left as f32 + right_cost;
                let is_valid = n_left > 0 && n_right > 0 && n_left + n_right <= self.n_most;
                if is_valid && cheapest.as_ref().is_none_or(|split| cost < split.cost) {
                    cheapest = Some(SpatialSplit {
                        grid: *self.grid,
                        axis,
                        first_right_bin: bin,
                        counts: [n_left, n_right],
                        cost,
                    });
                }
            }
        }
        cheapest
    }
}
