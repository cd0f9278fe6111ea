//! Affine transforms, and the steps that a scene file makes them of.

use glam::{Affine3A, Mat3A, Quat, Vec3};
use serde::Deserialize;

use super::aabb::Aabb;
use super::ray::Ray;
use crate::yaml;

/// One step of an object's `transform`; the list is applied from its first
/// step to its last.
///
/// ```
/// # use raycost::geometry::TransformStep;
/// let steps: Vec<TransformStep> = raycost::yaml::from_str("
/// - scale: [1, 2, 1]                           # or one number for all axes
/// - rotate: { axis: [0, 1, 0], angle_deg: 30 } # right-handed, about the origin
/// - translate: [0, 0.5, 3]
/// ").unwrap();
/// # assert_eq!(steps.len(), 3);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", expecting = "a step such as { scale: 2 }")]
pub enum TransformStep {
    /// Moves by a vector.
    Translate(#[serde(deserialize_with = "yaml::vector")] Vec3),
    /// Turns about an axis through the origin.
    Rotate(Rotation),
    /// Multiplies each coordinate; negative factors mirror.
    Scale(#[serde(deserialize_with = "yaml::scale")] Vec3),
}

/// A right-handed turn about an axis through the origin.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a turn such as { axis: [0, 1, 0], angle_deg: 30 }"
)]
pub struct Rotation {
    /// The axis, a unit vector.
    #[serde(deserialize_with = "yaml::direction")]
    axis: Vec3,
    /// The angle in degrees.
    #[serde(deserialize_with = "yaml::coordinate")]
    angle_deg: f32,
}

/// A placement of an object in the world, with its inverse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    world_from_object: Affine3A,
    object_from_world: Affine3A,
}

impl Transform {
    /// The steps applied in their order; `None` when they leave no volume, so
    /// that nothing could be seen or inverted.
    pub fn of_steps(steps: &[TransformStep]) -> Option<Self> {
        let world_from_object = steps.iter().fold(Affine3A::IDENTITY, |before, step| {
            let this = match *step {
                TransformStep::Translate(by) => Affine3A::from_translation(by),
                TransformStep::Rotate(turn) => Affine3A::from_quat(Quat::from_axis_angle(
                    turn.axis,
                    turn.angle_deg.to_radians(),
                )),
                TransformStep::Scale(factors) => Affine3A::from_scale(factors),
            };
            this * before
        });
        let determinant = world_from_object.matrix3.determinant();
        let object_from_world = world_from_object.inverse();
        let usable = determinant.abs() > f32::MIN_POSITIVE
            && world_from_object.is_finite()
            && object_from_world.is_finite();
        usable.then_some(Self {
            world_from_object,
            object_from_world,
        })
    }

    /// An object-space point in the world.
    pub fn world_point(&self, point: Vec3) -> Vec3 {
        self.world_from_object.transform_point3(point)
    }

    /// A world-space point in object space.
    pub fn object_point(&self, point: Vec3) -> Vec3 {
        self.object_from_world.transform_point3(point)
    }

    /// An object-space surface normal in the world, of unit length.
    pub fn world_normal(&self, normal: Vec3) -> Vec3 {
        // Normals go by the inverse transpose (pbrt, 4th ed., 3.10.3).
        let inverse_transpose: Mat3A = self.object_from_world.matrix3.transpose();
        (inverse_transpose * normal).normalize()
    }

    /// A world-space ray in object space, with the same `t` along it.
    pub fn object_ray(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.object_point(ray.origin),
            direction: self.object_from_world.transform_vector3(ray.direction),
        }
    }

    /// The smallest world-space box around an object-space one.
    pub fn world_bounds(&self, bounds: &Aabb) -> Aabb {
        Aabb::of_points(bounds.corners().map(|corner| self.world_point(corner)))
    }

    /// The one factor by which all lengths grow, if there is one: the
    /// transform is then a similarity and keeps spheres and circles round.
    pub fn uniform_scale(&self) -> Option<f32> {
        let [x, y, z] = self.axes();
        let (a, b, c) = (x.length(), y.length(), z.length());
        let skew = x.dot(y).abs().max(y.dot(z).abs()).max(z.dot(x).abs());
        let round = (a - b).abs().max((b - c).abs()) <= 1e-6 * a && skew <= 1e-6 * a * a;
        round.then_some(a)
    }

    /// Whether axis-aligned boxes stay axis-aligned boxes, axis by axis.
    pub fn keeps_axes(&self) -> bool {
        let [x, y, z] = self.axes();
        let off_diagonal = [x.y, x.z, y.x, y.z, z.x, z.y];
        off_diagonal.iter().all(|&entry| entry == 0.0)
    }

    /// Where the unit vectors go.
    fn axes(&self) -> [Vec3; 3] {
        Vec3::AXES.map(|axis| self.world_from_object.transform_vector3(axis))
    }
}
