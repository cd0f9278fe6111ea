//! The attributes of the vertices of a primitive.

use glam::Vec3;
use gltf_json::Index;
use gltf_json::accessor::Accessor;
use gltf_json::mesh::{MorphTarget, Primitive, Semantic};
use gltf_json::validation::Checked;

use super::accessor::Accessors;
use crate::budget::Budget;
use crate::{FileFault, Result};

/// A primitive whose vertices morph targets move.
pub(super) struct Moving<'a> {
    pub(super) primitive: &'a Primitive,
    /// The weights of its targets; 0 for missing ones.
    pub(super) weights: &'a [f32],
}

/// Returns the accessor of an attribute, if there is one.
pub(super) fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<Index<Accessor>> {
    primitive.attributes.get(&Checked::Valid(semantic)).copied()
}

impl Accessors<'_> {
    /// Returns the values of an attribute at the vertices, if there is one.
    ///
    /// # Errors
    /// There are too few values, or they need too much memory.
    pub(super) fn values<const N: usize>(
        &self,
        primitive: &Primitive,
        semantic: Semantic,
        n_vertices: usize,
        budget: &mut Budget,
    ) -> Result<Option<Vec<[f32; N]>>> {
        let index = attribute(primitive, semantic);
        let values = index.map(|index| self.of_vertices(index, n_vertices, budget));
        values.transpose()
    }

    /// Adds the weighted displacements of morph targets, of an attribute, to values of the vertices.
    ///
    /// # Errors
    /// As [`values`](Self::values).
    pub(super) fn move_by_targets(
        &self,
        moving: &Moving,
        of: impl Fn(&MorphTarget) -> Option<Index<Accessor>>,
        values: &mut [[f32; 3]],
        budget: &mut Budget,
    ) -> Result<()> {
        let targets = moving.primitive.targets.iter().flatten();
        for (target, &weight) in targets
            .zip(moving.weights)
            .filter(|(_, weight)| **weight != 0.0)
        {
            let Some(index) = of(target) else {
                continue;
            };
            let moved = self.of_vertices::<3>(index, values.len(), budget)?;
            for (value, moved) in values.iter_mut().zip(moved) {
                *value = (Vec3::from(*value) + weight * Vec3::from(moved)).to_array();
            }
        }
        Ok(())
    }

    /// Returns the values of the vertices.
    fn of_vertices<const N: usize>(
        &self,
        index: Index<Accessor>,
        n_vertices: usize,
        budget: &mut Budget,
    ) -> Result<Vec<[f32; N]>> {
        let mut values = self.vectors(index, budget)?;
        if values.len() >= n_vertices {
            values.truncate(n_vertices);
            return Ok(values);
        }
        let problem = format!(
            "`accessors[{}]` has {} elements",
            index.value(),
            values.len()
        );
        let expected = format!("one for each of the {n_vertices} vertices");
        Err(FileFault::new(problem, expected))
    }
}
