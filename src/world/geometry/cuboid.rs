//! Axis-aligned boxes as shapes.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::located::{Described, Located, located};
use super::sampled::{Sampled, Seen, SurfaceSample};
use super::surface::{parameters_of, rounding_of_plane, vector};
use super::{Aabb, Intersectable, N_PARAMETERS, Patch, Project, Ray, RayTest, Transform};
use crate::values;
use math::simd::{Real, Vector};

/// The surface of an axis-aligned box. A `transform` makes a rotated one.
///
/// ```
/// # use raycost_world::geometry::{Located, Cuboid};
/// let cuboid: Located<Cuboid> = scene::yaml::from_str("{ min: [-1, 0, 2], max: [1, 2, 3] }").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cuboid {
    bounds: Aabb,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CuboidKeys {
    /// The corner with the least coordinates.
    #[serde(with = "values::Point")]
    min: DVec3,
    /// The corner with the greatest coordinates.
    #[serde(with = "values::Point")]
    max: DVec3,
}

impl Described for Cuboid {
    type Keys = CuboidKeys;

    fn from_keys(CuboidKeys { min, max }: CuboidKeys) -> Result<Located<Self>, &'static str> {
        let corners = located([min, max]);
        let [least, greatest] = corners.geometry;
        if least.cmplt(greatest).all() {
            Ok(corners.map(|[min, max]| Self::new(Aabb { min, max })))
        } else {
            Err("cannot be without volume, expected min < max on every axis")
        }
    }
}

impl Cuboid {
    /// Creates the surface of `bounds`, which must have a volume.
    pub fn new(bounds: Aabb) -> Self {
        Self { bounds }
    }
}

impl RayTest for Cuboid {
    /// Intersects by the slab test of Kay and Kajiya (SIGGRAPH 1986).
    #[inline(always)]
    fn hits<R: Real>(parameters: &[R; N_PARAMETERS], origin: Vector<R>, direction: Vector<R>) -> R {
        let (zero, one) = (origin.x.splat(0.0), origin.x.splat(1.0));
        let span = |min: R, max: R, origin: R, direction: R| {
            let inverse = one / direction;
            let (t0, t1) = ((min - origin) * inverse, (max - origin) * inverse);
            (t0.min(t1), t0.max(t1))
        };
        let (min, max) = (vector(parameters, 0), vector(parameters, 3));
        let x = span(min.x, max.x, origin.x, direction.x);
        let y = span(min.y, max.y, origin.y, direction.y);
        let z = span(min.z, max.z, origin.z, direction.z);
        let (enter, exit) = (x.0.max(y.0.max(z.0)), x.1.min(y.1.min(z.1)));
        let t = R::select(zero.lt(enter), enter, exit);
        R::select(enter.le(exit), t, zero)
    }
}

impl Intersectable for Cuboid {
    #[inline]
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        self.first_hit(ray, t_max)
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn transformed(&self, transform: &Transform) -> Option<Self> {
        let bounds = transform.world_bounds(&self.bounds);
        transform.keeps_axes().then_some(Self { bounds })
    }

    fn patch(&self) -> Option<Patch> {
        let [a, b, c, d, e, f, g, h] = self.bounds.corners();
        Some(Patch::Box([a, b, d, c, e, f, h, g]))
    }
}

impl Project for Cuboid {
    #[inline(always)]
    fn parameters(&self) -> [f32; N_PARAMETERS] {
        parameters_of(&[self.bounds.min, self.bounds.max])
    }

    /// Projects onto the face of the axis along which the point is farthest from the center, in
    /// units of the box.
    #[inline(always)]
    fn project_onto<R: Real>(
        parameters: &[R; N_PARAMETERS],
        near: Vector<R>,
    ) -> (Vector<R>, Vector<R>) {
        let (min, max) = (vector(parameters, 0), vector(parameters, 3));
        let (x, y, z) = (
            FaceAxis::new(min.x, max.x, near.x),
            FaceAxis::new(min.y, max.y, near.y),
            FaceAxis::new(min.z, max.z, near.z),
        );
        let is_y = x.outward.lt(y.outward);
        let is_z = x.outward.max(y.outward).lt(z.outward);
        let (is_x, is_y) = (!is_y & !is_z, is_y & !is_z);
        let zero = near.x.splat(0.0);
        let point = Vector {
            x: R::select(is_x, x.face, near.x),
            y: R::select(is_y, y.face, near.y),
            z: R::select(is_z, z.face, near.z),
        };
        let normal = Vector {
            x: R::select(is_x, x.sign, zero),
            y: R::select(is_y, y.sign, zero),
            z: R::select(is_z, z.sign, zero),
        };
        (point, normal)
    }

    #[inline(always)]
    fn rounding_along<R: Real>(_: &[R; N_PARAMETERS], at: [Vector<R>; 2]) -> R {
        rounding_of_plane(at[0], at)
    }
}

