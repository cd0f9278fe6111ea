//! The pictures of materials and the background.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::config::{Config, at_value};
use crate::yaml::{Fault, FieldPath, Folders};
use import::read_picture;
use world::background::Background;
use world::color::Transfer;
use world::material::Material;
use world::picture::Picture;
use world::scene::EnvironmentLight;

/// The pictures of a config, each read once.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Pictures {
    read: HashMap<PictureSource, Arc<Picture>>,
    /// Pictures of each material, by the material's name.
    of_materials: HashMap<String, Vec<PictureSource>>,
    of_background: Option<PictureSource>,
}

/// The source of a picture: a file, and the transfer function of its numbers.
type PictureSource = (PathBuf, Option<Transfer>);

impl Pictures {
    /// Reads all pictures; for `folders` and `available` see
    /// [`Geometries::read`](super::Geometries::read).
    pub(super) fn read<F: Folders + ?Sized>(
        config: &Config,
        folders: &F,
        available: u64,
    ) -> Result<Self, Fault> {
        let mut found = Self::default();
        for (name, material) in &config.materials {
            for (keys, image) in material.images() {
                let path = FieldPath::default().key("materials").key(name);
                let path = keys
                    .iter()
                    .fold(path, |path, key| path.key(*key))
                    .key("file");
                let source = found.add(&image.file, image.transfer, &path, folders, available)?;
                let of_material = found.of_materials.entry(name.clone()).or_default();
                of_material.push(source);
            }
        }
        if let Background::EnvironmentMap(map) = &config.background {
            let path = FieldPath::default().key("background");
            let path = path.key("environment_map").key("file");
            found.of_background =
                Some(found.add(&map.file, map.transfer, &path, folders, available)?);
        }
        Ok(found)
    }

    /// Reads the picture that the value at a path names, unless it was read before.
    fn add<F: Folders + ?Sized>(
        &mut self,
        file: &Path,
        transfer: Option<Transfer>,
        path: &FieldPath,
        folders: &F,
        available: u64,
    ) -> Result<PictureSource, Fault> {
        let source = (folders.folder_of(path).join(file), transfer);
        if !self.read.contains_key(&source) {
            let available = available.saturating_sub(self.n_bytes());
            let picture = read_picture(&source.0, transfer, available);
            let picture = picture.map_err(at_value(path))?;
            self.read.insert(source.clone(), picture);
        }
        Ok(source)
    }

    /// Returns the background with its picture.
    pub(super) fn background(&self, config: &Config) -> Background {
        let mut background = config.background.clone();
        match (&mut background, &self.of_background) {
            (Background::EnvironmentMap(map), Some(source)) => {
                map.picture = Arc::clone(&self.read[source]);
            }
            (Background::Sky(sky), _) => sky.draw(),
            _ => {}
        }
        background
    }

    /// Gives the material of this name its pictures.
    pub(super) fn give_to(&self, name: &str, material: &mut Material) {
        let sources = self.of_materials.get(name).into_iter().flatten();
        for (image, source) in material.images_mut().zip(sources) {
            image.picture = Arc::clone(&self.read[source]);
        }
    }

    /// Returns the memory in bytes, including the light of the background.
    pub(super) fn n_bytes(&self) -> u64 {
        let of_pictures: u64 = self.read.values().map(|picture| picture.n_bytes()).sum();
        let background = self.of_background.as_ref();
        let of_light = background.map_or(0, |source| EnvironmentLight::n_bytes(&self.read[source]));
        of_pictures + of_light
    }
}
