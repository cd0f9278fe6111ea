//! Projections along the axes of world space.

use glam::Vec3;
use serde::{Serialize, Serializer};

use crate::geometry::RenderSpace;
use crate::material::texture_point::TexturePoint;
use crate::picture::Wrap;
use math::simd::{Real, Vector};

/// A point's projection along an axis.
pub(super) struct AxisProjection<R> {
    /// The coordinates, in world units.
    pub(super) uv: [R; 2],
    /// The fourth power of the normal's coordinate along the axis, divided by the sum of
    /// all three.
    pub(super) weight: R,
    /// The rightward and upward directions in the picture.
    pub(super) axes: [Vector<R>; 2],
    /// The width of the ray's footprint, projected.
    pub(super) footprint: R,
}

/// The projections along the axes of world space, with the origins of the pictures' coordinates.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Triplanar {
    origins: [Vec3; 2],
}

/// Writes a word: it has no keys.
impl Serialize for Triplanar {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        s.serialize_str("triplanar")
    }
}

impl Triplanar {
    /// Converts the projections from world space to render space, for a picture of this size.
    pub(super) fn in_space(&mut self, space: &RenderSpace, size: [f32; 2], wrap: Wrap) {
        self.origins = size.map(|length| {
            // A mirrored picture repeats after two.
            let period = 2.0 * f64::from(length);
            space.world_origin((wrap != Wrap::Clamp).then_some(period))
        });
    }

    /// Returns the projections along x, y and z. From either side a picture appears upright and not
    /// mirrored; along y, up in the picture is -z.
    #[inline(always)]
    pub(super) fn projections<R: Real>(&self, point: &TexturePoint<R>) -> [AxisProjection<R>; 3] {
        let like = point.position.x;
        let [first, second] = self.origins;
        let Vector { x, z, .. } = point.position - Vector::splat(like, first);
        let Vector { y, z: z_up, .. } = point.position - Vector::splat(like, second);
        let normal = point.normal;
        let [right, upward, front] = Vec3::AXES;
        let right = Vector::splat(x, right);
        let upward = Vector::splat(x, upward);
        let back = -Vector::splat(x, front);
        let squares = normal.times(normal);
        let weights = squares.times(squares);
        let sum = weights.x + weights.y + weights.z;
        [
            AxisProjection {
                uv: [(-z).flip_sign_by(normal.x), y],
                weight: weights.x / sum,
                axes: [back.flip_sign_by(normal.x), upward],
                footprint: point.width * normal.x.abs().sqrt(),
            },
            AxisProjection {
                uv: [x, (-z_up).flip_sign_by(normal.y)],
                weight: weights.y / sum,
                axes: [right, back.flip_sign_by(normal.y)],
                footprint: point.width * normal.y.abs().sqrt(),
            },
            AxisProjection {
                uv: [x.flip_sign_by(normal.z), y],
                weight: weights.z / sum,
                axes: [right.flip_sign_by(normal.z), upward],
                footprint: point.width * normal.z.abs().sqrt(),
            },
        ]
    }
}
