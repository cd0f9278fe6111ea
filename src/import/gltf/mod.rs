//! glTF 2.0: the triangles of its default scene, placed by its nodes, their materials
//! and its lights.
//!
//! gltf-json parses the JSON and checks its indices. The crate gltf, which builds on it to read
//! numbers and binary files, panics on some damaged files and does not bound memory.

mod buffers;
mod container;
mod accessor;
mod attributes;
mod lights;
mod nodes;
mod pose;
mod glossy;
mod materials;
mod flat_scene;

use glam::Vec3;

use super::budget::Budget;
use super::materials::PictureShelf;
use super::mesh::Mesh;
use super::{GeometryFileReader, Result, Surroundings, read_whole};
use accessor::Accessors;
use base::numbers::counted;
use buffers::Buffers;
use container::unread_extensions;
use flat_scene::FlatScene;
use materials::Materials;
use nodes::PlacedNodes;

pub(super) fn read(file: GeometryFileReader, around: &Surroundings) -> Result<Mesh> {
    let mut budget = Budget::new();
    let bytes = read_whole(file, &mut budget)?;
    let (root, binary) = container::parse(&bytes, &mut budget)?;
    let buffers = Buffers::read(&root, binary, around.folder, &mut budget);
    let accessors = Accessors {
        root: &root,
        buffers: &buffers,
    };
    let mut scene = FlatScene::new(accessors);
    let PlacedNodes {
        meshes,
        names,
        lights,
        n_limited,
    } = nodes::placed_nodes(accessors, &mut budget)?;
    scene.take_memory(&meshes, &mut budget)?;
    for placed in &meshes {
        scene.add(placed, &mut budget)?;
    }
    let mut mesh = scene.finish();
    let node_of = std::mem::take(&mut mesh.node_of);
    mesh.notes.extend(unread_extensions(&root));
    mesh.notes.extend(unread_animations(root.animations.len()));
    match around.memory {
        None => {
            mesh.material_of.clear();
            mesh.opacities = None;
        }
        Some(available) => {
            let mut reader = Materials {
                root: &root,
                buffers: &buffers,
                folder: around.folder,
                budget: &mut budget,
                shelf: PictureShelf::new(available),
            };
            mesh.materials = reader.read()?;
            mesh.notes.extend(reader.shelf.notes);
            mesh.take_nodes(names.into_iter(), node_of);
            mesh.lights = lights;
            mesh.notes.extend(limited_lights(n_limited));
            mark_colored(&mut mesh);
            let are_opaque = mesh.opacities.is_none();
            for material in &mut mesh.materials {
                material.opacity.take_if(|of| are_opaque && of.is_full());
            }
        }
    }
    Ok(mesh)
}

/// Returns the sentence about animations.
fn unread_animations(n: usize) -> Option<String> {
    let sentence = format!("{} left out: shown at rest", counted(n as u64, "animation"));
    (n > 0).then_some(sentence)
}

/// Returns the sentence about lights that end at a distance.
fn limited_lights(n: usize) -> Option<String> {
    let lights = counted(n as u64, "light");
    let sentence = format!("the `range` of {lights} is ignored: light weakens with the distance");
    (n > 0).then_some(sentence)
}

/// Marks the materials of triangles whose vertices have colors.
fn mark_colored(mesh: &mut Mesh) {
    let Some(colors) = &mesh.colors else {
        return;
    };
    for (triangle, material) in mesh.material_of.iter().enumerate() {
        if colors.at(triangle) != [Vec3::ONE; 3]
            && let Some(material) = mesh.materials.get_mut(*material as usize)
        {
            material.has_vertex_colors = true;
        }
    }
}
