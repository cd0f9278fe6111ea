//! The image as a rectangle in render space.

use glam::{DVec3, Vec3};

use super::lens::Lens;
use super::sphere_axes::{SphereAxes, shrinkage};
use crate::geometry::{Aabb, Ray, RenderSpace};
use math::simd::{Real, Vector};

/// The positions of the pixels in render space, and the camera rays through them.
///
/// The plane of a panorama is a map of the sphere of radius 1 around the eye, which it
/// touches in the center: lengths along `right` and `down` are angles in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImagePlane {
    /// How the rays pass through the plane.
    pub projection: Projection,
    /// The lens around the eye of a perspective camera; `None` for a pinhole.
    pub lens: Option<Lens>,
    /// The space of all vectors here.
    pub space: RenderSpace,
    /// [`eye`](Self::eye) in world space, exactly.
    pub eye_in_world: DVec3,
    /// The point from which the picture is seen; for parallel rays, the center of the image.
    pub eye: Vec3,
    /// From the eye to the center of pixel (0, 0): column 0 of the top row. Relative to the eye, so
    /// that ray directions keep all digits wherever it is.
    pub to_first: Vec3,
    /// From a pixel's center to the next column's.
    pub right: Vec3,
    /// From a pixel's center to the center of the pixel below.
    pub down: Vec3,
    /// Numbers of columns and rows.
    pub size: [u32; 2],
}

impl ImagePlane {
    /// Returns the part of the plane with these numbers of columns and rows, starting at this
    /// column and row.
    pub fn part(&self, origin: [u32; 2], size: [u32; 2]) -> Self {
        let [left, top] = origin.map(|n| n as f32);
        Self {
            to_first: self.to_first + left * self.right + top * self.down,
            size,
            ..*self
        }
    }
}

/// How rays pass through the image plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// All start at the eye, or around it on a lens.
    Perspective,
    /// All start on the plane, in one direction.
    Parallel {
        /// The direction, a unit vector.
        direction: Vec3,
    },
    /// All start at the eye, in all directions.
    Panorama {
        /// The directions of the columns and rows.
        axes: SphereAxes,
    },
}

impl ImagePlane {
    /// Creates an image plane of square pixels, whose center is at `to_center` from the eye, a
    /// point in world space.
    ///
    /// `right` and `up` are unit vectors, `height` is the plane's height, `size` is the number of
    /// columns and rows.
    pub(super) fn centered(
        projection: Projection,
        space: RenderSpace,
        eye: DVec3,
        [to_center, right, up]: [Vec3; 3],
        height: f32,
        size: [u32; 2],
    ) -> Self {
        let pitch = height / size[1] as f32;
        let [to_first_column, to_first_row] = size.map(|n| 0.5 * (n as f32 - 1.0) * pitch);
        Self {
            projection,
            lens: None,
            space,
            eye_in_world: eye,
            eye: space.point(eye),
            to_first: to_center - to_first_column * right + to_first_row * up,
            right: pitch * right,
            down: -pitch * up,
            size,
        }
    }

    /// Returns the plane without its lens.
    pub fn without_lens(self) -> Self {
        Self { lens: None, ..self }
    }

    /// Returns the point at which all camera rays start, if there is one.
    #[inline]
    pub fn eye(&self) -> Option<Vec3> {
        let is_point = match self.projection {
            Projection::Perspective => self.lens.is_none(),
            Projection::Panorama { .. } => true,
            Projection::Parallel { .. } => false,
        };
        is_point.then_some(self.eye)
    }

    /// Returns the bounds of the points at which camera rays start that pass through pixels, or
    /// through points up to `margin` pixels beside them.
    pub fn origins(&self, margin: f32) -> Aabb {
        if let Projection::Parallel { .. } = self.projection {
            let ends = self.size.map(|n| [-margin, (n - 1) as f32 + margin]);
            return Aabb::from_points(
                ends[0]
                    .into_iter()
                    .flat_map(|x| ends[1].map(|y| self.point(x, y))),
            );
        }
        let radius = Vec3::splat(self.lens.map_or(0.0, |lens| lens.radius));
        Aabb {
            min: self.eye - radius,
            max: self.eye + radius,
        }
    }

