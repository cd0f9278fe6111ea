//! A ray tracer that shows its work.
//!
//! ```no_run
//! # use raycost::scene::{Geometries, Scene};
//! use raycost::{accel::Accel, config::Config, cost::Meter, render::{Plan, render}, yaml::Source};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let source = Source::read("configs/seed_sphere.yaml".as_ref())?;       // the text,
//! let config: Config = source.parse()?;                                  // checked values,
//! let point_at = |fault| source.point_at(fault);
//! let geometries = Geometries::read(&config, source.folder(), u64::MAX).map_err(point_at)?; // files read,
//! let scene = Scene::new(&config, geometries).map_err(point_at)?;        // world space,
//! let accel = Accel::new(&scene.primitives, config.acceleration);        // a way to find hits,
//! let meter = Meter::new(config.cost);                                   // time and counters,
//! let plan = Plan::new(&scene, &accel, &config.image, config.tiles);     // tiles in order,
//! let (film, schedule) = render(&scene, &accel, &plan, &meter, |_| {});  // pixels and their cost:
//! println!("{} pixels see something", film.n_hits());
//! println!("{:.1} % of the time was idle", 100.0 * schedule.load().idle_share);
//! # Ok(()) }
//! ```
//!
//! The modules stand in the order of the data; each uses only those above it.

pub mod stop;
pub mod host;
pub mod text;
pub mod provenance;
pub mod folder;
pub mod vtk;
pub mod yaml;
pub mod sampling;
pub mod statistics;
pub mod geometry;
pub mod import;
pub mod camera;
pub mod light;
pub mod material;
pub mod config;
pub mod scene;
pub mod cost;
pub mod accel;
pub mod trace;
pub mod shade;
pub mod schedule;
pub mod film;
pub mod render;
pub mod attribution;
pub mod instruments;
pub mod chart;
pub mod paraview;
pub mod summary;
pub mod output;
pub mod memory;
pub mod results;
pub mod view;
pub mod diff;
pub mod study;
pub mod cli;
