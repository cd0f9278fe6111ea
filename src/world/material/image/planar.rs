//! Pictures that are projected onto a plane.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use crate::geometry::RenderSpace;
use crate::values;
use math::simd::{Real, Vector};

/// A plane onto which points are projected orthogonally.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(with = "PlanarKeys")
)]
#[serde(try_from = "PlanarKeys")]
pub struct Planar {
    /// The lower left corner of the picture.
    origin: DVec3,
    /// To the right in the picture, a unit vector.
    right: Vec3,
    /// Upward in the picture, a unit vector.
    up: Vec3,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(
    deny_unknown_fields,
    default,
    expecting = "a plane such as { right: [1, 0, 0], up: [0, 1, 0] }"
)]
struct PlanarKeys {
    /// The lower left corner of the picture.
    #[serde(with = "values::Point")]
    origin: DVec3,
    /// To the right in the picture, a unit vector.
    #[serde(with = "values::Direction")]
    right: Vec3,
    /// Upward in the picture, a unit vector.
    #[serde(with = "values::Direction")]
    up: Vec3,
}

/// A floor, as seen with the axis z toward the viewer.
impl Default for PlanarKeys {
    fn default() -> Self {
        Self {
            origin: DVec3::ZERO,
            right: Vec3::X,
            up: Vec3::NEG_Z,
        }
    }
}

/// A floor, as seen with the axis z toward the viewer.
impl Default for Planar {
    fn default() -> Self {
        let PlanarKeys { origin, right, up } = PlanarKeys::default();
        Self { origin, right, up }
    }
}

impl TryFrom<PlanarKeys> for Planar {
    type Error = &'static str;

    fn try_from(PlanarKeys { origin, right, up }: PlanarKeys) -> Result<Self, Self::Error> {
        if right.cross(up).length_squared() < 1e-12 {
            return Err("cannot have `right` and `up` on one line, \
                 expected directions at an angle to each other");
        }
        Ok(Self { origin, right, up })
    }
}

impl Planar {
    /// Converts the plane from world space to render space.
    pub(super) fn in_space(&mut self, space: &RenderSpace) {
        self.origin = space.point(self.origin).as_dvec3();
    }

    /// Returns the rightward and upward directions in the picture.
    #[inline(always)]
    pub(super) fn axes<R: Real>(&self, like: R) -> [Vector<R>; 2] {
        [
            Vector::splat(like, self.right),
            Vector::splat(like, self.up),
        ]
    }

    /// Returns the side of a square of unit area on a surface, projected.
    #[inline(always)]
    pub(super) fn density<R: Real>(&self, normal: Vector<R>) -> R {
        let across = Vector::splat(normal.x, self.right.cross(self.up));
        normal.dot(across).abs().sqrt()
    }

    /// Returns the coordinates of a point in the plane, in world units.
    #[inline(always)]
    pub(super) fn uv<R: Real>(&self, position: Vector<R>) -> [R; 2] {
        let like = position.x;
        let from_origin = position - Vector::splat(like, self.origin.as_vec3());
        [
            from_origin.dot(Vector::splat(like, self.right)),
            from_origin.dot(Vector::splat(like, self.up)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_floor_is_seen_from_above() {
        let floor = Planar::default();
        assert_eq!(floor.uv(Vec3::new(3.0, 7.0, -2.0).into()), [3.0, 2.0]);
        let wall: Planar =
            scene::yaml::from_str("{ origin: [1, 2, 3], right: [0, 0, -2], up: [0, 5, 0] }")
                .unwrap();
        assert_eq!(wall.uv(Vec3::new(9.0, 2.5, 1.0).into()), [2.0, 0.5]);
    }
}
