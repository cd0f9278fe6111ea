//! What primitives of files have beside their shapes.

use glam::Vec3;

use super::Primitive;
use crate::geometry::Shape;

/// What the primitives of one object have beside their shapes, in the order of
/// the primitives.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) enum Attributes {
    /// Nothing.
    #[default]
    None,
    /// Normals at the corners of triangles.
    Normals(CornerNormals),
    /// Colours, red, green and blue.
    Colors(Vec<[u8; 3]>),
}

/// Normals at the corners of an object's triangles.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct CornerNormals {
    /// In world space, of unit length; NaN where there is none.
    pub(super) vectors: Vec<Vec3>,
    /// Three indices of `vectors` for each triangle.
    pub(super) triangles: Vec<[u32; 3]>,
}

impl CornerNormals {
    /// The unit normal at a point of `primitive`, which is triangle `i`,
    /// interpolated between its corners; `None` if they give none.
    pub(super) fn at(&self, primitive: &Primitive, i: usize, point: Vec3) -> Option<Vec3> {
        let Some(Shape::Triangle(triangle)) = primitive.world_shape() else {
            return None;
        };
        let weights = triangle.barycentrics(point).to_array();
        let corners = self.triangles[i].iter().zip(weights);
        corners
            .map(|(&corner, weight)| weight * self.vectors[corner as usize])
            .sum::<Vec3>()
            .try_normalize()
    }
}
