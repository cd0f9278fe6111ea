//! Splits a mesh by its materials and the nodes of its file.

use std::collections::HashMap;

use super::materials::MeshMaterial;
use super::mesh::Mesh;
use world::scene::CornerValues;

/// The triangles of one material and one node of a mesh's file.
#[derive(Debug)]
pub struct MeshPart {
    /// The name of the node, followed by the material's if the node has several; `None`
    /// for a node without a name.
    pub node: Option<String>,
    /// The index of the material.
    pub material: usize,
    /// The triangles.
    pub mesh: Mesh,
}

impl Mesh {
    /// Returns the materials, at least one, and the parts, at least one: by material, then by node,
    /// except for parts whose triangles all have no area.
    pub fn into_parts(mut self) -> (Vec<MeshMaterial>, Vec<MeshPart>) {
        let mut materials = std::mem::take(&mut self.materials);
        let material_of = std::mem::take(&mut self.material_of);
        let nodes = std::mem::take(&mut self.nodes);
        let node_of = std::mem::take(&mut self.node_of);
        if materials.is_empty() {
            materials.push(MeshMaterial::default());
        }
        if self.uvs.is_none() {
            let bare = materials.into_iter().map(MeshMaterial::without_pictures);
            materials = bare.collect();
        }
        let at = |of: &[u32], i: usize| of.get(i).map_or(0, |index| *index as usize);
        let place = |i: &usize| (at(&material_of, *i), at(&node_of, *i));
        let mut order: Vec<usize> = (0..self.triangles.len()).collect();
        order.sort_by_key(place);
        let used = order.chunk_by(|a, b| place(a) == place(b));
        let used: Vec<&[usize]> = used.filter(|of| self.has_area(of)).collect();
        let mut n_of_nodes = HashMap::<usize, u32>::new();
        for of in &used {
            *n_of_nodes.entry(place(&of[0]).1).or_default() += 1;
        }
        let name = |(material, node): (usize, usize)| {
            let name = nodes.get(node).filter(|name| !name.is_empty())?;
            let of_material = || format!("{name}/{}", materials[material].name);
            let is_only = n_of_nodes.get(&node).is_none_or(|n| *n == 1);
            Some(if is_only { name.clone() } else { of_material() })
        };
        let part = |of: &[usize], mesh| {
            let place = of.first().map_or((0, 0), place);
            MeshPart {
                node: name(place),
                material: place.0,
                mesh,
            }
        };
        let parts = match used[..] {
            [] => vec![part(&[], self)],
            [only] => vec![part(only, self)],
            _ => used.iter().map(|of| part(of, self.part(of))).collect(),
        };
        (materials, parts)
    }

    /// Returns true if one of these triangles has an area.
    fn has_area(&self, triangles: &[usize]) -> bool {
        let mut normals = triangles
            .iter()
            .map(|&i| self.triangle(self.triangles[i]).normal());
        normals.any(|normal| normal.is_some())
    }

    /// Returns the mesh of these triangles.
    fn part(&self, triangles: &[usize]) -> Self {
        let (vertices, corners) = only(&self.vertices, &self.triangles, triangles);
        Self {
            origin: self.origin,
            vertices,
            triangles: corners,
            normals: self.normals.as_ref().map(|of| only_corners(of, triangles)),
            uvs: self.uvs.as_ref().map(|of| only_corners(of, triangles)),
            colors: self.colors.as_ref().map(|of| only_corners(of, triangles)),
            opacities: self
                .opacities
                .as_ref()
                .map(|of| only_corners(of, triangles)),
            ..Self::default()
        }
    }
}

/// Returns the values used by these triangles, and the triangles re-indexed into them.
fn only<T: Copy>(
    values: &[T],
    corners: &[[u32; 3]],
    triangles: &[usize],
) -> (Vec<T>, Vec<[u32; 3]>) {
    let mut corners: Vec<[u32; 3]> = triangles.iter().map(|&i| corners[i]).collect();
    let mut used = corners.concat();
    used.sort_unstable();
    used.dedup();
    for corner in corners.as_flattened_mut() {
        // Every corner is in `used`.
        *corner = used.partition_point(|index| index < corner) as u32;
    }
    let values = used.into_iter().map(|index| values[index as usize]);
    (values.collect(), corners)
}

/// Returns the values of these triangles.
fn only_corners<T: Copy>(corners: &CornerValues<T>, triangles: &[usize]) -> CornerValues<T> {
    let (values, triangles) = only(&corners.values, &corners.triangles, triangles);
    CornerValues { values, triangles }
}
