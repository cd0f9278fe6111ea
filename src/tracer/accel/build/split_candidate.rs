//! The candidates for the split of a node, and the choice between them.

use super::object_split::ObjectSplit;
use super::partition::Subset;
use super::reference::Reference;
use super::spatial_split::SpatialSplit;
use math::simd::Simd;
use world::scene::Primitive;

/// Least number of references for a spatial split: fewer fit into a leaf.
pub(super) const MIN_SPATIAL_SPLIT: usize = 9;
/// An object split is good enough if the boxes of both sides overlap by less than this fraction of
/// the node's surface area, as in Embree. A fraction of the root's, as Stich et al. have it in
/// section 4.2, leaves more splits to try, and no better trees.
const SMALL_OVERLAP: f32 = 0.1;

/// Inputs of the choice besides the references.
pub(super) struct SplitContext<'a> {
    pub(super) primitives: &'a [Primitive],
    pub(super) simd: Simd,
}

/// A way to split references into two subsets.
pub(super) enum SplitCandidate {
    /// Whole references, by their centers.
    Object(ObjectSplit),
    /// By a plane that splits the references that straddle it.
    Spatial(SpatialSplit),
    /// In the middle of the list.
    Halves,
}

impl SplitCandidate {
    /// Returns the cheaper of the best object split and the best spatial split that duplicates at
    /// most `max_duplicates` references.
    #[inline(always)]
    pub(super) fn cheapest(
        context: &SplitContext,
        object: Option<ObjectSplit>,
        references: &[Reference],
        subset: &Subset,
        max_duplicates: usize,
    ) -> Self {
        // Try planes only where the sides of the object split overlap much.
        let may_split = max_duplicates > 0 && references.len() >= MIN_SPATIAL_SPLIT;
        let max_overlap = SMALL_OVERLAP * subset.bounds.half_area();
        let is_good = |split: &ObjectSplit| split.overlap() <= max_overlap;
        let spatial = if may_split && !object.as_ref().is_some_and(is_good) {
            let SplitContext {
                primitives, simd, ..
            } = *context;
            SpatialSplit::cheapest(simd, references, primitives, &subset.bounds, max_duplicates)
        } else {
            None
        };
        // Take the cheaper one.
        match (object, spatial) {
            (Some(object), Some(spatial)) if object.cost() <= spatial.cost => Self::Object(object),
            (_, Some(spatial)) => Self::Spatial(spatial),
            (Some(object), None) => Self::Object(object),
            (None, None) => Self::Halves,
        }
    }

    /// Returns the part of the capacity that the left side gets.
    #[inline]
    pub(super) fn left_capacity(&self, references: &[Reference], capacity: usize) -> usize {
        let [n_left, n_right] = self.counts(references.len());
        match capacity - n_left - n_right {
            0 => n_left,
            // Large boxes get the rest: they are the most likely to be split.
            rest => n_left + (rest as f64 * self.left_share(references)) as usize,
        }
    }

    /// Returns upper bounds of the numbers of references on the two sides, out of `n`.
    #[inline]
    fn counts(&self, n: usize) -> [usize; 2] {
        match self {
            Self::Object(split) => [split.n_left, n - split.n_left],
            Self::Spatial(split) => split.counts,
            Self::Halves => [n / 2, n - n / 2],
        }
    }

    /// Returns the left side's share, from 0 to 1, of the surface area of all boxes.
    fn left_share(&self, references: &[Reference]) -> f64 {
        let mut areas = [0.0; 2];
        for reference in references {
            let area = f64::from(reference.bounds().half_area());
            let is_on_sides = self.is_on_sides(reference);
            for (sum, is_on_side) in areas.iter_mut().zip(is_on_sides) {
                *sum += if is_on_side { area } else { 0.0 };
            }
        }
        let [left, right] = areas;
        left / (left + right)
    }

    /// Returns, for the left and for the right side, true if a part of the reference goes there.
    fn is_on_sides(&self, reference: &Reference) -> [bool; 2] {
        match self {
            Self::Object(split) => {
                let is_right = split.is_right(reference);
                [!is_right, is_right]
            }
            Self::Spatial(split) => split.is_on_sides(reference),
            Self::Halves => [true; 2],
        }
    }
}