    /// Returns the ray through pixel coordinates (x, y), with a lens through its center. The
    /// centers of the pixels have integer coordinates, (0, 0) at the top left; a pixel extends half
    /// a unit to each side.
    #[inline]
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let [origin, direction] = self.rays(x, y).map(Vec3::from);
        Ray { origin, direction }
    }

    /// Returns the origins and the directions of the rays through these pixel coordinates:
    /// [`ray`](Self::ray) for one pair or for lanes of them.
    #[inline(always)]
    pub fn rays<R: Real>(&self, x: R, y: R) -> [Vector<R>; 2] {
        let eye = Vector::splat(x, self.eye);
        match self.projection {
            Projection::Perspective => [eye, self.offset(x, y).normalize()],
            Projection::Parallel { direction } => {
                [eye + self.offset(x, y), Vector::splat(x, direction)]
            }
            Projection::Panorama { axes } => [eye, axes.direction([x, y], self.size)],
        }
    }

    /// Returns the lens if there is one: it refracts the rays of a pinhole.
    #[inline(always)]
    pub fn lens(&self) -> Option<&Lens> {
        self.lens.as_ref()
    }

    /// Returns the side of a square with the area of a pixel on the plane.
    #[inline]
    pub fn pitch(&self) -> f32 {
        (self.right.length() * self.down.length()).sqrt()
    }

    /// Returns the size of pixel (x, y), or of one pixel per lane, at a distance along its ray: the
    /// side of a square with the pixel's area. `pitch` is the plane's [`pitch`](Self::pitch).
    #[inline(always)]
    pub fn footprints<R: Real>(&self, pitch: f32, [x, y]: [R; 2], distance: R) -> R {
        let pitch = x.splat(pitch);
        match self.projection {
            Projection::Perspective => pitch * distance / self.offset(x, y).length(),
            Projection::Parallel { .. } => pitch,
            Projection::Panorama { .. } => pitch * distance * shrinkage(y, self.size[1]),
        }
    }

    /// Returns by how many pixels rounding displaces rays where they reach the origin of render
    /// space, which is in the scene: eyes too far away make it large.
    pub fn displacement(&self) -> f32 {
        let distance = self.eye.length();
        let center = self.size.map(|n| 0.5 * n as f32);
        let pixel = self.footprints(self.pitch(), center, distance);
        distance * (0.5 * f32::EPSILON) / pixel
    }

    /// Returns the size of a pixel at a point seen through the lens; `None` without a lens. `pitch`
    /// is the plane's.
    pub fn footprint_behind_lens(&self, pitch: f32, point: Vec3) -> Option<f32> {
        // The image plane of a camera with a lens is at distance 1.
        let lens = self.lens.as_ref()?;
        Some(pitch * lens.depth(self.eye, point))
    }

    /// Returns the point at pixel coordinates (x, y).
    #[inline]
    pub fn point(&self, x: f32, y: f32) -> Vec3 {
        self.eye + Vec3::from(self.offset(x, y))
    }

    /// Returns the vector from the eye to a pair of pixel coordinates, or to one pair per lane.
    #[inline(always)]
    fn offset<R: Real>(&self, x: R, y: R) -> Vector<R> {
        let [first, right, down] = [self.to_first, self.right, self.down];
        Vector::splat(x, first) + Vector::splat(x, right) * x + Vector::splat(x, down) * y
    }

    /// Returns the center of the image.
    pub fn center(&self) -> Vec3 {
        let [x, y] = self.size.map(|n| 0.5 * (n as f32 - 1.0));
        self.point(x, y)
    }
}
