//! A film → pictures, VTK files, ParaView states and a summary; and the readers of these.
//!
//! In: a finished rendering, as a [`RenderingView`](writers::RenderingView). Out: a folder with all
//! of its files, or none.
//!
//! Read [`writers`] first: one file per output file, and the list of all. They use [`chart`],
//! [`paraview`] and [`summary`]. [`results`] reads a folder back. [`estimate`] and [`prediction`]
//! estimate the resources of a rendering beforehand; [`limits`] refuses what may not fit.

pub mod chart;
pub mod paraview;
pub mod summary;
pub mod writers;
pub mod estimate;
pub mod limits;
mod sample;
pub mod look;
pub mod prediction;
pub mod results;