impl Sampled for Cuboid {
    #[inline(always)]
    fn area<R: Real>(parameters: &[R; N_PARAMETERS]) -> R {
        let [x, y, z] = face_areas(parameters);
        x.splat(2.0) * (x + y + z)
    }

    /// Samples the surface uniformly: the first number selects the face.
    #[inline(always)]
    fn sample<R: Real>(
        parameters: &[R; N_PARAMETERS],
        from: Vector<R>,
        [u, v]: [R; 2],
    ) -> SurfaceSample<R> {
        let (zero, one, two) = (u.splat(0.0), u.splat(1.0), u.splat(2.0));
        let [area_x, area_y, area_z] = face_areas(parameters);
        let half_area = area_x + area_y + area_z;
        // Upper faces first, then lower ones.
        let is_lower = one.le(two * u);
        let sign = R::select(is_lower, -one, one);
        let along = (two * u - R::select(is_lower, one, zero)) * half_area;
        let (is_x, is_z) = (along.lt(area_x), (area_x + area_y).le(along));
        let is_y = !is_x & !is_z;
        // The remainder of the number, rescaled, is the first coordinate on the face.
        let left = R::select(
            is_x,
            along / area_x,
            R::select(
                is_z,
                (along - area_x - area_y) / area_z,
                (along - area_x) / area_y,
            ),
        );
        let side = R::select(is_lower, zero, one);
        let fraction = Vector {
            x: R::select(is_x, side, left),
            y: R::select(is_y, side, R::select(is_x, left, v)),
            z: R::select(is_z, side, v),
        };
        let normal = Vector {
            x: R::select(is_x, sign, zero),
            y: R::select(is_y, sign, zero),
            z: R::select(is_z, sign, zero),
        };
        let (min, max) = (vector(parameters, 0), vector(parameters, 3));
        let point = min + (max - min).times(fraction);
        Seen::new(point, normal, from).by_area(two * half_area)
    }
}

/// Returns the areas of a box's faces, by the axis of their normals.
#[inline(always)]
fn face_areas<R: Real>(parameters: &[R; N_PARAMETERS]) -> [R; 3] {
    let Vector { x, y, z } = vector(parameters, 3) - vector(parameters, 0);
    [y * z, z * x, x * y]
}

/// The face perpendicular to one axis that is nearest to a point.
struct FaceAxis<R> {
    /// The point's distance from the center, in units of half the box.
    outward: R,
    /// The sign of the face's normal: -1 or 1.
    sign: R,
    /// The coordinate of the face.
    face: R,
}

impl<R: Real> FaceAxis<R> {
    #[inline(always)]
    fn new(min: R, max: R, near: R) -> Self {
        let half = near.splat(0.5);
        let center = half * min + half * max;
        let outward = (near - center) / (half * (max - min));
        let sign = near.splat(1.0).flip_sign_by(outward);
        Self {
            outward: outward.abs(),
            sign,
            face: R::select(near.splat(0.0).lt(sign), max, min),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn its_corners_follow_one_face_and_then_the_opposite_one() {
        let cuboid = Cuboid::new(Aabb {
            min: Vec3::new(-1.0, -2.0, 3.0),
            max: Vec3::new(1.0, 2.0, 5.0),
        });
        let patch = cuboid.patch().unwrap();
        let (near, far) = patch.corners().split_at(4);
        for i in 0..4 {
            assert_eq!(far[i] - near[i], Vec3::new(0.0, 0.0, 2.0));
            let edge = near[(i + 1) % 4] - near[i];
            assert_eq!((edge != Vec3::ZERO, edge.x * edge.y), (true, 0.0));
        }
        // VTK's hexahedron: the corners of the first face are counter-clockwise as seen from
        // inside.
        let [u, v] = [near[1] - near[0], near[2] - near[1]];
        assert!(u.cross(v).dot(far[0] - near[0]) > 0.0);
    }

    #[test]
    fn a_ray_hits_a_box_from_outside_and_from_inside() {
        let cuboid = Cuboid::new(Aabb {
            min: Vec3::new(-1.0, -2.0, 3.0),
            max: Vec3::new(1.0, 2.0, 5.0),
        });
        let along_z = |z: f32| Ray {
            origin: Vec3::new(0.5, 0.5, z),
            direction: Vec3::Z,
        };
        assert_eq!(cuboid.intersect(&along_z(0.0), 9.0), Some(3.0));
        assert_eq!(cuboid.intersect(&along_z(4.0), 9.0), Some(1.0));
        assert_eq!(cuboid.intersect(&along_z(6.0), 9.0), None);
        let (point, normal) = cuboid.project(Vec3::new(0.5, 0.5, 3.0001));
        assert_eq!((point.z, normal), (3.0, -Vec3::Z));
    }
}
