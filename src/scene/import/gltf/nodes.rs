//! The nodes of a glTF file's scene, placed in its space.

use glam::{DAffine3, DMat4, DQuat, DVec3, Quat, Vec3};
use gltf_json::scene::Node;
use gltf_json::{Index, Root, mesh};

use super::lights;
use crate::import::{FileFault, Result};
use crate::light::Light;

/// The meshes and the lights of a scene.
#[derive(Default)]
pub(super) struct PlacedNodes {
    pub(super) meshes: Vec<PlacedMesh>,
    pub(super) lights: Vec<Light>,
    /// The number of lights that end at a distance, which has no equivalent.
    pub(super) n_limited: usize,
}

/// A mesh at a node.
pub(super) struct PlacedMesh {
    pub(super) mesh: Index<mesh::Mesh>,
    pub(super) scene_from_mesh: DMat4,
}

/// Returns the meshes and the lights of the default scene, or else of the first one; in a file
/// without scenes, those below all root nodes.
///
/// # Errors
/// A node has two parents, a transform is not finite, or a light is out of range.
pub(super) fn placed_nodes(root: &Root) -> Result<PlacedNodes> {
    let scene = root.scene.and_then(|scene| root.get(scene));
    let mut open: Vec<(Index<Node>, DMat4)> = match scene.or(root.scenes.first()) {
        Some(scene) => scene
            .nodes
            .iter()
            .map(|node| (*node, DMat4::IDENTITY))
            .collect(),
        None => roots(root).map(|node| (node, DMat4::IDENTITY)).collect(),
    };
    // Reversed, because nodes are taken from the end.
    open.reverse();
    let mut is_known = vec![false; root.nodes.len()];
    let mut found = PlacedNodes::default();
    while let Some((index, parent)) = open.pop() {
        let Some(node) = root.get(index) else {
            continue;
        };
        if std::mem::replace(&mut is_known[index.value()], true) {
            let problem = format!("`nodes[{}]` is a child of two nodes", index.value());
            return Err(FileFault::new(problem, "a tree of nodes"));
        }
        let placed = parent * transform(node);
        if !placed.as_mat4().is_finite() {
            let problem = format!("the transform of `nodes[{}]` is not finite", index.value());
            return Err(FileFault::new(problem, "finite numbers"));
        }
        if let Some(light) = lights::of_node(root, node)? {
            let placed = lights::placed(light, &DAffine3::from_mat4(placed));
            found.n_limited += usize::from(placed.is_some() && light.range.is_some());
            found.lights.extend(placed);
        }
        found.meshes.extend(node.mesh.map(|mesh| PlacedMesh {
            mesh,
            scene_from_mesh: placed,
        }));
        let children = node.children.iter().flatten().rev();
        open.extend(children.map(|child| (*child, placed)));
    }
    Ok(found)
}

/// Returns the nodes that are not children of another.
fn roots(root: &Root) -> impl Iterator<Item = Index<Node>> {
    let mut is_child = vec![false; root.nodes.len()];
    for child in root
        .nodes
        .iter()
        .flat_map(|node| node.children.iter().flatten())
    {
        is_child[child.value()] = true;
    }
    let numbered = (0..).zip(is_child);
    numbered
        .filter(|(_, is_child)| !is_child)
        .map(|(i, _)| Index::new(i))
}

fn transform(node: &Node) -> DMat4 {
    if let Some(matrix) = &node.matrix {
        return DMat4::from_cols_array(&matrix.map(f64::from));
    }
    let rotation = node
        .rotation
        .map_or(DQuat::IDENTITY, |of| Quat::from_array(of.0).as_dquat());
    let rotation = if rotation.length_squared() > 0.0 {
        rotation.normalize()
    } else {
        DQuat::IDENTITY
    };
    let vector = |numbers| Vec3::from(numbers).as_dvec3();
    let scale = node.scale.map_or(DVec3::ONE, vector);
    let translation = node.translation.map_or(DVec3::ZERO, vector);
    DMat4::from_scale_rotation_translation(scale, rotation, translation)
}
