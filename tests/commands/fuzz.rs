//! The fuzz targets' seeds, and what the fuzzer found, through the same code: what
//! was mended stays so without a fuzzer.

#[path = "../../fuzz/src/targets.rs"]
mod targets;

use std::fs;

use crate::common::in_repository;

/// Runs a target on all of its kept inputs.
fn replay(name: &str, target: fn(&[u8])) {
    let mut n = 0;
    for kind in ["seeds", "found"] {
        let folder = in_repository(&format!("fuzz/{kind}/{name}"));
        let Ok(entries) = fs::read_dir(folder) else {
            continue;
        };
        for entry in entries {
            let path = entry.unwrap().path();
            println!("{}", path.display());
            target(&fs::read(&path).unwrap());
            n += 1;
        }
    }
    assert!(n > 0, "no input for {name}");
}

#[test]
fn scenes() {
    replay("scene", targets::scene);
}

#[test]
fn meshes_and_tables() {
    replay("geometry", targets::geometry);
}

#[test]
fn vtk_files() {
    replay("vtk", targets::vtk);
}

#[test]
fn outputs() {
    replay("output", targets::output);
}

#[test]
fn studies() {
    replay("study", targets::study);
}
