//! Pictures that are projected onto a sphere.

use std::f32::consts::{PI, SQRT_2};

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use crate::geometry::RenderSpace;
use crate::values;
use math::simd::{Real, Vector, turns_of};

/// A sphere of directions from a center. The picture is a map of the whole
/// sphere as seen from outside, with equal steps of longitude and latitude.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(with = "SphericalKeys")
)]
#[serde(try_from = "SphericalKeys")]
pub struct Spherical {
    center: DVec3,
    /// The direction of the middle of the picture; in render space `front`, `right` and `up` are
    /// orthonormal.
    front: Vec3,
    /// The direction a quarter turn to the right in the picture.
    #[serde(skip_serializing)]
    right: Vec3,
    /// The direction of the upper edge.
    up: Vec3,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(
    deny_unknown_fields,
    default,
    expecting = "a sphere such as { center: [0, 1, 0] }"
)]
struct SphericalKeys {
    /// The center in world space.
    #[serde(with = "values::Point")]
    center: DVec3,
    /// The direction to the top of the picture.
    #[serde(with = "values::Direction")]
    up: Vec3,
    /// The direction to the middle of the picture; its part along `up` is ignored.
    #[serde(with = "values::Direction")]
    front: Vec3,
}

impl Default for SphericalKeys {
    fn default() -> Self {
        Self {
            center: DVec3::ZERO,
            up: Vec3::Y,
            front: Vec3::Z,
        }
    }
}

/// Around the origin, with y upward and z in the middle.
impl Default for Spherical {
    fn default() -> Self {
        Self {
            center: DVec3::ZERO,
            front: Vec3::Z,
            right: Vec3::X,
            up: Vec3::Y,
        }
    }
}

impl TryFrom<SphericalKeys> for Spherical {
    type Error = &'static str;

    fn try_from(keys: SphericalKeys) -> Result<Self, Self::Error> {
        let SphericalKeys { center, up, front } = keys;
        let right = up.cross(front);
        if right.length_squared() < 1e-12 {
            return Err("cannot have `front` and `up` on one line, \
                 expected directions at an angle to each other");
        }
        let right = right.normalize();
        Ok(Self {
            center,
            front,
            right,
            up,
        })
    }
}

impl Spherical {
    /// Converts the sphere from world space to render space.
    pub(super) fn in_space(&mut self, space: &RenderSpace) {
        self.center = space.point(self.center).as_dvec3();
        self.front = self.right.cross(self.up);
    }

    /// Returns the rightward and upward directions in the picture at a point, of any length: east
    /// and north.
    #[inline(always)]
    pub(super) fn axes<R: Real>(&self, position: Vector<R>) -> [Vector<R>; 2] {
        let like = position.x;
        let up = Vector::splat(like, self.up);
        [
            up.cross(position - Vector::splat(like, self.center.as_vec3())),
            up,
        ]
    }

    /// Returns the side of a square of unit area at the sphere's equator, in fractions of the
    /// picture. Also used at the poles, where the true width of the columns would blur the picture.
    #[inline(always)]
    pub(super) fn density<R: Real>(&self, position: Vector<R>) -> R {
        let like = position.x;
        let radius = (position - Vector::splat(like, self.center.as_vec3())).length();
        like.splat(1.0 / (PI * SQRT_2)) / radius
    }

    /// Returns the coordinates of a point: longitude and latitude as fractions of the picture's
    /// width and height, from 0 to 1.
    #[inline(always)]
    pub(super) fn uv<R: Real>(&self, position: Vector<R>) -> [R; 2] {
        let like = position.x;
        let from_center = position - Vector::splat(like, self.center.as_vec3());
        let front = from_center.dot(Vector::splat(like, self.front));
        let right = from_center.dot(Vector::splat(like, self.right));
        let up = from_center.dot(Vector::splat(like, self.up));
        let around = (front * front + right * right).sqrt();
        let half = like.splat(0.5);
        [
            half + turns_of([front, right]),
            half + like.splat(2.0) * turns_of([around, up]),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_is_seen_from_outside() {
        let keys = "{ center: [1, 2, 3], up: [0, 0, 1], front: [0, -1, 0.5] }";
        let mut sphere: Spherical = scene::yaml::from_str(keys).unwrap();
        sphere.in_space(&RenderSpace::default());
        for (direction, expected) in [
            ([0.0, -2.0, 0.0], [0.5, 0.5]),
            ([2.0, 0.0, 0.0], [0.75, 0.5]),
            ([-2.0, 0.0, 0.0], [0.25, 0.5]),
            ([0.0, -1.0, 1.0], [0.5, 0.75]),
            ([0.0, 0.0, -3.0], [0.5, 0.0]),
        ] {
            let position = Vec3::new(1.0, 2.0, 3.0) + Vec3::from(direction);
            let found = sphere.uv(position.into());
            let distance = (found[0] - expected[0]).abs() + (found[1] - expected[1]).abs();
            assert!(distance < 1e-6, "{direction:?}: {found:?}");
        }
    }
}
