//! A world and a view -> a film, tile by tile on all threads.

pub mod schedule;
pub mod film;
pub mod checkpoint;
pub mod ranks;
pub mod tiles;
pub mod attribution;
pub mod instruments;
