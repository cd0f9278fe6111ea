//! A film → pictures, VTK files, ParaView states and a summary; and the readers of these.
//!
//! In: a finished rendering, as a [`RenderingView`](writers::RenderingView). Out: a folder with all
//! of its files, or none.
//!
//! Read [`writers`] first: one file per output file, and the list of all. They use [`chart`],
//! [`paraview`] and [`summary`]. [`results`] reads a folder back. [`memory`] and [`prediction`]
//! estimate the resources of a rendering beforehand.

pub mod chart;
pub mod paraview;
pub mod summary;
pub mod writers;
pub mod memory;
pub mod prediction;
pub mod results;
