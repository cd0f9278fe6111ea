//! Finished tiles as bytes: a part of a picture, or an interrupted rendering.
//!
//! A [`TileRecord`] holds all that a rendering keeps of a tile: the pixels of the film bit for bit,
//! the packed counters, and when and by which thread it was rendered. It is independent of files. A
//! checkpoint file (`file`) is a [`Header`], which identifies the rendering, and a list of blocks
//! (`block`), each with its length and its checksum: a file that was cut anywhere, or in which any
//! byte differs, is recognized. A [`Checkpoint`] is read and written by a rendering: tiles of any
//! number of files, and one file that new tiles are appended to.

mod layout;
mod record;
mod block;
mod header;
mod file;
mod writer;
mod store;
mod parts;

pub use file::{CheckpointFile, Damage, RunSpan};
pub use header::{Header, PicturePart};
pub use layout::RecordLayout;
pub use parts::{PARTS, PartFaults, PartFiles};
pub use record::TileRecord;
pub use store::{Checkpoint, CheckpointFailure, TileSource};
