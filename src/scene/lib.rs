//! A YAML file and the files it names -> a world in render space.

pub mod yaml;
pub mod color;
pub mod picture;
pub mod geometry;
pub mod import;
pub mod camera;
pub mod light;
pub mod fog;
pub mod material;
pub mod background;
pub mod animation;
pub mod config;
pub mod world;
