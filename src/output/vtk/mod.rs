//! VTK XML files of the film and of rays.
//!
//! The header is made of vtkio's types by vtkio's serialiser; the arrays
//! follow it raw, straight from the film, so that no second copy of the frame
//! is ever in memory. (vtkio's own writer would hold the whole file as base64
//! text, and cuts what is longer than 2 GiB.)

mod array;
mod appended;
mod frame;
mod header;
mod hits;
mod rays;

pub(super) use frame::FILE as FRAME;
pub use frame::write as write_frame;
pub(super) use hits::FILE as HITS;
pub use hits::write as write_hits;
pub(super) use rays::{FILE as RAYS, Rays};
