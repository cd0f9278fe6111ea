//! Values of space: rays, boxes, transforms and the shapes that rays hit.
//!
//! A shape is one file: its YAML keys, its bounds, its intersection. All is
//! `f32` and in whatever space the caller uses: object space as read from the
//! scene file, world space once `scene` has placed it. To add a shape, write
//! its file, its `mod` line and its line in [`shape::Shape`].

mod ray;
mod shear;
mod aabb;
mod transform;
mod shape;
mod sphere;
mod plane;
mod disk;
mod triangle;
mod cuboid;

pub use aabb::Aabb;
pub use cuboid::Cuboid;
pub use disk::Disk;
pub use plane::Plane;
pub use ray::Ray;
pub use shape::{Shape, Surface};
pub use shear::Shear;
pub use sphere::Sphere;
pub use transform::{Transform, TransformStep};
pub use triangle::Triangle;
