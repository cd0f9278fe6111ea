//! The shear that maps the rays of one direction to an axis.

use glam::Vec3;

use super::Ray;
use super::areas::{AreaTest, Areas};
use math::simd::{Arithmetic, Real, Vector};

/// A space in which a ray starts at the origin and points along the last axis.
///
/// Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", Journal of Computer Graphics
/// Techniques 2(1), 2013. The coordinates of a vertex are the same for all triangles that share it,
/// and the side of an edge on which the ray passes is decided as if there were no rounding. So no
/// ray passes between triangles that share vertices, and no ray hits a triangle that it misses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shear {
    /// The axes that become the first, the second and the last one. The last is the dominant axis
    /// of the ray's direction.
    pub axes: [usize; 3],
    /// The shear constants of the paper: the shear of the first and the second coordinate per unit
    /// of the last one, at most 1 in magnitude, and the ray's parameter per unit of the last one.
    pub constants: Vec3,
}

/// Returns two booleans that select the dominant axis of a direction: it is the last axis if the
/// second one is true, else the second axis if the first one is true, else the first axis.
#[inline(always)]
pub fn dominant_axis<R: Arithmetic>(direction: Vector<R>) -> (R::Mask, R::Mask) {
    let Vector { x, y, z } = direction;
    let (x, y, z) = (x.abs(), y.abs(), z.abs());
    (x.lt(y), x.max(y).lt(z))
}

/// Permutes the axes of a vector, given the [`dominant_axis`]: that axis comes last.
#[inline(always)]
pub fn permuted_by<R: Real>(v: Vector<R>, (is_y, is_z): (R::Mask, R::Mask)) -> Vector<R> {
    let Vector { x, y, z } = v;
    let (if_x, if_y) = (Vector { x: y, y: z, z: x }, Vector { x: z, y: x, z: y });
    Vector::select(is_z, v, Vector::select(is_y, if_y, if_x))
}

/// Returns the shear constants for a ray in this direction, whose axes are permuted.
#[inline(always)]
pub fn shear_constants<R: Arithmetic>(Vector { x, y, z }: Vector<R>) -> Vector<R> {
    let z = z.splat(1.0) / z;
    Vector {
        x: x * z,
        y: y * z,
        z,
    }
}

/// Shears a point, given from the ray's origin, with permuted axes.
#[inline(always)]
pub fn sheared<R: Arithmetic>(point: Vector<R>, constants: Vector<R>) -> Vector<R> {
    Vector {
        x: point.x - constants.x * point.z,
        y: point.y - constants.y * point.z,
        z: point.z,
    }
}

impl Shear {
    /// Returns the shear for a ray in this direction, which must not be zero.
    #[inline(always)]
    pub fn along(direction: Vec3) -> Self {
        let (is_y, is_z) = dominant_axis(direction.into());
        let axes = Self::axes(is_y, is_z);
        Self {
            axes,
            constants: shear_constants(permuted(direction, axes).into()).into(),
        }
    }

    /// Returns the axes of a shear, given the [`dominant_axis`].
    #[inline(always)]
    pub fn axes(is_y: bool, is_z: bool) -> [usize; 3] {
        /// The axes, by the last one.
        const AXES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];
        // No branch on the direction: it is unpredictable.
        AXES[(usize::from(is_y | is_z) << u8::from(is_z)) % 3]
    }

    /// Transforms a point to this space.
    #[inline(always)]
    pub fn point(&self, ray: &Ray, point: Vec3) -> Vec3 {
        let from_origin = self.permute(point - ray.origin);
        sheared(from_origin.into(), self.constants.into()).into()
    }

    /// Transforms three points to this space.
    #[inline(always)]
    pub fn points(&self, ray: &Ray, [a, b, c]: [Vec3; 3]) -> [Vec3; 3] {
        // No `map`: it is not always inlined.
        [self.point(ray, a), self.point(ray, b), self.point(ray, c)]
    }

    /// Returns the ray's parameter at its hit on the triangle with these vertices in this space;
    /// `None` if the ray misses it or lies in its plane. Decides with 32 bits where these suffice.
    #[inline]
    pub fn intersect(&self, vertices: [Vec3; 3]) -> Option<f32> {
        let [a, b, c] = vertices;
        let areas = Areas::new(&[a.into(), b.into(), c.into()]);
        let AreaTest { hits, is_unsure, t } = areas.test(self.constants.z);
        if is_unsure {
            return self.intersect_exactly(vertices);
        }
        hits.then_some(t)
    }

    /// Intersects as [`intersect`](Self::intersect) does, where rounding may decide.
    ///
    /// Products of two `f32` are exact in `f64`. So the signs of the areas are exact for these
    /// vertices, and the relative error of the result is about 2^-50, however thin the triangle or
    /// grazing the ray.
    #[cold]
    #[inline(never)]
    pub fn intersect_exactly(&self, vertices: [Vec3; 3]) -> Option<f32> {
        let [a, b, c] = vertices;
        let [a, b, c] = [a.as_dvec3(), b.as_dvec3(), c.as_dvec3()];
        // The areas of the triangles of each edge and the ray.
        let u = b.x * c.y - b.y * c.x;
        let v = c.x * a.y - c.y * a.x;
        let w = a.x * b.y - a.y * b.x;
        let (least, greatest) = (u.min(v).min(w), u.max(v).max(w));
        let area = u + v + w;
        if least < 0.0 && greatest > 0.0 || area == 0.0 {
            return None;
        }
        // The depth is the mean of the vertices' depths, weighted by the areas.
        let z = (u * a.z + v * b.z + w * c.z) / area;
        Some((z * f64::from(self.constants.z)) as f32)
    }

    /// Returns the vector's coordinates in the order of this space's axes.
    #[inline(always)]
    pub fn permute(&self, v: Vec3) -> Vec3 {
        permuted(v, self.axes)
    }
}

#[inline(always)]
fn permuted(v: Vec3, [x, y, z]: [usize; 3]) -> Vec3 {
    // An array, since indexing a `Vec3` branches; of length four, since a remainder by 3 is slow.
    let v = v.extend(0.0).to_array();
    Vec3::new(v[x % 4], v[y % 4], v[z % 4])
}
