//! A film -> pictures, VTK files, ParaView states and the summary.

pub mod chart;
pub mod paraview;
pub mod summary;
pub mod writers;
pub mod memory;
pub mod prediction;
pub mod results;
