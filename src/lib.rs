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
//! Programs start with [`session`]; [`job`] renders frames, parts of pictures and what other runs
//! left. [`film`] holds the pixels, [`cost`] lists the metrics of a
//! pixel, [`config`] the settings of a scene, and [`results`] reads the files of an earlier
//! rendering. The folder `examples/` has programs.
//!
//! # How the data flows
//!
//! The crates below `src/` stand in the order of the data; each uses only the crates above it.
//!
//! 1. `base` has keywords and requests to stop, `math` numbers and SIMD lanes.
//! 2. `world` has what rays meet: shapes, materials, lights, fog and cameras in render space.
//! 3. `tracer` finds hits and makes colors of them, and counts and times both.
//! 4. `host` has files, folders, memory and threads, `device` traces rays on OpenCL and CUDA devices, `vtk`
//!    has files of VTK; `import` reads files of meshes, points and pictures.
//! 5. `scene` reads a YAML file and the files that it names, and builds a world of them.
//! 6. `render` traces it tile by tile on all threads, onto a film.
//! 7. `output` writes files: pictures, VTK files, ParaView states and the summary.
//! 8. `tools` reads them again, for `view`, `diff` and `study`.
//!
//! [`session`] runs these steps; `cli` is its command line. The crates are public for the tests and
//! the benchmarks; programs use only the names listed here.

pub mod session;
pub mod job;
#[doc(hidden)]
pub mod cli;

#[doc(inline)]
pub use ::{
    device::{Device, DeviceError, DeviceLibrary},
    output::results,
    render::{attribution, film, schedule},
    scene::{animation, build, config, yaml},
    tracer::{accel, cost},
    world::{self, background, camera, color, fog, geometry, light, material, picture},
};

pub use cost::Metric;
pub use session::{Options, Session};

/// The steps of a rendering, for scenes that a program makes of the types of [`world`].
#[doc(inline)]
pub use ::{
    render::tiles::{TilePlan, render},
    scene::build::Sensor,
    tracer::trace::Tracer,
};
