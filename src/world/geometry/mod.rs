//! Rays, boxes, transforms and the shapes that rays hit.
//!
//! Each shape has one file: its YAML keys, its bounds, its intersection with a
//! ray. All coordinates are `f32`, in the space of the caller: object space in
//! the scene file, world space once `scene` has placed the object. To add a
//! shape, write its file, its `mod` line and its row in `shape.rs`.

mod located;
mod render_space;
mod ray;
mod ray_stream;
mod areas;
mod shear;
mod aabb;
mod transform;
mod placement;
mod patch;
mod intersect;
mod surface;
mod instance_transform;
mod sampled;
mod shape;
mod sphere_equation;
mod sphere;
mod plane;
mod disk;
mod triangle;
mod cuboid;
mod spherical_rectangle;
mod rectangle;
mod axis;
mod cone;
mod cylinder;
mod capsule;

/// The unit of lengths in files.
pub const LENGTH_UNIT: &str = "world units";

pub use aabb::Aabb;
pub use areas::{AreaTest, Areas};
pub use instance_transform::InstanceTransform;
pub use intersect::{Intersectable, RayTest};
pub use located::{Described, Keyed, Located, located, located_points, origin_near};
pub use patch::Patch;
pub use placement::{InstancePlacement, ShapePlacement};
pub use plane::MIN_COS;
pub use ray::{Ray, leaving};
pub use ray_stream::RayStream;
pub use render_space::RenderSpace;
pub use sampled::{Sampled, Seen, SurfaceSample};
pub use shape::*;
pub use shear::{Shear, dominant_axis, permuted_by, shear_constants, sheared};
pub use sphere_equation::{SphereEquation, squared_length};
pub(crate) use surface::rounding_of;
pub use surface::{N_PARAMETERS, Project};
pub use transform::{Transform, TransformStep, world_from_object};
pub use triangle::{barycentrics, corners};
