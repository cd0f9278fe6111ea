//! The world that rays meet: shapes, materials, lights, fog and cameras, and the [`Scene`](scene::Scene)
//! that holds them in render space.
//!
//! In: values, read from a file or made by a program. Out: what the tracer traverses and shades.
//! Read [`scene`] first; the kinds of things have one file each: [`geometry`], [`material`],
//! [`light`], [`camera`], … Their keys stand beside their formulas, checked by [`values`].

pub mod values;
pub mod color;
pub mod picture;
pub mod geometry;
pub mod light;
pub mod camera;
pub mod fog;
pub mod material;
pub mod background;
pub mod shading;
pub mod scene;
