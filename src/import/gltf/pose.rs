//! The places of the vertices of a mesh: by its node, or by the joints of its skin.

use glam::{DMat3, DMat4};
use gltf_json::mesh::{Primitive, Semantic};

use super::accessor::Accessors;
use super::nodes::PlacedMesh;
use crate::budget::Budget;
use crate::{FileFault, Result};

/// The places of the vertices of a mesh in the scene.
pub(super) enum MeshPose<'a> {
    /// All are placed by their node.
    OfNode(&'a DMat4),
    /// Each is placed by joints.
    OfJoints(Vec<DMat4>),
}

impl<'a> MeshPose<'a> {
    /// Finds the places of the vertices of a primitive. Without a skin, or without joints of its
    /// vertices, they are its node's.
    ///
    /// # Errors
    /// There is no such joint, or too few weights.
    pub(super) fn new(
        accessors: Accessors,
        placed: &'a PlacedMesh,
        primitive: &Primitive,
        n_vertices: usize,
        budget: &mut Budget,
    ) -> Result<Self> {
        let Some(scene_from_joints) = &placed.scene_from_joints else {
            return Ok(Self::OfNode(&placed.scene_from_mesh));
        };
        budget.take_of::<[DMat4; 2]>(n_vertices)?;
        let mut places = vec![DMat4::ZERO; n_vertices];
        let mut sums = vec![0.0; n_vertices];
        for set in 0.. {
            let [joints, weights] = [Semantic::Joints(set), Semantic::Weights(set)]
                .map(|semantic| accessors.values::<4>(primitive, semantic, n_vertices, budget));
            let (Some(joints), Some(weights)) = (joints?, weights?) else {
                break;
            };
            for (vertex, (joints, weights)) in joints.iter().zip(&weights).enumerate() {
                let weighted = joints
                    .iter()
                    .zip(weights)
                    .filter(|(_, weight)| **weight > 0.0);
                for (&joint, &weight) in weighted {
                    let place = scene_from_joints.get(joint as usize);
                    let place = place.ok_or_else(|| no_joint(joint, scene_from_joints.len()))?;
                    places[vertex] += *place * f64::from(weight);
                    sums[vertex] += f64::from(weight);
                }
            }
        }
        // The weights of a vertex add up to 1, but for rounding.
        for (place, sum) in places.iter_mut().zip(sums) {
            *place = if sum > 0.0 {
                *place / sum
            } else {
                placed.scene_from_mesh
            };
        }
        Ok(Self::OfJoints(places))
    }

    /// Returns the place of a vertex.
    pub(super) fn at(&self, vertex: usize) -> &DMat4 {
        match self {
            Self::OfNode(place) => place,
            Self::OfJoints(places) => &places[vertex],
        }
    }
}

fn no_joint(joint: f32, n_joints: usize) -> FileFault {
    let expected = format!("one of the {n_joints}, from 0");
    FileFault::new(format!("there is no joint {joint}"), expected)
}

/// Returns the matrix that transforms normals as this one transforms points: its cofactors, even if
/// it has no inverse; normals of mirrored surfaces stay outside.
pub(super) fn normal_matrix(scene_from_mesh: &DMat4) -> DMat3 {
    let [x, y, z] = [0, 1, 2].map(|k| scene_from_mesh.col(k).truncate());
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if scene_from_mesh.determinant() < 0.0 {
        -cofactors
    } else {
        cofactors
    }
}
