//! The files that raycost writes, and their readers: VTK, ParaView, a browser, raycost.

#[path = "../common/mod.rs"]
mod common;

mod attribution_files;
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
