//! The other files that a geometry file refers to.

use std::io::Read;
use std::path::{Path, PathBuf};

use super::materials::path_in;
use super::{extension, is_vtk};
use host::available_memory;
use host::files;

/// Maximum length of the header of a PLY file that is searched for names, in bytes.
const MAX_HEADER: u64 = 1 << 16;

/// Returns the files of pieces, materials and pictures that a geometry file refers to, and any
/// other existing files that its text happens to name; none for formats without references.
pub fn pieces_of(path: &Path) -> Vec<PathBuf> {
    let extension = extension(path);
    match extension.as_str() {
        "obj" => {
            let libraries = named_by(path, "mtllib", available_memory());
            let pictures = libraries
                .iter()
                .flat_map(|library| named_by(library, "map_", available_memory()));
            pictures
                .collect::<Vec<_>>()
                .into_iter()
                .chain(libraries)
                .collect()
        }
        "ply" => named_by(path, "comment TextureFile", MAX_HEADER),
        "vtm" | "gltf" | "glb" => quoted(path),
        _ if is_vtk(path) && extension.starts_with('p') => quoted(path),
        _ => Vec::new(),
    }
}

/// Returns the files whose names appear in quotes.
fn quoted(path: &Path) -> Vec<PathBuf> {
    let text = text_of(path, available_memory());
    files_beside(path, text.split('"').skip(1).step_by(2))
}

/// Returns the files named by statements that begin like this: by their last word, or by all words
/// after the first one.
fn named_by(path: &Path, beginning: &str, max_bytes: u64) -> Vec<PathBuf> {
    let text = text_of(path, max_bytes);
    let ends = text
        .lines()
        .filter_map(|line| line.trim().strip_prefix(beginning));
    let names = ends.flat_map(|end| {
        let (_, whole) = end.split_once(char::is_whitespace).unwrap_or_default();
        let last = end.split_whitespace().next_back();
        last.into_iter()
            .chain(Some(whole.trim()).filter(|whole| last != Some(whole)))
    });
    files_beside(path, names)
}

/// Returns the text at the beginning of a file.
fn text_of(path: &Path, max_bytes: u64) -> String {
    let mut bytes = Vec::new();
    let read = files::open(path).and_then(|file| file.take(max_bytes).read_to_end(&mut bytes));
    read.map_or(String::new(), |_| {
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// Returns the names that are files next to `path`.
fn files_beside<'a>(path: &Path, names: impl Iterator<Item = &'a str>) -> Vec<PathBuf> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let files = names.map(|name| path_in(folder, name));
    files.filter(|file| file.is_file()).collect()
}
