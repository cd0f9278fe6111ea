//! The cheapest plane to cut references in two.
//!
//! Stich, Friedrich and Dietrich, "Spatial Splits in Bounding Volume
//! Hierarchies" (HPG 2009): space is divided into bins, each with a box around
//! the parts of the primitives in there, and a plane between bins cuts the
//! primitives that lie across it. Their boxes shrink on both sides, which pays
//! for having them twice.

use glam::Vec3;
use rayon::prelude::*;

use super::reference::{Corners, Reference};
use crate::geometry::{Shape, Triangle};
use crate::scene::Primitive;

/// Bins on each axis.
const N_BINS: usize = 16;
/// From so many references on they are counted in parallel.
const PARALLEL: usize = 1 << 12;

/// A plane between two bins on one axis.
pub(super) struct Cut {
    grid: Grid,
    first_right_bin: usize,
    /// References on the two sides, at most: a box may reach to where nothing
    /// of its triangle is.
    pub(super) counts: [usize; 2],
    /// Of both sides: half of the area times the number of references.
    pub(super) costs: [f32; 2],
}

impl Cut {
    /// The cheapest one by the surface area heuristic that makes `room` more
    /// references at most; `None` if there is none.
    pub(super) fn cheapest(
        references: &[Reference],
        primitives: &[Primitive],
        bounds: &Corners,
        room: usize,
    ) -> Option<Self> {
        let largest = (0..3).fold(0.0_f32, |largest, axis| largest.max(bounds.extent(axis)));
        (0..3)
            .filter(|&axis| bounds.extent(axis) > 1e-6 * largest)
            .filter_map(|axis| {
                let grid = Grid::new(bounds, axis);
                let bins = Bins::of(references, primitives, &grid);
                bins.cheapest_plane(grid, references.len(), room)
            })
            .min_by(|a, b| a.cost().total_cmp(&b.cost()))
    }

    /// The costs of both sides together.
    pub(super) fn cost(&self) -> f32 {
        self.costs[0] + self.costs[1]
    }

    /// The reference's parts to the left and to the right.
    #[inline]
    pub(super) fn sides(
        &self,
        reference: &Reference,
        primitives: &[Primitive],
    ) -> [Option<Reference>; 2] {
        match self.is_on(reference) {
            [true, false] => return [Some(*reference), None],
            [false, true] => return [None, Some(*reference)],
            _ => {}
        }
        let position = self.grid.position(self.first_right_bin);
        match reference.cut(primitives, self.grid.axis, position) {
            [None, None] => [Some(*reference), None],
            parts => parts,
        }
    }

    /// Whether something of the reference goes to the left, and to the right.
    #[inline]
    pub(super) fn is_on(&self, reference: &Reference) -> [bool; 2] {
        // By bins, as they were counted.
        let [first, last] = self.grid.bins(reference);
        [first < self.first_right_bin, last >= self.first_right_bin]
    }
}

/// Where the bins are on an axis.
#[derive(Clone, Copy)]
struct Grid {
    axis: usize,
    from: f32,
    bin_length: f32,
    bins_per_length: f32,
}

impl Grid {
    fn new(bounds: &Corners, axis: usize) -> Self {
        Self {
            axis,
            from: bounds.min(axis),
            bin_length: bounds.extent(axis) / N_BINS as f32,
            bins_per_length: N_BINS as f32 / bounds.extent(axis),
        }
    }

    /// The bins of the reference's least and greatest coordinate; the same for
    /// what is not to be cut.
    fn bins(&self, reference: &Reference) -> [usize; 2] {
        let corners = reference.corners();
        match reference.is_triangle() {
            true => [corners.min(self.axis), corners.max(self.axis)].map(|x| self.bin(x)),
            false => [self.bin(0.5 * reference.center()[self.axis]); 2],
        }
    }

    fn bin(&self, x: f32) -> usize {
        // A conversion of a number below 0 gives 0.
        (((x - self.from) * self.bins_per_length) as usize).min(N_BINS - 1)
    }

    /// Where a bin begins.
    fn position(&self, bin: usize) -> f32 {
        self.from + bin as f32 * self.bin_length
    }
}

/// How many references begin and end in each bin, and the boxes around what of
/// them is in there.
struct Bins {
    boxes: [Corners; N_BINS],
    n_begin: [u32; N_BINS],
    n_end: [u32; N_BINS],
}

impl Bins {
    const EMPTY: Self = Self {
        boxes: [Corners::EMPTY; N_BINS],
        n_begin: [0; N_BINS],
        n_end: [0; N_BINS],
    };

    fn of(references: &[Reference], primitives: &[Primitive], grid: &Grid) -> Self {
        let of_few = |references: &[Reference]| {
            let mut bins = Self::EMPTY;
            for reference in references {
                bins.add(reference, primitives, grid);
            }
            bins
        };
        if references.len() < PARALLEL {
            return of_few(references);
        }
        // Maxima and sums of integers: the same in any order.
        references
            .par_chunks(PARALLEL / 4)
            .map(of_few)
            .reduce(|| Self::EMPTY, Self::merged)
    }

    fn add(&mut self, reference: &Reference, primitives: &[Primitive], grid: &Grid) {
        let [first, last] = grid.bins(reference);
        self.n_begin[first] += 1;
        self.n_end[last] += 1;
        let own = reference.corners();
        match primitives[reference.index as usize].world_shape() {
            Some(Shape::Triangle(triangle)) if first < last => {
                let parts = parts(triangle, grid);
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

    /// The cheapest plane for these `n` references.
    fn cheapest_plane(&self, grid: Grid, n: usize, room: usize) -> Option<Cut> {
        let mut right = [(Corners::EMPTY, 0); N_BINS + 1];
        for bin in (1..N_BINS).rev() {
            let (corners, n_right) = right[bin + 1];
            right[bin] = (
                corners.union(self.boxes[bin]),
                n_right + self.n_end[bin] as usize,
            );
        }
        let (mut left, mut n_left) = (Corners::EMPTY, 0);
        let cut = |bin: usize| {
            left = left.union(self.boxes[bin - 1]);
            n_left += self.n_begin[bin - 1] as usize;
            let (right, n_right) = right[bin];
            let is_cut = n_left > 0 && n_right > 0 && n_left + n_right <= n + room;
            is_cut.then(|| Cut {
                grid,
                first_right_bin: bin,
                counts: [n_left, n_right],
                costs: [
                    left.half_area() * n_left as f32,
                    right.half_area() * n_right as f32,
                ],
            })
        };
        let cuts = (1..N_BINS).filter_map(cut);
        cuts.min_by(|a, b| a.cost().total_cmp(&b.cost()))
    }
}

/// The boxes around what of a triangle is in each bin, but for roundings: they
/// choose a plane, and bound nothing.
fn parts(triangle: &Triangle, grid: &Grid) -> [Corners; N_BINS] {
    let mut parts = [Corners::EMPTY; N_BINS];
    let mut add = |bin: usize, point: Vec3| {
        let point = Corners::new(point.into(), point.into());
        parts[bin] = parts[bin].union(point);
    };
    let [a, b, c] = triangle.vertices;
    for (from, to) in [(a, b), (b, c), (c, a)] {
        let [x, y] = [from[grid.axis], to[grid.axis]];
        let [i, j] = [grid.bin(x), grid.bin(y)];
        add(i, from);
        for bin in i.min(j) + 1..=i.max(j) {
            let part = (grid.position(bin) - x) / (y - x);
            let crossing = from + part * (to - from);
            add(bin - 1, crossing);
            add(bin, crossing);
        }
    }
    parts
}
