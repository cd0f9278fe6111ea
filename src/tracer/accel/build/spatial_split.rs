//! Spatial splits: planes that split the primitives that straddle them.
//!
//! Stich, Friedrich and Dietrich, "Spatial Splits in Bounding Volume Hierarchies" (HPG 2009): space
//! is divided into bins, each with a box around the parts of the primitives inside the bin. A plane
//! between two bins splits the primitives that straddle it. Their boxes shrink on both sides, which
//! can outweigh the cost of the duplicate reference.

use glam::Vec3;

use super::bounds::LaneBounds;
use super::reference::{Reference, map_reduce};
use world::geometry::{Shape, Triangle};
use world::scene::Primitive;

/// Bins per axis.
const N_BINS: usize = 16;
/// Number of references from which they are binned in parallel.
const PARALLEL: usize = 1 << 12;

/// A plane between two bins on one axis.
pub(super) struct SpatialSplit {
    grid: SpatialGrid,
    first_right_bin: usize,
    /// Upper bounds of the numbers of references on the two sides: a box may extend into a bin that
    /// its triangle does not reach.
    pub(super) counts: [usize; 2],
    /// For each side: half of the surface area times the number of references.
    pub(super) costs: [f32; 2],
}

impl SpatialSplit {
    /// Returns the cheapest split by the surface area heuristic that duplicates at most
    /// `max_duplicates` references, or `None` if there is none.
    pub(super) fn cheapest(
        references: &[Reference],
        primitives: &[Primitive],
        bounds: &LaneBounds,
        max_duplicates: usize,
    ) -> Option<Self> {
        let largest = (0..3).fold(0.0_f32, |largest, axis| largest.max(bounds.extent(axis)));
        (0..3)
            .filter(|&axis| bounds.extent(axis) > 1e-6 * largest)
            .filter_map(|axis| {
                let grid = SpatialGrid::new(bounds, axis);
                let bins = SpatialBins::fill(references, primitives, &grid);
                bins.cheapest_plane(grid, references.len(), max_duplicates)
            })
            .min_by(|a, b| a.cost().total_cmp(&b.cost()))
    }

    /// Returns the sum of the costs of both sides.
    pub(super) fn cost(&self) -> f32 {
        self.costs[0] + self.costs[1]
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
        let position = self.grid.position(self.first_right_bin);
        match reference.split(primitives, self.grid.axis, position) {
            [None, None] => [Some(*reference), None],
            parts => parts,
        }
    }

    /// Returns, for the left and for the right side, true if a part of the reference goes there.
    #[inline]
    pub(super) fn is_on_sides(&self, reference: &Reference) -> [bool; 2] {
        // By bins, as the references were counted.
        let [first, last] = self.grid.bins(reference);
        [first < self.first_right_bin, last >= self.first_right_bin]
    }
}

/// The positions of the bins on an axis.
#[derive(Clone, Copy)]
struct SpatialGrid {
    axis: usize,
    from: f32,
    bin_length: f32,
    bins_per_length: f32,
}

impl SpatialGrid {
    fn new(bounds: &LaneBounds, axis: usize) -> Self {
        Self {
            axis,
            from: bounds.min(axis),
            bin_length: bounds.extent(axis) / N_BINS as f32,
            bins_per_length: N_BINS as f32 / bounds.extent(axis),
        }
    }

    /// Returns the bins of the reference's least and greatest coordinate. They are equal for a
    /// primitive that cannot be split.
    fn bins(&self, reference: &Reference) -> [usize; 2] {
        let bounds = reference.bounds();
        if reference.is_triangle() {
            [bounds.min(self.axis), bounds.max(self.axis)].map(|x| self.bin(x))
        } else {
            [self.bin(0.5 * reference.center(self.axis)); 2]
        }
    }

    fn bin(&self, x: f32) -> usize {
        // The conversion maps negative numbers to 0.
        (((x - self.from) * self.bins_per_length) as usize).min(N_BINS - 1)
    }

    /// Returns the least coordinate of a bin.
    fn position(&self, bin: usize) -> f32 {
        self.from + bin as f32 * self.bin_length
    }
}

/// For each bin, the numbers of references that start and end in it, and the box around their parts
/// inside it.
struct SpatialBins {
    boxes: [LaneBounds; N_BINS],
    n_begin: [u32; N_BINS],
    n_end: [u32; N_BINS],
}

