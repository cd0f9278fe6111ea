//! A YAML file and the files it refers to → a world in render space.
//!
//! In: text. Out: a [`Config`](config::Config), the file as typed and checked values; and a
//! [`Scene`](world::Scene), the primitives, materials and lights that rays meet, with ids instead
//! of names. A mistake is a message with the line of the file.
//!
//! Read [`config`] first, the sections of a file, then [`world`], which places them. Between the
//! two are the kinds of things, one file each: [`geometry`], [`camera`], [`light`], [`material`], …
//! [`yaml`] turns text into values, [`import`] reads meshes, points and pictures.

pub mod yaml;
pub mod color;
pub mod picture;
pub mod geometry;
pub mod light;
pub mod import;
pub mod camera;
pub mod fog;
pub mod material;
pub mod background;
pub mod animation;
pub mod config;
pub mod world;
