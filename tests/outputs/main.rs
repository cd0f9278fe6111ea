//! The files that raycost writes, and their readers: VTK, ParaView, a browser, raycost.

#[path = "../common/mod.rs"]
mod common;

/// Two tests of each case: `check` compares what this crate's tests and what VTK reads.
macro_rules! read_both_ways {
    ($($name:ident: $case:expr;)*) => {$(
        mod $name {
            use super::*;

            #[test]
            fn as_the_format_says() {
                check(&$case, DataSet::read);
            }

            #[test]
            #[ignore = "needs PyPI's vtk: run tests/with-paraview"]
            fn by_vtk() {
                check(&$case, DataSet::read_with_vtk);
            }
        }
    )*};
}

mod arrays;
mod attribution_files;
mod bands;
mod hostile;
mod interrupted;
mod irregular;
mod jobs;
mod lanes;
mod layers;
mod only_picture;
mod output_folder;
mod paraview_export;
mod paraview_rays;
mod paraview_states;
mod paraview_window;
mod parts;
mod picture;
mod pyvista;
mod results;
mod resume;
mod scene_metrics;
mod series;
mod strangers;
mod view;
mod vtk_files;
mod vtk_rays;
mod website;
