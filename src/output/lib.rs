//! A film → pictures, VTK files, ParaView states and the summary; and these read again.
//!
//! In: a finished rendering, as a [`RenderingView`](writers::RenderingView). Out: a folder with
//! all of its files, or none.
//!
//! Read [`writers`], a file each for every file of an output and the list of all; they use
//! [`chart`], [`paraview`] and [`summary`]. [`results`] reads a folder back. [`memory`] and
//! [`prediction`] say before a rendering what it will take.

pub mod chart;
pub mod paraview;
pub mod summary;
pub mod writers;
pub mod memory;
pub mod prediction;
pub mod results;
