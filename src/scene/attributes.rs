//! Attributes of primitives beyond their shapes: normals and colors of files.

use glam::Vec3;

use crate::geometry::{N_PARAMETERS, barycentrics};
use crate::simd::{Real, Vector};

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

/// A kind of attributes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttributeKind {
    /// None.
    None,
    /// Normals at vertices.
    Normals,
    /// Colors of primitives.
    Colors,
}

impl AttributeKind {
    /// All kinds, in the order of declaration.
    pub const ALL: [Self; 3] = [Self::None, Self::Normals, Self::Colors];
}

impl Attributes {
    pub(super) fn kind(&self) -> AttributeKind {
        match self {
            Self::None => AttributeKind::None,
            Self::Normals(_) => AttributeKind::Normals,
            Self::Colors(_) => AttributeKind::Colors,
        }
    }
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
    /// The normals at the vertices of triangle `i`.
    #[inline]
    pub(super) fn of(&self, i: usize) -> [Vec3; 3] {
        self.triangles[i].map(|normal| self.vectors[normal as usize])
    }
}

/// The unit normal at a point of a triangle, or of one per lane: the interpolation of
/// the normals at its vertices; `fallback` if one is missing.
#[inline(always)]
pub fn interpolated_normal<R: Real>(
    triangle: &[R; N_PARAMETERS],
    [a, b, c]: [Vector<R>; 3],
    point: Vector<R>,
    fallback: Vector<R>,
) -> Vector<R> {
    let [u, v, w] = barycentrics(triangle, point);
    (a * u + b * v + c * w).normalize_or(fallback)
}
