//! Attributes of primitives beyond their shapes: normals, texture coordinates and colors
//! of files.

use glam::{Vec2, Vec3};

use crate::geometry::{Capsule, N_PARAMETERS, barycentrics, corners};

use crate::material::TexturePoint;
use math::simd::{Real, Vector};

/// A value for each corner of each triangle of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct CornerValues<T> {
    /// Values, each for one or more corners.
    pub values: Vec<T>,
    /// Three indices of `values` per triangle of the mesh.
    pub triangles: Vec<[u32; 3]>,
}

impl<T> Default for CornerValues<T> {
    fn default() -> Self {
        Self {
            values: Vec::new(),
            triangles: Vec::new(),
        }
    }
}

impl<T: Copy> CornerValues<T> {
    /// Returns the values at the corners of triangle `i`.
    #[inline]
    pub fn at(&self, i: usize) -> [T; 3] {
        self.triangles[i].map(|corner| self.values[corner as usize])
    }

    /// Returns the memory in bytes.
    pub fn n_bytes(&self) -> u64 {
        (size_of_val(&self.values[..]) + size_of_val(&self.triangles[..])) as u64
    }
}

/// The attributes of one object's primitives, in the order of the primitives.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Attributes {
    /// No attributes.
    #[default]
    None,
    /// Attributes of the corners of triangles.
    Corners(Box<CornerAttributes>),
    /// A color per primitive: linear light.
    Colors(Vec<Vec3>),
    /// The number of an array per primitive.
    Scalars(Vec<f32>),
    /// The numbers of an array at both ends of each capsule.
    Ends(Vec<[f32; 2]>),
}

/// Attributes of the corners of triangles, at least one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CornerAttributes {
    /// Unit vectors in render space; NaN for a missing normal.
    pub normals: Option<CornerValues<Vec3>>,
    /// Texture coordinates.
    pub uvs: Option<CornerValues<Vec2>>,
    /// The numbers of an array.
    pub scalars: Option<CornerValues<f32>>,
    /// Colors: linear light.
    pub colors: Option<CornerValues<Vec3>>,
    /// Opacities, from 0 to 1.
    pub opacities: Option<CornerValues<f32>>,
}

/// A kind of attributes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttributeKind {
    /// Attributes of corners, possibly none.
    Corners {
        /// True with normals.
        normals: bool,
        /// True with texture coordinates.
        uvs: bool,
        /// True with numbers of an array.
        scalars: bool,
        /// True with colors.
        colors: bool,
    },
    /// Colors of primitives.
    Colors,
    /// Numbers of primitives.
    Scalars,
    /// Numbers at the ends of capsules.
    Ends,
}

impl AttributeKind {
    /// The number of kinds.
    pub(super) const COUNT: u32 = 19;

    /// Returns the kind's number, less than [`COUNT`](Self::COUNT).
    pub(super) fn number(self) -> u32 {
        match self {
            Self::Corners {
                normals,
                uvs,
                scalars,
                colors,
            } => {
                let flags = [normals, uvs, scalars, colors].map(u32::from);
                flags
                    .into_iter()
                    .rev()
                    .fold(0, |number, flag| 2 * number + flag)
            }
            Self::Colors => 16,
            Self::Scalars => 17,
            Self::Ends => 18,
        }
    }

    /// Returns the kind with this number.
    pub(super) fn from_number(number: u32) -> Self {
        match number {
            16 => Self::Colors,
            17 => Self::Scalars,
            18 => Self::Ends,
            _ => Self::Corners {
                normals: number & 1 != 0,
                uvs: number & 2 != 0,
                scalars: number & 4 != 0,
                colors: number & 8 != 0,
            },
        }
    }

    /// Returns true if corners have normals.
    #[inline]
    pub fn has_normals(self) -> bool {
        matches!(self, Self::Corners { normals: true, .. })
    }

    /// Returns true if corners have texture coordinates.
    #[inline]
    pub fn has_uvs(self) -> bool {
        matches!(self, Self::Corners { uvs: true, .. })
    }

    /// Returns true if corners have numbers of an array.
    #[inline]
    pub fn has_corner_scalars(self) -> bool {
        matches!(self, Self::Corners { scalars: true, .. })
    }

    /// Returns true if corners have colors.
    #[inline]
    pub fn has_corner_colors(self) -> bool {
        matches!(self, Self::Corners { colors: true, .. })
    }
}

impl Attributes {
    pub(super) fn kind(&self) -> AttributeKind {
        let corners = match self {
            Self::None => &CornerAttributes::default(),
            Self::Corners(corners) => corners.as_ref(),
            Self::Colors(_) => return AttributeKind::Colors,
            Self::Scalars(_) => return AttributeKind::Scalars,
            Self::Ends(_) => return AttributeKind::Ends,
        };
        AttributeKind::Corners {
            normals: corners.normals.is_some(),
            uvs: corners.uvs.is_some(),
            scalars: corners.scalars.is_some(),
            colors: corners.colors.is_some(),
        }
    }
}

/// Returns the interpolated unit normal at one point of a triangle, or one per lane; `fallback` if
/// a vertex normal is missing.
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

/// Returns the interpolated number at one point of a triangle, or one per lane.
#[inline(always)]
pub fn interpolated_scalar<R: Real>(
    triangle: &[R; N_PARAMETERS],
    [a, b, c]: [R; 3],
    point: Vector<R>,
) -> R {
    let [u, v, w] = barycentrics(triangle, point);
    a * u + b * v + c * w
}

/// Returns the interpolated color at one point of a triangle, or one per lane.
#[inline(always)]
pub fn interpolated_color<R: Real>(
    triangle: &[R; N_PARAMETERS],
    [a, b, c]: [Vector<R>; 3],
    point: Vector<R>,
) -> Vector<R> {
    let [u, v, w] = barycentrics(triangle, point);
    a * u + b * v + c * w
}

/// Returns the interpolated number at one point of a capsule, or one per lane, from the numbers at
/// its ends.
#[inline(always)]
pub fn scalar_along<R: Real>(
    capsule: &[R; N_PARAMETERS],
    [from, to]: [R; 2],
    point: Vector<R>,
) -> R {
    let fraction = Capsule::fraction(capsule, point);
    from * (fraction.splat(1.0) - fraction) + to * fraction
}

/// Returns one point of a triangle, or one per lane, with interpolated texture coordinates.
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
