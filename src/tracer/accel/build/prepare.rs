//! Primitives → references to them.

use bytemuck::Zeroable;
use rayon::prelude::*;

use super::partition::Subset;
use super::presplit;
use super::reference::Reference;
use crate::accel::Quality;
use math::simd::Simd;
use world::scene::Primitive;

/// References that spatial splits may add per triangle.
const SPATIAL_SPLITS_PER_TRIANGLE: f64 = 0.5;

/// References per task.
const CHUNK: usize = 1 << 12;

/// Returns the greatest number of references per primitive.
pub(super) fn references_per_primitive(quality: Quality) -> f64 {
    match quality {
        Quality::Fast => 1.0,
        Quality::Balanced => 1.0 + presplit::SPLITS_PER_TRIANGLE,
        Quality::High => 1.0 + SPATIAL_SPLITS_PER_TRIANGLE,
    }
}

/// Returns the references to all primitives except the `unbounded`, presplit or with memory for
/// spatial splits, and the subset of all of them.
pub(super) fn references(
    simd: Simd,
    primitives: &[Primitive],
    unbounded: &[u32],
    quality: Quality,
) -> (Vec<Reference>, Subset) {
    let mut references = bounded_references(primitives, unbounded);
    let mut whole = Subset::new(simd, &references);
    match quality {
        Quality::Fast => {}
        Quality::Balanced => {
            references = presplit::presplit(references, primitives, &whole.bounds);
            whole = Subset::new(simd, &references);
        }
        Quality::High => {
            let n_triangles = references.iter().filter(|r| r.is_triangle()).count();
            let n_splits = (SPATIAL_SPLITS_PER_TRIANGLE * n_triangles as f64) as usize;
            references.resize(references.len() + n_splits, Reference::zeroed());
        }
    }
    (references, whole)
}

/// Returns the references to all primitives except the `unbounded`, whose indices ascend.
fn bounded_references(primitives: &[Primitive], unbounded: &[u32]) -> Vec<Reference> {
    // Number of bounded primitives before each unbounded one.
    let n_before: Vec<usize> = (0..).zip(unbounded).map(|(i, &u)| u as usize - i).collect();
    let reference = |i| {
        let index = i + n_before.partition_point(|&n| n <= i);
        Reference::new(&primitives[index], index as u32)
    };
    (0..primitives.len() - unbounded.len())
        .into_par_iter()
        .with_min_len(CHUNK)
        .map(reference)
        .collect()
}
