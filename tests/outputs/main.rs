//! What is written, and what reads it: VTK, ParaView, a browser, raycost itself.

#[path = "../common/mod.rs"]
mod common;

mod charged_files;
mod hostile;
mod interrupted;
mod output_folder;
mod paraview_rays;
mod paraview_states;
mod paraview_window;
mod results;
mod view;
mod vtk_files;
mod vtk_rays;
