//! Collects the doc comments that `raycost schema` shows.

#[path = "build/doc_comments.rs"]
mod doc_comments;

use std::env;
use std::fs;
use std::path::Path;

/// The folders whose doc comments describe the keys of scene and study files.
const DOCUMENTED: [&str; 13] = [
    "../math/sampling",
    "../vtk/codec",
    "../scene/animation",
    "../scene/background",
    "../scene/camera",
    "../scene/color",
    "../scene/config",
    "../scene/fog",
    "../scene/geometry",
    "../scene/light",
    "../scene/material",
    "../scene/material/image",
    "study",
];

fn main() {
    let out = env::var("OUT_DIR").expect("cargo sets it");
    let comments = doc_comments::collect(&DOCUMENTED.map(Path::new));
    fs::write(Path::new(&out).join("doc_comments.tsv"), comments).expect("a file in OUT_DIR");
    for folder in DOCUMENTED {
        println!("cargo::rerun-if-changed={folder}");
    }
}