impl SpatialBins {
    const EMPTY: Self = Self {
        boxes: [LaneBounds::EMPTY; N_BINS],
        n_begin: [0; N_BINS],
        n_end: [0; N_BINS],
    };

    fn fill(references: &[Reference], primitives: &[Primitive], grid: &SpatialGrid) -> Self {
        let bin = |references: &[Reference]| {
            let mut bins = Self::EMPTY;
            for reference in references {
                bins.add(reference, primitives, grid);
            }
            bins
        };
        map_reduce(references, PARALLEL, bin, Self::merged)
    }

    fn add(&mut self, reference: &Reference, primitives: &[Primitive], grid: &SpatialGrid) {
        // Count the reference where it starts and where it ends.
        let [first, last] = grid.bins(reference);
        self.n_begin[first] += 1;
        self.n_end[last] += 1;
        // Enlarge the box of each bin by the part of the reference inside it.
        let own = reference.bounds();
        match primitives[reference.primitive() as usize].world_shape() {
            Some(Shape::Triangle(triangle)) if first < last => {
                let parts = parts_in_bins(triangle, grid);
                let bins = first..=last;
                for (sum, part) in self.boxes[bins.clone()].iter_mut().zip(&parts[bins]) {
                    let part = part.intersection(own);
                    if !part.is_empty() {
                        *sum = sum.union(part);
                    }
                }
            }
            _ => self.boxes[first] = self.boxes[first].union(own),
        }
    }

    fn merged(mut self, other: Self) -> Self {
        for bin in 0..N_BINS {
            self.boxes[bin] = self.boxes[bin].union(other.boxes[bin]);
            self.n_begin[bin] += other.n_begin[bin];
            self.n_end[bin] += other.n_end[bin];
        }
        self
    }

    /// Returns the cheapest plane that splits these `n` references.
    fn cheapest_plane(
        &self,
        grid: SpatialGrid,
        n: usize,
        max_duplicates: usize,
    ) -> Option<SpatialSplit> {
        // Sweep from the right: bounds and count of the right side of the plane before each bin.
        let mut right = [(LaneBounds::EMPTY, 0); N_BINS + 1];
        for bin in (1..N_BINS).rev() {
            let (bounds, n_right) = right[bin + 1];
            right[bin] = (
                bounds.union(self.boxes[bin]),
                n_right + self.n_end[bin] as usize,
            );
        }
        // Sweep from the left: each plane that leaves both sides occupied is a candidate.
        let (mut left, mut n_left) = (LaneBounds::EMPTY, 0);
        let candidate = |bin: usize| {
            left = left.union(self.boxes[bin - 1]);
            n_left += self.n_begin[bin - 1] as usize;
            let (right, n_right) = right[bin];
            let is_valid = n_left > 0 && n_right > 0 && n_left + n_right <= n + max_duplicates;
            is_valid.then(|| SpatialSplit {
                grid,
                first_right_bin: bin,
                counts: [n_left, n_right],
                costs: [
                    left.half_area() * n_left as f32,
                    right.half_area() * n_right as f32,
                ],
            })
        };
        let candidates = (1..N_BINS).filter_map(candidate);
        candidates.min_by(|a, b| a.cost().total_cmp(&b.cost()))
    }
}

/// Returns the boxes around the parts of a triangle in each bin. Rounding is ignored: they only
/// serve to choose a plane.
fn parts_in_bins(triangle: &Triangle, grid: &SpatialGrid) -> [LaneBounds; N_BINS] {
    let mut parts = [LaneBounds::EMPTY; N_BINS];
    let mut add = |bin: usize, point: Vec3| {
        let point = LaneBounds::new(point.into(), point.into());
        parts[bin] = parts[bin].union(point);
    };
    let [a, b, c] = triangle.vertices;
    for (from, to) in [(a, b), (b, c), (c, a)] {
        let [x, y] = [from[grid.axis], to[grid.axis]];
        let [i, j] = [grid.bin(x), grid.bin(y)];
        // Add the vertex to its bin.
        add(i, from);
        // Add the points where the edge crosses planes to the bins on both sides.
        for bin in i.min(j) + 1..=i.max(j) {
            let fraction = (grid.position(bin) - x) / (y - x);
            let crossing = from + fraction * (to - from);
            add(bin - 1, crossing);
            add(bin, crossing);
        }
    }
    parts
}
