//! The nodes of a glTF file's scene, placed in its space.

use std::rc::Rc;

use glam::{DAffine3, DMat4, DQuat, DVec3, Quat, Vec3};
use gltf_json::accessor::Accessor;
use gltf_json::scene::Node;
use gltf_json::skin::Skin;
use gltf_json::{Index, Root, mesh};
use serde_json::Value;

use super::accessor::Accessors;
use super::container::{INSTANCING, VISIBILITY};
use super::lights;
use crate::budget::Budget;
use crate::{FileFault, Result};
use world::light::Light;

/// The meshes and the lights of a scene.
#[derive(Default)]
pub(super) struct PlacedNodes<'a> {
    pub(super) meshes: Vec<PlacedMesh<'a>>,
    /// The names of the nodes with a mesh, or else of their meshes.
    pub(super) names: Vec<&'a str>,
    pub(super) lights: Vec<Light>,
    /// The number of lights that end at a distance, which has no equivalent.
    pub(super) n_limited: usize,
}

/// A mesh at a node.
pub(super) struct PlacedMesh<'a> {
    pub(super) mesh: Index<mesh::Mesh>,
    /// The number of its node's name, from 1; 0 without a name.
    pub(super) node: u32,
    pub(super) scene_from_mesh: DMat4,
    /// The weights of its morph targets.
    pub(super) weights: &'a [f32],
    /// The place of each joint in the scene, if its vertices follow joints.
    pub(super) scene_from_joints: Option<Rc<[DMat4]>>,
}

/// A node to be placed.
struct UnplacedNode {
    index: Index<Node>,
    /// The place of its parent.
    parent: DMat4,
    /// True if its parent is hidden.
    is_hidden: bool,
}

impl UnplacedNode {
    fn at_root(index: Index<Node>) -> Self {
        Self {
            index,
            parent: DMat4::IDENTITY,
            is_hidden: false,
        }
    }
}

/// Returns the meshes and the lights of the default scene, or else of the first one; in a file
/// without scenes, those below all root nodes.
///
/// # Errors
/// A node has two parents, a transform is not finite, a light is out of range, or a skin or the
/// places of instances are damaged.
pub(super) fn placed_nodes<'a>(
    accessors: Accessors<'a>,
    budget: &mut Budget,
) -> Result<PlacedNodes<'a>> {
    let root = accessors.root;
    let scene = root.scene.and_then(|scene| root.get(scene));
    let mut open: Vec<UnplacedNode> = match scene.or(root.scenes.first()) {
        Some(scene) => scene
            .nodes
            .iter()
            .map(|node| UnplacedNode::at_root(*node))
            .collect(),
        None => roots(root).map(UnplacedNode::at_root).collect(),
    };
    // Reversed, because nodes are taken from the end.
    open.reverse();
    let mut places = vec![None; root.nodes.len()];
    let mut found = PlacedNodes::default();
    let mut with_mesh = Vec::new();
    while let Some(UnplacedNode {
        index,
        parent,
        is_hidden,
    }) = open.pop()
    {
        let Some(node) = root.get(index) else {
            continue;
        };
        let placed = parent * transform(node);
        let visibility = extension(node, VISIBILITY);
        let is_hidden = is_hidden || visibility.is_some_and(|of| of["visible"] == false);
        if places[index.value()].replace(placed).is_some() {
            let problem = format!("`nodes[{}]` is a child of two nodes", index.value());
            return Err(FileFault::new(problem, "a tree of nodes"));
        }
        if !placed.as_mat4().is_finite() {
            let problem = format!("the transform of `nodes[{}]` is not finite", index.value());
            return Err(FileFault::new(problem, "finite numbers"));
        }
        let children = node.children.iter().flatten().rev();
        open.extend(children.map(|child| UnplacedNode {
            index: *child,
            parent: placed,
            is_hidden,
        }));
        if is_hidden {
            continue;
        }
        if let Some(light) = lights::of_node(root, node)? {
            let placed = lights::placed(light, &DAffine3::from_mat4(placed));
            found.n_limited += usize::from(placed.is_some() && light.range.is_some());
            found.lights.extend(placed);
        }
        with_mesh.push((node, placed));
    }
    // Skins need the places of all nodes.
    for (node, placed) in with_mesh {
        found.add_mesh(accessors, node, placed, &places, budget)?;
    }
    Ok(found)
}

