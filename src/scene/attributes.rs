//! Attributes of primitives beyond their shapes: normals, texture coordinates and colors
//! of files.

use glam::{Vec2, Vec3};

use crate::geometry::{N_PARAMETERS, barycentrics, corners};
use crate::import::CornerValues;
use crate::material::TexturePoint;
use crate::simd::{Real, Vector};

/// The attributes of one object's primitives, in the order of the primitives.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) enum Attributes {
    /// No attributes.
    #[default]
    None,
    /// Attributes of the corners of triangles.
    Corners(CornerAttributes),
    /// A color per primitive: red, green and blue.
    Colors(Vec<[u8; 3]>),
}

/// Attributes of the corners of triangles, at least one.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct CornerAttributes {
    /// In world space, of unit length; NaN for a missing normal.
    pub(super) normals: Option<CornerValues<Vec3>>,
    /// Texture coordinates.
    pub(super) uvs: Option<CornerValues<Vec2>>,
}

/// A kind of attributes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttributeKind {
    /// None.
    None,
    /// Normals of corners.
    Normals,
    /// Texture coordinates of corners.
    Uvs,
    /// Both.
    NormalsAndUvs,
    /// Colors of primitives.
    Colors,
}

impl AttributeKind {
    /// All kinds, in the order of declaration.
    pub const ALL: [Self; 5] = [
        Self::None,
        Self::Normals,
        Self::Uvs,
        Self::NormalsAndUvs,
        Self::Colors,
    ];

    /// Whether corners have normals.
    pub fn has_normals(self) -> bool {
        matches!(self, Self::Normals | Self::NormalsAndUvs)
    }

    /// Whether corners have texture coordinates.
    pub fn has_uvs(self) -> bool {
        matches!(self, Self::Uvs | Self::NormalsAndUvs)
    }
}

impl Attributes {
    pub(super) fn kind(&self) -> AttributeKind {
        match self {
            Self::None => AttributeKind::None,
            Self::Colors(_) => AttributeKind::Colors,
            Self::Corners(corners) => match (&corners.normals, &corners.uvs) {
                (None, None) => AttributeKind::None,
                (Some(_), None) => AttributeKind::Normals,
                (None, Some(_)) => AttributeKind::Uvs,
                (Some(_), Some(_)) => AttributeKind::NormalsAndUvs,
            },
        }
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

/// A point of a triangle, or of one per lane, with texture coordinates: the interpolation
/// of those at its vertices.
#[inline(always)]
pub fn with_uv<R: Real>(
    point: TexturePoint<R>,
    triangle: &[R; N_PARAMETERS],
    [a, b, c]: [[R; 2]; 3],
) -> TexturePoint<R> {
    let [u, v, w] = barycentrics(triangle, point.position);
    let [p, q, r] = corners(triangle);
    let [to_q, to_r] = [q - p, r - p];
    let [along_q, along_r] = [[b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]];
    let area_in_world = to_q.cross(to_r).length();
    let area = along_q[0] * along_r[1] - along_r[0] * along_q[1];
    // The derivatives of the position times the area.
    let right = to_q * along_r[1] - to_r * along_q[1];
    let up = to_r * along_q[0] - to_q * along_r[0];
    TexturePoint {
        uv: [
            a[0] * u + b[0] * v + c[0] * w,
            a[1] * u + b[1] * v + c[1] * w,
        ],
        uv_density: (area.abs() / area_in_world).sqrt(),
        uv_axes: [right.flip_sign_by(area), up.flip_sign_by(area)],
        ..point
    }
}
