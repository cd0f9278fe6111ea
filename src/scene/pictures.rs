//! The pictures that materials name.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::primitive::MaterialId;
use crate::color::Transfer;
use crate::config::{Config, Geometry, GeometryFile};
use crate::import::{PictureFile, read_picture};
use crate::material::{ImageTexture, Material};
use crate::yaml::{Fault, FieldPath};

/// The pictures of a config, each of which was read once.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Pictures(HashMap<PictureSource, PictureFile>);

/// What makes a picture: a file, and what its numbers are taken for.
type PictureSource = (PathBuf, Option<Transfer>);

impl Pictures {
    /// Reads the pictures of all materials; `folder` and `available` are those of
    /// [`Geometries::read`](super::Geometries::read).
    pub(super) fn read(config: &Config, folder: &Path, available: u64) -> Result<Self, Fault> {
        let mut found = Self::default();
        for (name, material) in &config.materials {
            for (keys, image) in material.images() {
                if found.0.contains_key(&source(image)) {
                    continue;
                }
                let available = available.saturating_sub(found.n_bytes());
                let picture = read_picture(&folder.join(&image.file), image.transfer, available);
                let picture = picture.map_err(|fault| {
                    let path = FieldPath::default().key("materials").key(name);
                    let path = keys.iter().fold(path, |path, key| path.key(*key));
                    fault.at_value(&path.key("file"))
                })?;
                found.0.insert(source(image), picture);
            }
        }
        Ok(found)
    }

    /// Gives a material its pictures.
    pub(super) fn give_to(&self, material: &mut Material) {
        for image in material.images_mut() {
            if let Some(found) = self.0.get(&source(image)) {
                image.picture = Arc::clone(&found.picture);
            }
        }
    }

    /// Their memory in bytes.
    pub(super) fn n_bytes(&self) -> u64 {
        self.0.values().map(|found| found.picture.n_bytes()).sum()
    }
}

/// Whether one of the materials of an object needs texture coordinates.
///
/// # Errors
/// One does, but not all of the object has them.
pub(super) fn needs_uvs(
    config: &Config,
    object: usize,
    materials: &[MaterialId],
    has_uvs: bool,
) -> Result<bool, Fault> {
    let materials = materials.iter();
    let mut named = materials.filter_map(|id| config.materials.get_index(id.0 as usize));
    let Some((name, _)) = named.find(|(_, material)| material.needs_uvs()) else {
        return Ok(false);
    };
    if has_uvs {
        return Ok(true);
    }
    let which = match &config.objects[object].geometry {
        Geometry::File(GeometryFile::Mesh(_)) => "which not all faces of this mesh have".to_owned(),
        other => format!("which a {other} has not"),
    };
    let path = FieldPath::default().key("objects").index(object);
    let message = format!("the picture of material `{name}` needs texture coordinates, {which}");
    let expected = "expected a mesh with texture coordinates";
    Err(Fault::new(path.key("material"), message, expected)
        .with_help("give the picture a `mapping`: `planar`, `spherical` or `triplanar`"))
}

fn source(image: &ImageTexture) -> PictureSource {
    (image.file.clone(), image.transfer)
}
