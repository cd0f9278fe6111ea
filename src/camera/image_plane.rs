//! The picture as a rectangle in the world.

use glam::Vec3;

use crate::geometry::Ray;

/// Where the pixels lie in the world, and how rays go through them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImagePlane {
    /// How the rays run.
    pub projection: Projection,
    /// The sample point of pixel (0, 0): column 0 of the top row.
    pub origin: Vec3,
    /// From one column's sample point to the next one's.
    pub right: Vec3,
    /// From one row's sample point to that of the row below.
    pub down: Vec3,
    /// Columns and rows.
    pub size: [u32; 2],
}

/// How rays run through the image plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// All from one point.
    Perspective {
        /// That point.
        eye: Vec3,
    },
    /// All in one direction, from the plane on.
    Parallel {
        /// That direction, a unit vector.
        direction: Vec3,
    },
}

impl ImagePlane {
    /// An image plane of square pixels around its middle, looking along `forward`.
    ///
    /// `height` is the plane's height in world units; `right` and `up` are unit
    /// vectors; `size` counts the pixels.
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
            origin: center - to_first_column * right + to_first_row * up,
            right: pitch * right,
            down: -pitch * up,
            size,
        }
    }

    /// The ray through pixel coordinates (x, y): whole numbers are the pixels'
    /// own sample points, (0, 0) on top left; a pixel reaches half a unit to
    /// each side.
    #[inline]
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let through = self.point(x, y);
        match self.projection {
            Projection::Perspective { eye } => Ray {
                origin: eye,
                direction: (through - eye).normalize(),
            },
            Projection::Parallel { direction } => Ray {
                origin: through,
                direction,
            },
        }
    }

    /// The world-space size of pixel (x, y) at a distance along its ray: the
    /// side of a square as large as the pixel.
    pub fn footprint(&self, x: f32, y: f32, distance: f32) -> f32 {
        let pitch = (self.right.length() * self.down.length()).sqrt();
        match self.projection {
            Projection::Perspective { eye } => pitch * distance / self.point(x, y).distance(eye),
            Projection::Parallel { .. } => pitch,
        }
    }

    /// The world-space point of pixel coordinates (x, y).
    pub fn point(&self, x: f32, y: f32) -> Vec3 {
        self.origin + x * self.right + y * self.down
    }

    /// The middle of the picture.
    pub fn center(&self) -> Vec3 {
        let [x, y] = self.size.map(|n| 0.5 * (n as f32 - 1.0));
        self.point(x, y)
    }
}
