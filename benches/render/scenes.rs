//! Command line → scene files.

use std::fs;
use std::path::{Path, PathBuf};

/// Returns the scene files of a command line, the files of each folder sorted by name; the folder
/// `configs` where none is named.
///
/// # Errors
/// A message, if a path does not exist or a folder has no scene.
pub fn named(mut paths: Vec<PathBuf>) -> Result<Vec<PathBuf>, String> {
    if paths.is_empty() {
        paths.push(Path::new(env!("CARGO_MANIFEST_DIR")).join("configs"));
    }
    let scenes = paths.into_iter().map(|path| {
        if path.is_dir() {
            in_folder(&path)
        } else if path.is_file() {
            Ok(vec![path])
        } else {
            Err(format!("there is no scene `{}`", path.display()))
        }
    });
    Ok(scenes.collect::<Result<Vec<_>, _>>()?.concat())
}

/// Returns the YAML files directly in a folder; other files are ignored.
fn in_folder(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let named = folder.display();
    let failed = |error| format!("cannot read `{named}`: {error}");
    let mut scenes = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension() == Some("yaml".as_ref()) && path.is_file() {
            scenes.push(path);
        }
    }
    if scenes.is_empty() {
        return Err(format!("`{named}` has no scene: scenes end in `.yaml`"));
    }
    scenes.sort();
    Ok(scenes)
}
