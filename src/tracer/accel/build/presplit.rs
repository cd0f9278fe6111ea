//! Splitting the worst triangles before the tree is built.
//!
//! Karras and Aila, "Fast Parallel Construction of High-Quality Bounding Volume Hierarchies" (HPG
//! 2013), section 4: a budget of splits is distributed over the triangles by a priority, which
//! depends on how much of a triangle's box is empty and on the level of the tree that it affects.
//! The planes come from an octree over the scene, the largest cells first, since the tree will
//! split its primitives close to them.

use rayon::prelude::*;

use super::bounds::LaneBounds;
use super::reference::Reference;
use world::geometry::Shape;
use world::scene::Primitive;

/// Budget of splits per triangle; each split adds a reference.
pub(super) const SPLITS_PER_TRIANGLE: f64 = 0.3;
/// Levels of the octree.
const N_LEVELS: i32 = 20;
/// Greatest number of splits of one triangle.
const MAX_SPLITS: u32 = 1 << 10;
/// References per task.
const CHUNK: usize = 4096;

/// Splits some of the references.
pub(super) fn presplit(
    references: Vec<Reference>,
    primitives: &[Primitive],
    bounds: &LaneBounds,
) -> Vec<Reference> {
    // Rate the benefit of splitting each reference.
    let octree = Octree::new(bounds);
    let priority = |reference| octree.priority(reference, primitives);
    let priorities: Vec<f32> = references
        .par_iter()
        .with_min_len(CHUNK)
        .map(priority)
        .collect();
    // Distribute the budget of splits by these priorities.
    let n_triangles = references.iter().filter(|r| r.is_triangle()).count();
    let budget = SPLITS_PER_TRIANGLE * n_triangles as f64;
    let Some(splits_per_priority) = scale(&priorities, budget) else {
        return references;
    };
    // Split, in parallel; the order of the references is kept.
    let split = |(references, priorities): (&[Reference], &[f32])| {
        let mut parts = Vec::with_capacity(2 * references.len());
        for (reference, &priority) in references.iter().zip(priorities) {
            let n_splits = n_splits(priority, splits_per_priority);
            octree.split(*reference, n_splits, primitives, &mut parts);
        }
        parts
    };
    let chunks = references.par_chunks(CHUNK);
    chunks
        .zip(priorities.par_chunks(CHUNK))
        .flat_map_iter(split)
        .collect()
}

fn n_splits(priority: f32, splits_per_priority: f64) -> u32 {
    // The conversion saturates.
    ((f64::from(priority) * splits_per_priority) as u32).min(MAX_SPLITS)
}

/// Returns the factor from priorities to numbers of splits that exhausts the budget, or `None` if
/// no reference can be split.
fn scale(priorities: &[f32], budget: f64) -> Option<f64> {
    let n_splits = |scale: f64| -> u64 {
        let priorities = priorities.par_iter().with_min_len(CHUNK);
        let splits = priorities.map(|&priority| u64::from(self::n_splits(priority, scale)));
        splits.sum()
    };
    let sums = priorities.par_chunks(CHUNK).map(|chunk| {
        let priorities = chunk.iter().map(|&priority| f64::from(priority));
        priorities.sum::<f64>()
    });
    // Add serially: the sum of floats depends on their order.
    let sum: f64 = sums.collect::<Vec<f64>>().iter().sum();
    let mut scale = budget / sum;
    if !scale.is_finite() {
        return None;
    }
    // Rounding down to whole splits leaves part of the budget unused, half a split per triangle or
    // more: increase the factor in ever smaller steps.
    let mut factor = 4.0;
    for _ in 0..12 {
        if n_splits(scale * factor) as f64 <= budget {
            scale *= factor;
        } else {
            factor = f64::sqrt(factor);
        }
    }
    Some(scale)
}

/// Planes that bisect a cube around the scene, its halves and so on.
struct Octree {
    from: [f32; 3],
    cells_per_length: f32,
    /// Number of cells along an axis.
    n_cells: u32,
}

/// A plane of the octree.
struct OctreePlane {
    axis: usize,
    position: f32,
    /// 0 for the plane in the middle, 1 for the planes that bisect the halves, and so on.
    level: i32,
}

impl Octree {
    fn new(bounds: &LaneBounds) -> Self {
        let side = (0..3).fold(0.0_f32, |side, axis| side.max(bounds.extent(axis)));
        let n_cells = 1 << N_LEVELS;
        Self {
            from: [0, 1, 2].map(|axis| bounds.min(axis)),
            cells_per_length: n_cells as f32 / side,
            n_cells,
        }
    }

    /// Returns the benefit of splitting the reference; 0 if it cannot be split.
    fn priority(&self, reference: &Reference, primitives: &[Primitive]) -> f32 {
        let shape = primitives[reference.primitive() as usize].world_shape();
        let (Some(Shape::Triangle(triangle)), Some(plane)) = (shape, self.plane(reference)) else {
            return 0.0;
        };
        let [a, b, c] = triangle.vertices;
        // The boxes' half area in the limit of infinitely many splits.
        let least = 0.5 * (b - a).cross(c - a).abs().element_sum();
        let empty = (reference.bounds().half_area() - least).max(0.0);
        libm::cbrtf(libm::ldexpf(empty, -2 * plane.level))
    }

    /// Splits the reference `n_splits` times, as far as possible; adds the parts to `parts`.
    fn split(
        &self,
        reference: Reference,
        n_splits: u32,
        primitives: &[Primitive],
        parts: &mut Vec<Reference>,
    ) {
        let plane = if n_splits == 0 {
            None
        } else {
            self.plane(&reference)
        };
        let Some(OctreePlane { axis, position, .. }) = plane else {
            return parts.push(reference);
        };
        match reference.split(primitives, axis, position) {
            [Some(below), Some(above)] => {
                // The longer part gets more of the remaining splits.
                let [a, b] = [below, above].map(|part| longest_side(&part));
                let rest = n_splits - 1;
                let n_below = ((rest as f32 * (a / (a + b)) + 0.5) as u32).min(rest);
                self.split(below, n_below, primitives, parts);
                self.split(above, rest - n_below, primitives, parts);
            }
            [one, other] => parts.extend(one.or(other)),
        }
    }

    /// Returns the plane of the lowest level that intersects the reference's box, across its
    /// longest side if there are several, or `None` if there is none.
    fn plane(&self, reference: &Reference) -> Option<OctreePlane> {
        let bounds = reference.bounds();
        let planes = (0..3).filter_map(|axis| {
            let [first, last] = [bounds.min(axis), bounds.max(axis)].map(|x| self.cell(x, axis));
            // The highest bit in which the two differ.
            let bit = (first ^ last).checked_ilog2()?;
            let cell = last >> bit << bit;
            let position = self.from[axis] + cell as f32 / self.cells_per_length;
            let is_inside = bounds.min(axis) < position && position < bounds.max(axis);
            is_inside.then_some(OctreePlane {
                axis,
                position,
                level: N_LEVELS - 1 - bit as i32,
            })
        });
        planes.min_by(|a, b| {
            let lengths = [a, b].map(|plane| bounds.extent(plane.axis));
            a.level
                .cmp(&b.level)
                .then(lengths[1].total_cmp(&lengths[0]))
        })
    }

    fn cell(&self, x: f32, axis: usize) -> u32 {
        let cell = (x - self.from[axis]) * self.cells_per_length;
        (cell as u32).min(self.n_cells - 1)
    }
}

fn longest_side(reference: &Reference) -> f32 {
    let bounds = reference.bounds();
    (0..3).fold(0.0, |longest, axis| bounds.extent(axis).max(longest))
}
