//! The other files that a geometry file refers to.

use std::path::{Path, PathBuf};

use super::materials::path_in;
use super::{extension, is_vtk};
use base::files;
use base::host::available_memory;

/// Returns the files of pieces, materials and pictures that a geometry file refers to, and any
/// other existing files that its text happens to name; none for formats without references.
pub fn pieces_of(path: &Path) -> Vec<PathBuf> {
    let extension = extension(path);
    match extension.as_str() {
        "obj" => {
            let libraries = named_by(path, "mtllib");
            let pictures = libraries
                .iter()
                .flat_map(|library| named_by(library, "map_"));
            pictures
                .collect::<Vec<_>>()
                .into_iter()
                .chain(libraries)
                .collect()
        }
        "vtm" | "gltf" | "glb" => quoted(path),
        _ if is_vtk(path) && extension.starts_with('p') => quoted(path),
        _ => Vec::new(),
    }
}

/// Returns the files whose names appear in quotes.
fn quoted(path: &Path) -> Vec<PathBuf> {
    let text = text_of(path);
    files_beside(path, text.split('"').skip(1).step_by(2))
}

/// Returns the files named at the ends of statements that begin like this.
fn named_by(path: &Path, beginning: &str) -> Vec<PathBuf> {
    let text = text_of(path);
    let lines = text.lines().map(str::trim);
    let names = lines.filter(|line| line.starts_with(beginning));
    files_beside(
        path,
        names.filter_map(|line| line.split_whitespace().next_back()),
    )
}

fn text_of(path: &Path) -> String {
    let bytes = files::read(path, available_memory()).unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Returns the names that are files next to `path`.
fn files_beside<'a>(path: &Path, names: impl Iterator<Item = &'a str>) -> Vec<PathBuf> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let files = names.map(|name| path_in(folder, name));
    files.filter(|file| file.is_file()).collect()
}
