//! What benchmarks take from their command lines.

#[path = "../../benches/render/scenes.rs"]
mod scenes;

use std::fs;
use std::path::PathBuf;

use crate::common::in_repository;

fn named(arguments: &[&str]) -> Result<Vec<PathBuf>, String> {
    scenes::named(arguments.iter().map(PathBuf::from).collect())
}

#[test]
fn render_races_the_scenes_of_a_folder_and_nothing_else_in_it() {
    // `configs` has folders of meshes, tables and studies beside its scenes.
    let scenes = named(&[]).unwrap();
    assert!(scenes.contains(&in_repository("configs/seed_sphere.yaml")));
    assert!(scenes.iter().all(|path| path.is_file()), "{scenes:?}");
    assert!(scenes.is_sorted());

    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("folder.yaml")).unwrap();
    let path = folder.path().to_str().unwrap();
    assert!(named(&[path]).unwrap_err().contains("has no scene"));
    for name in ["b.yaml", "a.yaml", "mesh.obj"] {
        fs::write(folder.path().join(name), "").unwrap();
    }
    let expected = ["a.yaml", "b.yaml"].map(|name| folder.path().join(name));
    assert_eq!(named(&[path]).unwrap(), expected);
}

#[test]
fn render_names_the_scene_that_is_missing() {
    let message = named(&["nowhere.yaml"]).unwrap_err();
    assert_eq!(message, "there is no scene `nowhere.yaml`");
}
