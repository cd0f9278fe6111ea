//! A world and a view → a film, tile by tile on all threads.
//!
//! In: a scene, its hierarchy, the image and a meter. Out: a [`Film`](film::Film), the pixels and
//! the cost of each; a [`Schedule`](schedule::Schedule), the thread and the time span of each tile;
//! and the cost of objects and nodes.
//!
//! Read [`schedule`] and [`film`], the input and the output of a rendering; then [`tiles`], the
//! loop. [`checkpoint`] keeps finished tiles, [`ranks`] shares them among processes,
//! [`attribution`] observes the rays once more, [`lanes`] puts them in the lanes of warps,
//! [`instruments`] watch the process.

pub mod schedule;
pub mod film;
pub mod checkpoint;
pub mod ranks;
pub mod tiles;
pub mod attribution;
pub mod lanes;
pub mod instruments;
