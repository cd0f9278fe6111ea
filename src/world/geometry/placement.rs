//! Placements of shapes and of instances, in numbers of any kind.

use math::simd::{Real, Vector};

use super::surface::{N_PARAMETERS, vector};

/// The maps of a [`Transform`](super::Transform), or of one per lane, with its results to the last
/// bit.
#[derive(Debug, Clone, Copy)]
pub struct ShapePlacement<R> {
    /// The columns and the translation of the map from object space to world space.
    world_from_object: [Vector<R>; 4],
    /// The same of its inverse.
    object_from_world: [Vector<R>; 4],
}

impl<R: Real> ShapePlacement<R> {
    /// Creates a placement from the columns and the translation of both maps.
    #[inline(always)]
    pub fn new(world_from_object: [Vector<R>; 4], object_from_world: [Vector<R>; 4]) -> Self {
        Self {
            world_from_object,
            object_from_world,
        }
    }

    /// Transforms a point from object space to world space.
    #[inline(always)]
    pub fn world_point(&self, point: Vector<R>) -> Vector<R> {
        moved(&self.world_from_object, point)
    }

    /// Transforms a point from world space to object space.
    #[inline(always)]
    pub fn object_point(&self, point: Vector<R>) -> Vector<R> {
        moved(&self.object_from_world, point)
    }

    /// Transforms a surface normal from object space to a unit vector in world space.
    #[inline(always)]
    pub fn world_normal(&self, normal: Vector<R>) -> Vector<R> {
        let [x, y, z, _] = self.object_from_world;
        turned(&[x, y, z], normal)
    }
}

/// The placement of an instance as [`InstanceTransform`](super::InstanceTransform) has it, or of one
/// per lane, with its results to the last bit.
#[derive(Debug, Clone, Copy)]
pub struct InstancePlacement<R> {
    /// The columns and the translation of the map from the mesh to world space.
    world_from_mesh: [Vector<R>; 4],
    /// The columns of its inverse.
    mesh_from_world: [Vector<R>; 3],
}

impl<R: Real> InstancePlacement<R> {
    /// Creates a placement from the columns and the translation of the map to world space, and the
    /// columns of its inverse.
    #[inline(always)]
    pub fn new(world_from_mesh: [Vector<R>; 4], mesh_from_world: [Vector<R>; 3]) -> Self {
        Self {
            world_from_mesh,
            mesh_from_world,
        }
    }

    /// Transforms the parameters of a triangle of the mesh to world space.
    #[inline(always)]
    pub fn world_triangle(&self, triangle: &[R; N_PARAMETERS]) -> [R; N_PARAMETERS] {
        let corner = |first| moved(&self.world_from_mesh, vector(triangle, first));
        let [a, b, c] = [corner(0), corner(3), corner(6)];
        [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z]
    }

    /// Transforms a normal of the mesh to a unit vector in world space.
    #[inline(always)]
    pub fn world_normal(&self, normal: Vector<R>) -> Vector<R> {
        turned(&self.mesh_from_world, normal)
    }
}

#[inline(always)]
fn moved<R: Real>([x, y, z, to]: &[Vector<R>; 4], point: Vector<R>) -> Vector<R> {
    *x * point.x + *y * point.y + *z * point.z + *to
}

/// Transforms a normal to a unit vector, given the columns of the inverse map.
#[inline(always)]
fn turned<R: Real>([x, y, z]: &[Vector<R>; 3], normal: Vector<R>) -> Vector<R> {
    let turned = Vector {
        x: x.dot(normal),
        y: y.dot(normal),
        z: z.dot(normal),
    };
    turned.normalize()
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DMat3, DVec3, Vec3};
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::{InstanceTransform, Transform};

    impl From<&Transform> for ShapePlacement<f32> {
        fn from(transform: &Transform) -> Self {
            let [there, back] = [transform.world_from_object(), transform.object_from_world()];
            Self::new(there.map(Vector::from), back.map(Vector::from))
        }
    }

    impl From<&InstanceTransform> for InstancePlacement<f32> {
        fn from(transform: &InstanceTransform) -> Self {
            let [x, y, z, _] = transform.mesh_from_world();
            let there = transform.world_from_mesh().map(Vector::from);
            Self::new(there, [x, y, z].map(Vector::from))
        }
    }

    proptest! {
        #[test]
        fn placements_agree_with_transforms_to_the_last_bit(
            matrix in prop::array::uniform9(-2.0_f64..2.0),
            translation in prop::array::uniform3(-100.0_f64..100.0),
            point in prop::array::uniform3(-10.0_f32..10.0),
        ) {
            let matrix = DMat3::from_cols_array(&matrix);
            let map = DAffine3::from_mat3_translation(matrix, DVec3::from(translation));
            let Some(transform) = Transform::new(&map) else { return Ok(()) };
            let placement = ShapePlacement::from(&transform);
            let point = Vec3::from(point);
            let found = [
                placement.world_point(point.into()),
                placement.object_point(point.into()),
                placement.world_normal(point.into()),
            ];
            let expected = [
                transform.world_point(point),
                transform.object_point(point),
                transform.world_normal(point),
            ];
            let bits = |v: Vec3| v.to_array().map(f32::to_bits);
            for (found, expected) in found.into_iter().zip(expected) {
                prop_assert_eq!(bits(found.into()), bits(expected));
            }
            let Some(transform) = InstanceTransform::new(&map) else { return Ok(()) };
            let placement = InstancePlacement::from(&transform);
            let found = Vec3::from(placement.world_normal(point.into()));
            prop_assert_eq!(bits(found), bits(transform.world_normal(point)));
            let Vec3 { x, y, z } = point;
            let triangle = [x, y, z, y, z, x, -z, x, y];
            let found = placement.world_triangle(&triangle).map(f32::to_bits);
            prop_assert_eq!(found, transform.world_triangle(&triangle).map(f32::to_bits));
        }
    }
}
