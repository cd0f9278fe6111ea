//! Affine transforms, and the steps that define them in a scene file.

use glam::{Affine3A, DAffine3, DQuat, DVec3, Mat3, Mat3A, Vec3};
use serde::{Deserialize, Serialize};

use super::aabb::Aabb;
use super::ray::Ray;
use crate::values;

/// One step of an object's `transform`. The steps are applied in the order of
/// the list.
///
/// ```
/// # use raycost_world::geometry::TransformStep;
/// let steps: Vec<TransformStep> = scene::yaml::from_str("
/// - scale: [1, 2, 1]                           # or one number for all axes
/// - rotate: { axis: [0, 1, 0], angle_deg: 30 } # right-handed, about the origin
/// - translate: [0, 0.5, 3]
/// ").unwrap();
/// # assert_eq!(steps.len(), 3);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(rename_all = "snake_case", expecting = "a step such as { scale: 2 }")]
pub enum TransformStep {
    /// Translates by a vector.
    Translate(#[serde(with = "values::Displacement")] DVec3),
    /// Rotates about an axis through the origin.
    Rotate(Rotation),
    /// Scales each coordinate; negative factors mirror.
    Scale(#[serde(with = "values::Scale")] Vec3),
}

/// A right-handed rotation about an axis through the origin.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(
    deny_unknown_fields,
    expecting = "a turn such as { axis: [0, 1, 0], angle_deg: 30 }"
)]
pub struct Rotation {
    /// The axis, a unit vector.
    #[serde(with = "values::Direction")]
    axis: Vec3,
    /// The angle in degrees.
    #[serde(with = "values::Coordinate")]
    angle_deg: f32,
}

/// A placement of an object in the world, with its inverse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    world_from_object: Affine3A,
    object_from_world: Affine3A,
}

/// Returns the map from object space to world space that applies these steps in order.
pub fn world_from_object(steps: &[TransformStep]) -> DAffine3 {
    steps.iter().fold(DAffine3::IDENTITY, |before, step| {
        let this = match *step {
            TransformStep::Translate(by) => DAffine3::from_translation(by),
            TransformStep::Rotate(Rotation { axis, angle_deg }) => {
                let axis = axis.as_dvec3().normalize();
                DAffine3::from_quat(DQuat::from_axis_angle(
                    axis,
                    f64::from(angle_deg).to_radians(),
                ))
            }
            TransformStep::Scale(factors) => DAffine3::from_scale(factors.as_dvec3()),
        };
        this * before
    })
}

impl Transform {
    /// Creates a map from object space to the space in which rays are traced; `None` if it has no
    /// finite 32-bit inverse, or flattens volumes.
    pub fn new(map: &DAffine3) -> Option<Self> {
        let [world_from_object, object_from_world] = [*map, map.inverse()].map(rounded);
        let usable = map.matrix3.determinant().is_normal()
            && world_from_object.is_finite()
            && object_from_world.is_finite();
        usable.then_some(Self {
            world_from_object,
            object_from_world,
        })
    }

    /// Transforms a vector from object space to world space.
    pub fn world_vector(&self, vector: Vec3) -> Vec3 {
        self.world_from_object.transform_vector3(vector)
    }

    /// Transforms a point from object space to world space.
    pub fn world_point(&self, point: Vec3) -> Vec3 {
        self.world_from_object.transform_point3(point)
    }

    /// Transforms a point from world space to object space.
    pub fn object_point(&self, point: Vec3) -> Vec3 {
        self.object_from_world.transform_point3(point)
    }

    /// Returns the columns and the translation of the map from object space to world space.
    pub fn world_from_object(&self) -> [Vec3; 4] {
        columns(&self.world_from_object)
    }

    /// Returns the columns and the translation of the map from world space to object space.
    pub fn object_from_world(&self) -> [Vec3; 4] {
        columns(&self.object_from_world)
    }

    /// Transforms a surface normal from object space to a unit vector in world space.
    pub fn world_normal(&self, normal: Vec3) -> Vec3 {
        // Normals transform by the inverse transpose (pbrt, 4th ed., 3.10.3).
        let inverse_transpose: Mat3A = self.object_from_world.matrix3.transpose();
        (inverse_transpose * normal).normalize()
    }

    /// Transforms a ray from world space to object space, with the same parameter `t`.
    pub fn object_ray(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.object_point(ray.origin),
            direction: self.object_from_world.transform_vector3(ray.direction),
        }
    }

    /// Returns the smallest box in world space around a box of object space.
    pub fn world_bounds(&self, bounds: &Aabb) -> Aabb {
        Aabb::from_points(bounds.corners().map(|corner| self.world_point(corner)))
    }

    /// Returns true if it mirrors, which reverses the orientation of triangles.
    pub fn is_mirrored(&self) -> bool {
        // Small scales exceed the range of 32 bits.
        Mat3::from(self.world_from_object.matrix3)
            .as_dmat3()
            .determinant()
            < 0.0
    }

    /// Returns the factor by which it scales all lengths; `None` if the factor varies. With one,
    /// the transform is a similarity, which maps spheres to spheres.
    pub fn uniform_scale(&self) -> Option<f32> {
        let [x, y, z] = self.axes();
        let (a, b, c) = (x.length(), y.length(), z.length());
        let skew = x.dot(y).abs().max(y.dot(z).abs()).max(z.dot(x).abs());
        let round = (a - b).abs().max((b - c).abs()) <= 1e-6 * a && skew <= 1e-6 * a * a;
        round.then_some(a)
    }

    /// Returns true if it maps each axis to itself, and therefore axis-aligned boxes to
    /// axis-aligned boxes.
    pub fn keeps_axes(&self) -> bool {
        let [x, y, z] = self.axes();
        let off_diagonal = [x.y, x.z, y.x, y.z, z.x, z.y];
        off_diagonal.iter().all(|&entry| entry == 0.0)
    }

    /// Returns the images of the unit vectors.
    fn axes(&self) -> [Vec3; 3] {
        Vec3::AXES.map(|axis| self.world_vector(axis))
    }
}

/// Returns the columns and the translation of a map.
fn columns(map: &Affine3A) -> [Vec3; 4] {
    let matrix = map.matrix3;
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(Vec3::from);
    [x, y, z, map.translation.into()]
}

/// Rounds a map to 32 bits.
fn rounded(map: DAffine3) -> Affine3A {
    let [x, y, z] = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
    let [x, y, z, to] = [x, y, z, map.translation].map(|column| column.as_vec3());
    Affine3A::from_cols(x.into(), y.into(), z.into(), to.into())
}
