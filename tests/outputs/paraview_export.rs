//! What VTK and ParaView show becomes a scene whose picture is the same.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::paraview::{folder, on_virtual_screen};
use crate::common::{assert_success, in_repository, raycost};

/// Runs a case of `tests/vtk/export.py`.
fn export(case: &str) {
    let python = std::env::var("RAYCOST_PYTHON").expect("run tests/with-paraview");
    let out = folder("export").join(case);
    let _ = fs::remove_dir_all(&out);
    let output = Command::new(python)
        .arg(in_repository("tests/vtk/export.py"))
        .arg(case)
        .arg(out)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("RAYCOST", raycost().get_program())
        .output();
    assert_success(&output.unwrap());
}

macro_rules! cases {
    ($($name:ident)*) => {$(
        #[test]
        #[ignore = "needs PyVista: run tests/with-paraview"]
        fn $name() {
            export(stringify!($name));
        }
    )*};
}

cases! {
    flat_colors
    lit
    points_with_radii
    lines_as_tubes
    transforms_and_cameras
    surfaces
    textures
    directions_of_light
    what_cannot_be_shown
    names
    nothing
    files_of_others
    no_program
}

/// The lines of the book make a scene and show its cost.
#[test]
#[ignore = "needs PyVista: run tests/with-paraview"]
fn the_plot_of_the_book_becomes_a_scene() {
    let book = fs::read_to_string(in_repository("docs/paraview.md")).unwrap();
    let (_, block) = book.split_once("```python\n").unwrap();
    let (lines, _) = block.split_once("```").unwrap();
    let out = folder("export").join("book");
    let python = std::env::var("RAYCOST_PYTHON").expect("run tests/with-paraview");
    let output = on_virtual_screen()
        .args([&python, "-c"])
        .arg(lines.replace("out/pipe", out.to_str().unwrap()))
        .current_dir(in_repository(""))
        .env("PYTHONPATH", in_repository("paraview"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("PYVISTA_OFF_SCREEN", "true")
        .env("RAYCOST", raycost().get_program())
        .output();
    assert_success(&output.unwrap());
    assert!(out.join("out/image.png").exists());
}

fn in_paraview(script: &str, out: &Path) -> Output {
    on_virtual_screen()
        .arg("pvbatch")
        .arg(in_repository(script))
        .arg(out)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("RAYCOST", raycost().get_program())
        .output()
        .expect("run tests/with-paraview")
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn the_plugin_renders_the_active_view() {
    let out = folder("export").join("plugin ü & 'co'");
    let _ = fs::remove_dir_all(&out);
    assert_success(&in_paraview("tests/paraview/plugin.py", &out));
}
