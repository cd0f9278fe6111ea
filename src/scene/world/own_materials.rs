//! Splits meshes with their own materials into one object per material.
//!
//! Reports then name them as the file does, and a material belongs to an object, so that no ray
//! pays for a lookup per triangle.

use std::collections::HashMap;
use std::path::Path;

use crate::config::{Config, Geometry, MaterialNames, Object, ShadingModel};
use crate::import::{Mesh, MeshMaterial};
use crate::material::{Material, MaterialDetail};

/// Maximum number of characters of a file's or material's name in the name of a part.
const MAX_WORD: usize = 100;

/// Numbers of the names of materials that meshes have added to a config: how many were tried for
/// each beginning.
#[derive(Debug, Default)]
pub(super) struct NewNames(HashMap<String, usize>);

/// Returns the objects of the materials of a mesh, and adds the materials to the config.
pub(super) fn parts(
    config: &mut Config,
    names: &mut NewNames,
    object: Object,
    mesh: Mesh,
) -> Vec<(Object, Mesh)> {
    let file = file_word(&object.geometry);
    let detail = match config.shading.model {
        ShadingModel::Seed => MaterialDetail::Surface,
        ShadingModel::Path => MaterialDetail::Facets,
        _ => MaterialDetail::Light,
    };
    let parts = mesh.into_parts();
    let is_whole = parts.len() == 1;
    let part = |(of_file, mesh): (MeshMaterial, Mesh)| {
        let of_part = word(&of_file.name);
        let material = names.next(config, &format!("{file}/{of_part}"));
        let made = Material::of_mesh(&of_file, detail);
        config.materials.insert(material.clone(), made);
        let name = match &object.name {
            name if is_whole => name.clone(),
            Some(name) => Some(format!("{}/{of_part}", word(name))),
            None => Some(material.clone()),
        };
        let part = Object {
            name,
            material: MaterialNames(vec![material]),
            ..object.clone()
        };
        (part, mesh)
    };
    parts.into_iter().map(part).collect()
}

/// Returns the name of the file of a mesh, for reports.
pub(super) fn file_word(geometry: &Geometry) -> String {
    let file = match geometry {
        Geometry::File(file) => file.file().file_name().unwrap_or_default(),
        Geometry::Instances(instances) => instances.mesh.file.file_name().unwrap_or_default(),
        _ => Path::new("").as_os_str(),
    };
    word(&file.to_string_lossy())
}

impl NewNames {
    /// Returns a name that no material has, beginning with this one.
    fn next(&mut self, config: &Config, name: &str) -> String {
        let n_tried = self.0.entry(name.to_owned()).or_default();
        loop {
            *n_tried += 1;
            let name = match *n_tried {
                1 => name.to_owned(),
                number => format!("{name} {number}"),
            };
            if !config.materials.contains_key(&name) {
                return name;
            }
        }
    }
}

/// Shortens a name to a part of a longer one.
fn word(name: &str) -> String {
    let plain = name.chars().filter(|letter| !letter.is_control());
    plain.take(MAX_WORD).collect()
}
