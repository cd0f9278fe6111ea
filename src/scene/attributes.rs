//! Attributes of primitives beyond their shapes: normals and colors of files.

use glam::Vec3;

use super::primitive::Primitive;
use crate::geometry::Shape;

/// The attributes of one object's primitives, in the order of the primitives.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) enum Attributes {
    /// No attributes.
    #[default]
    None,
    /// Normals at the vertices of triangles.
    Normals(VertexNormals),
    /// A color per primitive: red, green and blue.
    Colors(Vec<[u8; 3]>),
}

/// Normals at the vertices of an object's triangles.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct VertexNormals {
    /// In world space, of unit length; NaN for a missing normal.
    pub(super) vectors: Vec<Vec3>,
    /// Three indices into `vectors` per triangle.
    pub(super) triangles: Vec<[u32; 3]>,
}

impl VertexNormals {
    /// The unit normal at a point of `primitive`, which is triangle `i`: the
    /// interpolation of the normals at its vertices; `None` if one is missing.
    pub(super) fn at(&self, primitive: &Primitive, i: usize, point: Vec3) -> Option<Vec3> {
        let Some(Shape::Triangle(triangle)) = primitive.world_shape() else {
            return None;
        };
        let weights = triangle.barycentrics(point).to_array();
        let vertices = self.triangles[i].iter().zip(weights);
        vertices
            .map(|(&normal, weight)| weight * self.vectors[normal as usize])
            .sum::<Vec3>()
            .try_normalize()
    }
}
