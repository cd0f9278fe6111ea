//! A ray tracer that shows its work.
//!
//! Three steps lead from a scene file to files for ParaView:
//!
//! ```no_run
//! use raycost::{Options, Session};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let session = Session::open("configs/seed_sphere.yaml")?;
//! let mut rendering = session.render(&Options::default())?;
//! rendering.write("out/seed_sphere")?;
//! # Ok(()) }
//! ```
//!
//! [`session`] is where a program starts. [`film`] holds the pixels, [`cost`] lists the
//! metrics of a pixel, [`config`] the settings of a scene, and [`results`] reads the
//! files of an earlier rendering. The folder `examples/` has programs.
//!
//! # How the data flows
//!
//! The modules stand in the order of the data; each uses only those above it.
//!
//! 1. `yaml` and `config` check the values of a scene file, `import` reads the files
//!    that it names, and `scene` places everything in world space.
//! 2. `accel` finds hits, `trace` and `shade` make colors of them, and `schedule` and
//!    `render` do so tile by tile on all threads. `cost` counts and times.
//! 3. `film` holds the pixels, and `attribution` the cost of objects and nodes.
//! 4. `output` writes files, by way of `vtk`, `chart`, `paraview` and `folder`.
//! 5. `results` reads them again, for `view`, `diff` and `study`.
//!
//! `session` runs these steps; `cli` is its command line. The modules that this
//! documentation leaves out are public only for the tests and the benchmarks, and
//! change without notice.

#[doc(hidden)]
pub mod stop;
#[doc(hidden)]
pub mod host;
#[doc(hidden)]
pub mod text;
#[doc(hidden)]
pub mod files;
#[doc(hidden)]
pub mod provenance;
#[doc(hidden)]
pub mod folder;
#[doc(hidden)]
pub mod vtk;
#[doc(hidden)]
pub mod yaml;
#[doc(hidden)]
pub mod simd;
#[doc(hidden)]
pub mod sampling;
#[doc(hidden)]
pub mod optics;
#[doc(hidden)]
pub mod statistics;
pub mod color;
pub mod picture;
pub mod geometry;
#[doc(hidden)]
pub mod import;
pub mod camera;
pub mod light;
pub mod fog;
pub mod material;
pub mod background;
pub mod animation;
pub mod config;
pub mod scene;
pub mod cost;
#[doc(hidden)]
pub mod accel;
#[doc(hidden)]
pub mod trace;
#[doc(hidden)]
pub mod shade;
pub mod schedule;
pub mod film;
#[doc(hidden)]
pub mod checkpoint;
#[doc(hidden)]
pub mod ranks;
#[doc(hidden)]
pub mod render;
pub mod attribution;
#[doc(hidden)]
pub mod instruments;
#[doc(hidden)]
pub mod chart;
#[doc(hidden)]
pub mod paraview;
#[doc(hidden)]
pub mod summary;
#[doc(hidden)]
pub mod output;
#[doc(hidden)]
pub mod memory;
mod prediction;
pub mod results;
#[doc(hidden)]
pub mod view;
#[doc(hidden)]
pub mod diff;
#[doc(hidden)]
pub mod study;
#[doc(hidden)]
pub mod series;
#[doc(hidden)]
pub mod schema;
#[doc(hidden)]
pub mod starter;
pub mod session;
#[doc(hidden)]
pub mod cli;

pub use cost::Metric;
pub use session::{Options, Session};
