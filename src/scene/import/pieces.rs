//! The other files that a geometry file names.

use std::path::{Path, PathBuf};

use super::materials::path_in;
use super::{extension, is_vtk};
use base::files;
use base::host::available_memory;

/// The files of pieces, of materials and of pictures that a geometry file names, and others
/// that its texts happen to name; none for a file that names no others.
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

/// The files whose names a file has in quotes.
fn quoted(path: &Path) -> Vec<PathBuf> {
    let text = text_of(path);
    files_beside(path, text.split('"').skip(1).step_by(2))
}

/// The files that a file names at the ends of statements with this beginning.
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

/// The names that are files.
fn files_beside<'a>(path: &Path, names: impl Iterator<Item = &'a str>) -> Vec<PathBuf> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let files = names.map(|name| path_in(folder, name));
    files.filter(|file| file.is_file()).collect()
}
