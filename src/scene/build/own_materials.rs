//! Splits meshes with their own materials into one object per material and node of the file.
//!
//! Reports then name them as the file does, and a material belongs to an object, so that no ray
//! pays for a lookup per triangle.

use std::collections::HashMap;
use std::path::Path;

use super::mesh_material::{MaterialDetail, material_of_mesh};
use crate::config::{Config, Geometry, MaterialNames, Object};
use import::{Mesh, MeshPart};
use world::shading::ShadingModel;

/// Maximum number of characters of a file's or material's name in the name of a part.
const MAX_WORD: usize = 100;

/// The names of materials and objects, with those that meshes have added to a config.
#[derive(Debug)]
pub(super) struct Names {
    materials: UniqueNames,
    objects: UniqueNames,
}

/// Names, and how many numbers were tried for each.
#[derive(Debug)]
struct UniqueNames(HashMap<String, usize>);

/// Returns the objects of the parts of a mesh, and adds their materials to the config.
pub(super) fn parts(
    config: &mut Config,
    names: &mut Names,
    object: Object,
    mut mesh: Mesh,
) -> Vec<(Object, Mesh)> {
    let file = file_word(&object.geometry);
    let detail = match config.shading.model {
        ShadingModel::Seed => MaterialDetail::Surface,
        ShadingModel::Path => MaterialDetail::Facets,
        _ => MaterialDetail::Light,
    };
    if matches!(object.geometry, Geometry::Instances(_)) {
        // Each part is placed as often as the mesh.
        (mesh.nodes, mesh.node_of) = Default::default();
    }
    let (materials, parts) = mesh.into_parts();
    let is_whole = parts.len() == 1;
    let mut made_of = vec![None; materials.len()];
    let part = |MeshPart {
                    node,
                    material,
                    mesh,
                }: MeshPart| {
        let of_file = &materials[material];
        let material = made_of[material].get_or_insert_with(|| {
            let name = format!("{file}/{}", word(&of_file.name));
            let name = names.materials.next(&name);
            let made = material_of_mesh(of_file, detail);
            config.materials.insert(name.clone(), made);
            name
        });
        let of_part = word(node.as_ref().unwrap_or(&of_file.name));
        let name = match (&object.name, &node) {
            (Some(name), _) if is_whole => Some(name.clone()),
            (None, None) if is_whole => None,
            (None, None) => Some(material.clone()),
            (Some(name), _) => Some(names.objects.next(&format!("{}/{of_part}", word(name)))),
            (None, Some(_)) => Some(names.objects.next(&format!("{file}/{of_part}"))),
        };
        let part = Object {
            name,
            material: MaterialNames(vec![material.clone()]),
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

impl Names {
    /// Creates the names of a config.
    pub(super) fn new(config: &Config) -> Self {
        let objects = config.objects.iter().flat_map(|object| &object.name);
        Self {
            materials: UniqueNames::new(config.materials.keys()),
            objects: UniqueNames::new(objects),
        }
    }
}

impl UniqueNames {
    fn new<'a>(names: impl Iterator<Item = &'a String>) -> Self {
        Self(names.map(|name| (name.clone(), 1)).collect())
    }

    /// Returns a new name, beginning with this one.
    fn next(&mut self, name: &str) -> String {
        let mut n_tried = self.0.get(name).copied().unwrap_or(0);
        loop {
            n_tried += 1;
            let next = match n_tried {
                1 => name.to_owned(),
                number => format!("{name} {number}"),
            };
            if !self.0.contains_key(&next) {
                self.0.insert(name.to_owned(), n_tried);
                self.0.entry(next.clone()).or_insert(1);
                return next;
            }
        }
    }
}

/// Shortens a name to a part of a longer one.
fn word(name: &str) -> String {
    let plain = name.chars().filter(|letter| !letter.is_control());
    plain.take(MAX_WORD).collect()
}
