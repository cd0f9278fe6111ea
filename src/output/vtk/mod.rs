//! VTK XML files: of the film, of rays, of the hierarchy, of the scene's surface.
//!
//! The header is made of vtkio's types by vtkio's serialiser; the arrays
//! follow it, raw or compressed a few blocks at a time, straight from where
//! they are, so that no second copy is ever in memory. (vtkio's own writer would hold the whole file as base64
//! text, and cuts what is longer than 2 GiB.)

pub(crate) mod encoding;
pub(crate) mod array;
pub(crate) mod appended;
pub(crate) mod compressor;
mod compressed;
mod frame;
pub(crate) mod header;
mod hits;
mod nodes;
mod surface;
mod rays;
mod tiles;

pub use encoding::Encoding;
pub use frame::FILE as FRAME;
pub use frame::write as write_frame;
pub use hits::FILE as HITS;
pub use hits::write as write_hits;
pub(super) use nodes::FILE as NODES;
pub use nodes::write as write_nodes;
pub(super) use rays::{FILE as RAYS, Rays};
pub(super) use surface::FILE as SURFACE;
pub use surface::write as write_surface;
pub(super) use tiles::FILE as TILES;
pub use tiles::write as write_tiles;
