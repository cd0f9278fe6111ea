//! Traversal of the hierarchy by rays, nearest children first.
//!
//! Three traversals make the same visits and tests and give the same answers: one ray at a time
//! ([`SingleTraversal`]), so that each ray can be timed; sixteen coherent rays as a packet
//! ([`PacketTraversal`]), which share the work; many rays in flight ([`StreamTraversal`]), which
//! hide each other's latencies. In a [`Batch`] of rays, packets take the coherent rays and the
//! stream takes the others.
//!
//! All are generic functions, compiled once for each instruction set, search and probe. They do not
//! recurse and, except for one list of rays per batch, do not allocate.

mod slab;
mod leaf;
mod stack;
mod children;
mod block;
mod batch;
mod single;
mod packet;
mod stream;

pub(super) use batch::Batch;
pub(super) use packet::PacketTraversal;
pub(super) use single::SingleTraversal;
pub use slab::SlabSetup;
pub(super) use slab::Slabs;
pub use stream::RAYS_IN_FLIGHT;
pub(super) use stream::StreamTraversal;
