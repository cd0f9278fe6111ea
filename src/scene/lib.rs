//! A YAML file and the files it refers to → a world in render space.
//!
//! In: text. Out: a [`Config`](config::Config), the file as typed and checked values; and a
//! [`Scene`](world::scene::Scene), the primitives, materials and lights that rays meet, with ids instead
//! of names. A mistake is a message with the line of the file.
//!
//! Read [`config`] first, the sections of a file, then [`build`], which places them in a
//! [`Scene`](world::scene::Scene). [`yaml`] turns text into values.

pub mod yaml;
pub mod animation;
pub mod config;
pub mod build;