impl<'a> PlacedNodes<'a> {
    /// Adds the mesh of a node, once for each of its instances. `places` are those of all nodes.
    ///
    /// # Errors
    /// A skin or the places of instances are damaged.
    fn add_mesh(
        &mut self,
        accessors: Accessors<'a>,
        node: &'a Node,
        placed: DMat4,
        places: &[Option<DMat4>],
        budget: &mut Budget,
    ) -> Result<()> {
        let root = accessors.root;
        let Some(mesh) = node.mesh else {
            return Ok(());
        };
        let of_mesh = root.get(mesh);
        let weights = node.weights.as_ref();
        let weights = weights.or_else(|| of_mesh?.weights.as_ref());
        let names = [&node.name].into_iter().chain(of_mesh.map(|of| &of.name));
        let name = names.flatten().find(|name| !name.is_empty());
        self.names.extend(name.map(String::as_str));
        let number = name.map_or(0, |_| self.names.len() as u32);
        let skin = node.skin.and_then(|skin| root.get(skin));
        let joints = skin.map(|skin| scene_from_joints(accessors, skin, places, budget));
        let joints = joints.transpose()?.map(Rc::from);
        for place in instances(accessors, node, budget)? {
            self.meshes.push(PlacedMesh {
                mesh,
                node: number,
                scene_from_mesh: placed * place,
                weights: weights.map_or(&[], Vec::as_slice),
                scene_from_joints: joints.clone(),
            });
        }
        Ok(())
    }
}

/// Returns the value of an extension of a node that gltf-json does not know.
fn extension<'a>(node: &'a Node, name: &str) -> Option<&'a Value> {
    node.extensions.as_ref()?.others.get(name)
}

/// Returns the places of the joints of a skin, each multiplied by its inverse bind matrix.
fn scene_from_joints(
    accessors: Accessors,
    skin: &Skin,
    places: &[Option<DMat4>],
    budget: &mut Budget,
) -> Result<Vec<DMat4>> {
    budget.take_of::<DMat4>(skin.joints.len())?;
    let bound = skin.inverse_bind_matrices;
    let bound = bound.map(|index| accessors.vectors::<16>(index, budget));
    let bound = bound.transpose()?;
    let place = |(i, joint): (usize, &Index<Node>)| {
        let place = places
            .get(joint.value())
            .copied()
            .flatten()
            .ok_or_else(|| {
                let problem = format!("the joint `nodes[{}]` is not in the scene", joint.value());
                FileFault::new(problem, "joints in the scene of their mesh")
            })?;
        let Some(bound) = &bound else {
            return Ok(place);
        };
        let inverse = bound.get(i).ok_or_else(|| {
            let problem = format!("a skin has {} inverse bind matrices", bound.len());
            FileFault::new(
                problem,
                format!("one for each of the {} joints", skin.joints.len()),
            )
        })?;
        Ok(place * DMat4::from_cols_array(&inverse.map(f64::from)))
    };
    skin.joints.iter().enumerate().map(place).collect()
}

/// Returns the places of the instances of a node, relative to it: one without the extension
/// `EXT_mesh_gpu_instancing`.
fn instances(accessors: Accessors, node: &Node, budget: &mut Budget) -> Result<Vec<DMat4>> {
    let attributes = extension(node, INSTANCING).map(|of| &of["attributes"]);
    let Some(attributes) = attributes else {
        return Ok(vec![DMat4::IDENTITY]);
    };
    let accessor = |name: &str| {
        let index = attributes[name]
            .as_u64()
            .and_then(|index| u32::try_from(index).ok());
        index.map(Index::<Accessor>::new)
    };
    let [translation, rotation, scale] = ["TRANSLATION", "ROTATION", "SCALE"].map(accessor);
    let given = [translation, rotation, scale].into_iter().flatten();
    let n = given.map(|index| accessors.count(index)).max().unwrap_or(0);
    budget.take(n.saturating_mul(size_of::<[DMat4; 3]>() as u64))?;
    let mut vectors = |index: Option<_>| index.map(|index| accessors.vectors::<3>(index, budget));
    let (translations, scales) = (
        vectors(translation).transpose()?,
        vectors(scale).transpose()?,
    );
    let rotations = rotation.map(|index| accessors.vectors::<4>(index, budget));
    let rotations = rotations.transpose()?;
    let at = |i: usize, of: &Option<Vec<[f32; 3]>>| of.as_ref()?.get(i).copied();
    let place = |i: usize| {
        let rotation = rotations.as_ref().and_then(|of| of.get(i).copied());
        let part = Node {
            translation: at(i, &translations),
            rotation: rotation.map(gltf_json::scene::UnitQuaternion),
            scale: at(i, &scales),
            ..Node::default()
        };
        transform(&part)
    };
    Ok((0..n as usize).map(place).collect())
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
