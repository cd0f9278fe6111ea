//! The shear that makes rays of one direction run along an axis.

use glam::Vec3;

use super::Ray;

/// A space in which a ray starts at the origin and runs along the last axis.
///
/// Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", Journal of
/// Computer Graphics Techniques 2(1), 2013. A point has the same coordinates
/// here in whatever triangle it is a corner of, and the sign of an edge's
/// function is never wrong: rounding at most makes it zero, which counts as
/// inside. So no ray slips through between triangles that share corners.
/// (Nothing here may be contracted to a fused product and sum.)
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shear {
    /// The axes that become the first, the second and the last one; the last is
    /// the one along which the ray goes farthest.
    pub axes: [usize; 3],
    /// What is taken off the first and the second coordinate for each unit of
    /// the last one; at most 1 in magnitude.
    pub slopes: [f32; 2],
    /// The ray's parameter for each unit of the last coordinate.
    pub scale: f32,
}

impl Shear {
    /// The shear for a ray in this direction, which is not zero.
    #[inline(always)]
    pub fn along(direction: Vec3) -> Self {
        // No branch on the direction, which nobody can foretell.
        let d = direction.abs();
        let is_y = usize::from(d.y > d.x);
        let is_z = usize::from(d.z > d.x.max(d.y));
        let last = (is_y | is_z) << is_z;
        let axes = [(last + 1) % 3, (last + 2) % 3, last];
        let [x, y, z] = turned(direction, axes);
        let scale = z.recip();
        Self {
            axes,
            slopes: [x * scale, y * scale],
            scale,
        }
    }

    /// The point in this space, its last coordinate as the ray's parameter.
    #[inline(always)]
    pub fn point(&self, ray: &Ray, point: Vec3) -> Vec3 {
        let [x, y, z] = self.turn(point - ray.origin);
        let [slope_x, slope_y] = self.slopes;
        Vec3::new(x - slope_x * z, y - slope_y * z, self.scale * z)
    }

    /// The vector's coordinates in the order of this space.
    #[inline(always)]
    pub fn turn(&self, v: Vec3) -> [f32; 3] {
        turned(v, self.axes)
    }
}

#[inline(always)]
fn turned(v: Vec3, [x, y, z]: [usize; 3]) -> [f32; 3] {
    // An array, since the index of a `Vec3` is a branch.
    let v = v.to_array();
    [v[x % 3], v[y % 3], v[z % 3]]
}
