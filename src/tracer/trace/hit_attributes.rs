//! Attributes of the primitives that rays have hit → the points that shading reads.

use math::simd::{Real, Vector};
use world::camera::RayCone;
use world::geometry::N_PARAMETERS;
use world::material::{Material, TexturePoint};
use world::scene::{interpolated_color, interpolated_normal, with_uv};

use super::surface_point::{ShadingPoint, on_side_of, side, width};

/// A hit projected onto its surface, or one per lane.
pub(crate) struct HitPlace<R> {
    pub(crate) position: Vector<R>,
    /// The surface's own unit normal.
    pub(crate) outward: Vector<R>,
    /// A bound of the distance of the position from the surface.
    pub(crate) error: R,
    /// The direction of the ray.
    pub(crate) direction: Vector<R>,
}

/// The attributes of a primitive that was hit, or of one per lane; `None` for those that it does not
/// have.
pub(crate) struct HitAttributes<R> {
    /// The parameters of the shape, in render space unless it has a transform.
    pub(crate) parameters: [R; N_PARAMETERS],
    /// The normals at the vertices of a triangle.
    pub(crate) normals: Option<[Vector<R>; 3]>,
    /// The texture coordinates at the vertices.
    pub(crate) uvs: Option<[[R; 2]; 3]>,
    /// The colors at the vertices.
    pub(crate) colors: Option<[Vector<R>; 3]>,
    /// The number of an array at the point.
    pub(crate) scalar: Option<R>,
    /// The color of the primitive, in place of its material's.
    pub(crate) color: Option<Vector<R>>,
}

/// Returns the point that shading reads. Textures are filtered by the cone of the ray, at the length
/// of its path to the point; `None` for a ray without width.
#[inline(always)]
pub(crate) fn shading_point<R: Real>(
    material: &Material,
    place: &HitPlace<R>,
    attributes: &HitAttributes<R>,
    cone: Option<(RayCone, R)>,
) -> ShadingPoint<R> {
    let HitPlace {
        position,
        outward,
        error,
        direction,
    } = *place;
    let parameters = &attributes.parameters;
    // Turn the normals to the side of the ray.
    let side = side(outward, direction);
    let geometric_normal = outward.flip_sign_by(side);
    // Interpolate the shading normal.
    let normal = match attributes.normals {
        None => geometric_normal,
        Some(normals) => {
            let normal = interpolated_normal(parameters, normals, position, geometric_normal);
            on_side_of(geometric_normal, normal)
        }
    };
    // Find the attributes and the filter width that textures read.
    let mut at = TexturePoint::new(position, normal);
    if let Some(uvs) = attributes.uvs {
        at = with_uv(at, parameters, uvs);
    }
    if let Some(colors) = attributes.colors {
        at.color = interpolated_color(parameters, colors, position);
    }
    if let Some(scalar) = attributes.scalar {
        at.scalar = scalar;
    }
    if let Some((cone, distance)) = cone {
        at.width = width(cone, distance, geometric_normal, direction);
    }
    // Evaluate the textures. A closure may not be inlined into the function with the instructions.
    let color = match attributes.color {
        Some(color) => color,
        None => material.color.color_at(&at),
    };
    ShadingPoint {
        position,
        normal: material.normal_at(&at, geometric_normal),
        geometric_normal,
        color,
        error,
        side,
        factors: material.factors.at(&at),
    }
}
