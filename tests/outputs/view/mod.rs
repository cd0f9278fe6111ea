//! `raycost view` writes a page that shows the values of a rendering.

mod browser;
mod page;

use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::common::{assert_success, in_repository, raycost};

/// Columns and rows of most renderings.
const SIZE: [u32; 2] = [40, 30];

/// Renders a scene of `configs/` into a new folder.
fn rendered(scene: &str, flags: &[&str]) -> TempDir {
    rendered_at(SIZE, scene, flags)
}

fn rendered_at(size: [u32; 2], scene: &str, flags: &[&str]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let size = size.map(|n| n.to_string());
    let sized = ["--quiet", "--width", &size[0], "--height", &size[1]];
    render(
        &in_repository(&format!("configs/{scene}.yaml")),
        folder.path(),
        &[&sized, flags].concat(),
    );
    folder
}

fn render(scene: &Path, folder: &Path, flags: &[&str]) {
    let mut command = raycost();
    command
        .arg("render")
        .arg(scene)
        .arg("--out")
        .arg(folder)
        .args(flags);
    assert_success(&command.output().unwrap());
}

/// Writes the page of an output folder and returns its path.
fn viewed(folder: &Path) -> PathBuf {
    assert_success(&raycost().arg("view").arg(folder).output().unwrap());
    folder.join("view.html")
}
