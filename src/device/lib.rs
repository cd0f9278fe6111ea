//! Camera rays → colors, hits and counters on another device, equal to the processor's bit for bit.
//!
//! In: the arrays of an acceleration structure ([`Accel::levels`](tracer::accel::Accel::levels)),
//! the formulas of paths ([`PathFormulas`](tracer::shade::PathFormulas)), and streams of rays. Out:
//! colors, hits, node visits and primitive tests. A [`Device`] proves its arithmetic before the
//! first ray; [`Device::load`] copies a scene to its memory, and gives a
//! [`RayDevice`](tracer::accel::RayDevice).
//!
//! The program is one text; a prelude turns it into OpenCL C or CUDA C++. The loops are written there
//! (`traversal.cl`, `level.cl`, `path.cl`), and the formulas of boxes and shapes (`formulas`), of
//! surfaces and lights (`paths`) are recorded from the Rust code (`tape`), so that none is written
//! twice.

mod tape;
mod print;
mod shared;
mod formulas;
mod step;
mod paths;
mod program;
mod scene;
mod library;
mod opencl;
mod cuda;
mod proof;
mod opened;
mod multiprocessors;
mod device_scene;

pub use device_scene::DeviceScene;
pub use opened::{Device, DeviceError, DeviceLibrary};
