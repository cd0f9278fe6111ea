//! The fingerprint of a frame: equal where its files would be.

use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use crate::background::Background;
use crate::config::{Config, Geometry};
use crate::import;
use crate::provenance::{Checksum, Hasher};
use crate::scene::SceneFrame;
use crate::summary::{Build, FrameSection};
use crate::yaml::{Document, FieldPath, Folders};

/// The section of a frame in its summary. `flags` are those that change its files, besides
/// those that change the config.
pub(super) fn section_of(
    document: &Document,
    config: &Config,
    frame: SceneFrame,
    flags: &str,
) -> FrameSection {
    let SceneFrame {
        number,
        n_frames,
        time,
    } = frame;
    let Build {
        version, commit, ..
    } = Build::current();
    let settings: Vec<&str> = document.settings().collect();
    let scene = (document.name(), settings, config);
    let program = (version, commit, flags);
    let mut hasher = Hasher::new();
    hasher.add(format!("{program:?}{scene:?}{:?}", (number, time)).as_bytes());
    let files = picture_files(document, config).into_iter();
    for file in files.chain(geometry_files(document, config)) {
        hasher.add(format!("{:?}", state_of(&file)).as_bytes());
    }
    FrameSection {
        number,
        n_frames,
        time,
        fingerprint: hasher.checksum(),
        states: serde_json::Value::Null,
    }
}

/// The path of a file, its length, and when it was changed.
fn state_of(file: &Path) -> (&Path, u64, u128) {
    let Ok(metadata) = file.metadata() else {
        return (file, 0, 0);
    };
    let changed = metadata.modified().ok();
    let since = changed.and_then(|changed| changed.duration_since(UNIX_EPOCH).ok());
    (file, metadata.len(), since.unwrap_or_default().as_nanos())
}

/// A hash of all that determines the primitives of the scene and the acceleration structure
/// over them.
pub(super) fn of_geometry(document: &Document, config: &Config) -> Checksum {
    let materials: Vec<&String> = config.materials.keys().collect();
    let mut hasher = Hasher::new();
    hasher.add(format!("{:?}", (&config.objects, materials, config.acceleration)).as_bytes());
    for file in geometry_files(document, config) {
        hasher.add(format!("{:?}", state_of(&file)).as_bytes());
    }
    hasher.checksum()
}

/// The files of pictures that the config names.
fn picture_files(document: &Document, config: &Config) -> Vec<PathBuf> {
    let root = FieldPath::default;
    let mut found = Vec::new();
    for (name, material) in &config.materials {
        let folder = document.folder_of(&root().key("materials").key(name));
        found.extend(material.images().map(|(_, image)| folder.join(&image.file)));
    }
    if let Background::EnvironmentMap(map) = &config.background {
        let folder = document.folder_of(&root().key("background"));
        found.push(folder.join(&map.file));
    }
    found
}

/// The files of objects that the config names, with the pieces of data sets.
fn geometry_files(document: &Document, config: &Config) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for (index, object) in config.objects.iter().enumerate() {
        if let Geometry::File(file) = &object.geometry {
            let path = FieldPath::default().key("objects").index(index);
            let path = path.key(file.to_string()).key("file");
            let file = document.folder_of(&path).join(file.file());
            found.extend(import::pieces_of(&file));
            found.push(file);
        }
    }
    found
}
