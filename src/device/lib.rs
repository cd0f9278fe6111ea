//! Rays → hits and counters on another device, equal to the processor's bit for bit.
//!
//! In: the arrays of an acceleration structure ([`Accel::levels`](tracer::accel::Accel::levels)),
//! and streams of rays. Out: hits, node visits and primitive tests. A [`Device`] proves its
//! arithmetic before the first ray; [`Device::load`] copies a scene to its memory, and gives a
//! [`RayDevice`](tracer::accel::RayDevice).
//!
//! The program is a text of OpenCL C: loop and stack are written there (`traversal.cl`,
//! `level.cl`), and the formulas of boxes and shapes are recorded from the Rust code (`tape`,
//! `formulas`), so that none is written twice.

mod tape;
mod print;
mod formulas;
mod program;
mod scene;
mod opencl;
mod proof;
mod opened;
mod device_scene;

pub use device_scene::DeviceScene;
pub use opened::{Device, DeviceError};
