//! The points at which textures are looked up.

use glam::Vec3;

use math::simd::{Real, Vector};

/// A point of a surface, or one per lane, as textures see it.
#[derive(Debug, Clone, Copy)]
pub struct TexturePoint<R> {
    /// The point in world space.
    pub position: Vector<R>,
    /// The shading normal, a unit vector on the side from which the ray came.
    pub normal: Vector<R>,
    /// The texture coordinates of a mesh; 0 for other shapes.
    pub uv: [R; 2],
    /// The side of a square of unit area in texture coordinates; 0 without texture coordinates.
    pub uv_density: R,
    /// The directions in which the texture coordinates grow; 0 without texture coordinates.
    pub uv_axes: [Vector<R>; 2],
    /// The number of the array that gives the color; NaN without one.
    pub scalar: R,
    /// The interpolated color of a mesh's vertices: linear light; black without vertex colors.
    pub color: Vector<R>,
    /// The width of the ray's footprint on the surface, in world units.
    pub width: R,
}

impl<R: Real> TexturePoint<R> {
    /// Creates a point without texture coordinates and without an extent.
    #[inline(always)]
    pub fn new(position: Vector<R>, normal: Vector<R>) -> Self {
        let zero = position.x.splat(0.0);
        Self {
            position,
            normal,
            uv: [zero, zero],
            uv_density: zero,
            uv_axes: [Vector::splat(zero, Vec3::ZERO); 2],
            scalar: zero.splat(f32::NAN),
            color: Vector::splat(zero, Vec3::ZERO),
            width: zero,
        }
    }
}
