//! The placement of one instance of a mesh.

use glam::{DAffine3, DMat3, DVec3, Mat3, Vec3};

use super::aabb::Aabb;
use super::ray::Ray;
use super::surface::N_PARAMETERS;

/// Margin of an instance's box, relative to its largest coordinate: 84 units in the last place.
const MARGIN: f64 = 5e-6;
/// Maximum factor of a length, and the inverse of the minimum one.
const MAX_SCALE: f64 = 1e9;

/// A map between the space of a mesh, whose origin is the mesh's center, and world space: 84 bytes.
///
/// The translation comes last, so that a ray is moved by the difference of two points in world
/// space: far from the world's origin, no more digits are lost than the coordinates themselves
/// lack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InstanceTransform {
    world_from_mesh: Mat3,
    mesh_from_world: Mat3,
    /// The origin of the mesh's space in world space.
    position: Vec3,
}

impl InstanceTransform {
    /// Creates the transform of a mesh whose center is the origin; `None` if it has no inverse, or
    /// if one of its scales is not between 1e-9 and 1e9.
    pub fn new(place: &DAffine3) -> Option<Self> {
        let linear = place.matrix3.as_mat3();
        let inverse = linear.as_dmat3().inverse();
        let is_usable = |matrix: &DMat3| {
            let axes = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
            let mut lengths = axes.iter().map(|axis: &DVec3| axis.length());
            lengths.all(|length| (1.0 / MAX_SCALE..=MAX_SCALE).contains(&length))
        };
        let position = place.translation.as_vec3();
        let usable = is_usable(&linear.as_dmat3()) && is_usable(&inverse) && position.is_finite();
        usable.then(|| Self {
            world_from_mesh: linear,
            mesh_from_world: inverse.as_mat3(),
            position,
        })
    }

