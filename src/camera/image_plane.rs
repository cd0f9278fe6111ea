//! The image as a rectangle in world space.

use glam::Vec3;

use super::lens::Lens;
use super::sphere_axes::{SphereAxes, shrinkage};
use crate::geometry::Ray;
use crate::simd::{Real, Vector};

/// The positions of the pixels in world space, and the camera rays through them.
///
/// The plane of a panorama is a map of the sphere of radius 1 around the eye, which it
/// touches in the center: lengths along `right` and `down` are angles in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImagePlane {
    /// How the rays pass through the plane.
    pub projection: Projection,
    /// The lens around the eye of a perspective camera; `None` for a pinhole.
    pub lens: Option<Lens>,
    /// The center of pixel (0, 0): column 0 of the top row.
    pub origin: Vec3,
    /// From a pixel's center to the next column's.
    pub right: Vec3,
    /// From a pixel's center to that of the row below.
    pub down: Vec3,
    /// Numbers of columns and rows.
    pub size: [u32; 2],
}

/// How rays pass through the image plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// All start in one point, or around it on a lens.
    Perspective {
        /// That point, in world space.
        eye: Vec3,
    },
    /// All start on the plane, in one direction.
    Parallel {
        /// That direction, a unit vector.
        direction: Vec3,
    },
    /// All start in one point, in all directions.
    Panorama {
        /// That point, in world space.
        eye: Vec3,
        /// The directions of the columns and rows.
        axes: SphereAxes,
    },
}

impl ImagePlane {
    /// An image plane of square pixels around `center`.
    ///
    /// `right` and `up` are unit vectors, `height` is the plane's height in world
    /// units, `size` is the number of columns and rows.
    pub(super) fn centered(
        projection: Projection,
        [center, right, up]: [Vec3; 3],
        height: f32,
        size: [u32; 2],
    ) -> Self {
        let pitch = height / size[1] as f32;
        let [to_first_column, to_first_row] = size.map(|n| 0.5 * (n as f32 - 1.0) * pitch);
        Self {
            projection,
            lens: None,
            origin: center - to_first_column * right + to_first_row * up,
            right: pitch * right,
            down: -pitch * up,
            size,
        }
    }

    /// The same plane without a lens.
    pub fn of_pinhole(self) -> Self {
        Self { lens: None, ..self }
    }

    /// The point at which all camera rays start, if there is one.
    pub fn eye(&self) -> Option<Vec3> {
        match self.projection {
            Projection::Perspective { eye } if self.lens.is_none() => Some(eye),
            Projection::Panorama { eye, .. } => Some(eye),
            Projection::Perspective { .. } | Projection::Parallel { .. } => None,
        }
    }

    /// The point from which the picture is seen: the eye, or without one the center of
    /// the image.
    pub fn viewpoint(&self) -> Vec3 {
        match self.projection {
            Projection::Perspective { eye } | Projection::Panorama { eye, .. } => eye,
            Projection::Parallel { .. } => self.center(),
        }
    }

    /// The ray through pixel coordinates (x, y), with a lens through its center. The
    /// centers of the pixels have integer coordinates, (0, 0) at the top left; a pixel
    /// extends half a unit to each side.
    #[inline]
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let [origin, direction] = self.rays(x, y).map(Vec3::from);
        Ray { origin, direction }
    }

    /// The origins and the directions of the rays through these pixel coordinates:
    /// [`ray`](Self::ray) for one pair or for lanes of them.
    #[inline(always)]
    pub fn rays<R: Real>(&self, x: R, y: R) -> [Vector<R>; 2] {
        match self.projection {
            Projection::Perspective { eye } => {
                let eye = Vector::splat(x, eye);
                [eye, (self.points(x, y) - eye).normalize()]
            }
            Projection::Parallel { direction } => [self.points(x, y), Vector::splat(x, direction)],
            Projection::Panorama { eye, axes } => {
                [Vector::splat(x, eye), axes.direction([x, y], self.size)]
            }
        }
    }

    /// The lens, if there is one: it refracts the rays of a pinhole.
    #[inline(always)]
    pub fn lens(&self) -> Option<&Lens> {
        self.lens.as_ref()
    }

    /// The side of a square with the area of a pixel on the plane.
    pub fn pitch(&self) -> f32 {
        (self.right.length() * self.down.length()).sqrt()
    }

    /// The world-space size of pixel (x, y), or of one per lane, at a distance along its
    /// ray: the side of a square with the pixel's area. `pitch` is that of the plane
    /// ([`pitch`](Self::pitch)).
    #[inline(always)]
    pub fn footprints<R: Real>(&self, pitch: f32, [x, y]: [R; 2], distance: R) -> R {
        let pitch = x.splat(pitch);
        match self.projection {
            Projection::Perspective { eye } => {
                let to_eye = Vector::splat(x, eye) - self.points(x, y);
                pitch * distance / to_eye.length()
            }
            Projection::Parallel { .. } => pitch,
            Projection::Panorama { .. } => pitch * distance * shrinkage(y, self.size[1]),
        }
    }

    /// The world-space size of a pixel at a point that it sees through the lens; `None`
    /// without a lens. `pitch` is that of the plane.
    pub fn footprint_behind_lens(&self, pitch: f32, point: Vec3) -> Option<f32> {
        match (self.projection, &self.lens) {
            // The plane of a camera with a lens is at distance 1.
            (Projection::Perspective { eye }, Some(lens)) => Some(pitch * lens.depth(eye, point)),
            _ => None,
        }
    }

    /// The world-space point of pixel coordinates (x, y).
    pub fn point(&self, x: f32, y: f32) -> Vec3 {
        self.points(x, y).into()
    }

    /// [`point`](Self::point) of one pair of coordinates or of one per lane.
    #[inline(always)]
    fn points<R: Real>(&self, x: R, y: R) -> Vector<R> {
        let [origin, right, down] = [self.origin, self.right, self.down];
        Vector::splat(x, origin) + Vector::splat(x, right) * x + Vector::splat(x, down) * y
    }

    /// The center of the image.
    pub fn center(&self) -> Vec3 {
        let [x, y] = self.size.map(|n| 0.5 * (n as f32 - 1.0));
        self.point(x, y)
    }
}