    /// Transforms a ray to the space of the mesh, with the same parameter `t`.
    #[inline]
    pub fn mesh_ray(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.mesh_from_world * (ray.origin - self.position),
            direction: self.mesh_from_world * ray.direction,
        }
    }

    /// Returns the columns and the translation of the map from the mesh to world space.
    pub fn world_from_mesh(&self) -> [Vec3; 4] {
        let Mat3 {
            x_axis,
            y_axis,
            z_axis,
        } = self.world_from_mesh;
        [x_axis, y_axis, z_axis, self.position]
    }

    /// Returns the columns of the map from world space to the mesh, and the position that it
    /// subtracts before.
    pub fn mesh_from_world(&self) -> [Vec3; 4] {
        let Mat3 {
            x_axis,
            y_axis,
            z_axis,
        } = self.mesh_from_world;
        [x_axis, y_axis, z_axis, self.position]
    }

    /// Transforms a point of the mesh to world space.
    #[inline]
    pub fn world_point(&self, point: Vec3) -> Vec3 {
        self.world_from_mesh * point + self.position
    }

    /// Transforms the parameters of a triangle of the mesh to world space.
    #[inline]
    pub fn world_triangle(&self, triangle: &[f32; N_PARAMETERS]) -> [f32; N_PARAMETERS] {
        let mut placed = *triangle;
        for vertex in placed.as_chunks_mut::<3>().0 {
            *vertex = self.world_point(Vec3::from(*vertex)).to_array();
        }
        placed
    }

    /// Transforms a triangle as [`world_triangle`](Self::world_triangle) does, with its corners
    /// counter-clockwise around the outward normal.
    pub fn outward_triangle(&self, triangle: &[f32; N_PARAMETERS]) -> [f32; N_PARAMETERS] {
        let [a, b, c, d, e, f, g, h, i] = self.world_triangle(triangle);
        if self.is_mirrored() {
            [a, b, c, g, h, i, d, e, f]
        } else {
            [a, b, c, d, e, f, g, h, i]
        }
    }

    /// Transforms a normal of the mesh to a unit vector in world space.
    #[inline]
    pub fn world_normal(&self, normal: Vec3) -> Vec3 {
        // Normals transform by the inverse transpose (pbrt, 4th ed., 3.10.3).
        (self.mesh_from_world.transpose() * normal).normalize()
    }

    /// Returns true if it mirrors, which reverses the orientation of triangles.
    #[inline]
    pub fn is_mirrored(&self) -> bool {
        self.world_from_mesh.determinant() < 0.0
    }

    /// Returns a box in world space around the images of all points of a box, with a margin for the
    /// rounding errors of tests in the space of the mesh.
    pub fn world_bounds(&self, bounds: &Aabb) -> Aabb {
        let linear = self.world_from_mesh.as_dmat3();
        let place = |corner: Vec3| linear * corner.as_dvec3() + self.position.as_dvec3();
        let corners = bounds.corners().map(place);
        let min = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let max = corners
            .iter()
            .copied()
            .fold(DVec3::NEG_INFINITY, DVec3::max);
        let largest = min.abs().max(max.abs()).max_element();
        let margin = DVec3::splat(MARGIN * self.error_factor() * largest);
        Aabb {
            min: (min - margin).as_vec3(),
            max: (max + margin).as_vec3(),
        }
    }

    /// Returns an upper bound of the factor by which the transforms to the mesh's space and back
    /// amplify rounding errors: 1 for translations and scales, at most 3 after a rotation.
    fn error_factor(&self) -> f64 {
        let abs = |matrix: Mat3| {
            let axes = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
            let [x, y, z] = axes.map(|axis| axis.as_dvec3().abs());
            DMat3::from_cols(x, y, z)
        };
        let error = abs(self.world_from_mesh) * abs(self.mesh_from_world) * DVec3::ONE;
        error.max_element()
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

    /// A rotation, a mirroring scale that differs by axis, and a translation.
    fn skewed() -> InstanceTransform {
        let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7);
        let (scale, to) = (DVec3::new(2.0, -0.5, 1.25), DVec3::new(3.0, -8.0, 5.0));
        let place = DAffine3::from_scale_rotation_translation(scale, turn, to);
        InstanceTransform::new(&place).unwrap()
    }

    #[test]
    fn rays_keep_their_parameter() {
        let place = skewed();
        let ray = Ray {
            origin: Vec3::new(4.0, 1.0, -2.0),
            direction: Vec3::new(2.0, 3.0, 6.0) / 7.0,
        };
        let moved = place.mesh_ray(&ray);
        for t in [0.0, 1.0, 10.0] {
            assert!(place.world_point(moved.at(t)).distance(ray.at(t)) < 1e-5);
        }
    }

    #[test]
    fn normals_stay_normal_to_the_surface_and_point_outward() {
        let place = skewed();
        assert!(place.is_mirrored());
        let (along, other) = (Vec3::new(1.0, -2.0, 0.5), Vec3::new(0.3, 0.4, 1.0));
        let normal = along.cross(other).normalize();
        let [origin, a, b, out] =
            [Vec3::ZERO, along, other, normal].map(|point| place.world_point(point));
        let placed = place.world_normal(normal);
        assert!(placed.dot(a - origin).abs() < 1e-6 && placed.dot(b - origin).abs() < 1e-6);
        assert!(placed.dot(out - origin) > 0.0);
    }

    #[test]
    fn boxes_enclose_what_they_have_to() {
        let place = skewed();
        let bounds = Aabb {
            min: Vec3::new(-1.0, -2.0, 0.0),
            max: Vec3::new(1.0, 0.5, 0.0),
        };
        let placed = place.world_bounds(&bounds);
        assert!(placed.min.cmplt(placed.max).all());
        for corner in bounds.corners().map(|corner| place.world_point(corner)) {
            assert!(placed.min.cmplt(corner).all() && placed.max.cmpgt(corner).all());
        }
    }

    #[test]
    fn what_has_no_inverse_is_refused() {
        for scale in [
            DVec3::new(1.0, 0.0, 1.0),
            DVec3::splat(1e-10),
            DVec3::splat(1e10),
        ] {
            assert_eq!(InstanceTransform::new(&DAffine3::from_scale(scale)), None);
        }
    }
}
