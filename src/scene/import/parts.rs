//! Splits a mesh by its materials.

use super::materials::MeshMaterial;
use super::mesh::{CornerValues, Mesh};

impl Mesh {
    /// Returns the meshes of the materials, at least one, in order, except for meshes whose
    /// triangles all have no area.
    pub fn into_parts(mut self) -> Vec<(MeshMaterial, Mesh)> {
        let materials = std::mem::take(&mut self.materials);
        let material_of = std::mem::take(&mut self.material_of);
        let mut triangles_of = vec![Vec::new(); materials.len()];
        for (triangle, material) in material_of.into_iter().enumerate() {
            triangles_of[material as usize].push(triangle);
        }
        let has_uvs = self.uvs.is_some();
        let materials = materials.into_iter().map(|material| {
            if has_uvs {
                material
            } else {
                material.without_pictures()
            }
        });
        let used = materials.zip(triangles_of);
        let mut used: Vec<_> = used.filter(|(_, of)| self.has_area(of)).collect();
        match used.pop() {
            None => vec![(MeshMaterial::default(), self)],
            Some((only, _)) if used.is_empty() => vec![(only, self)],
            Some(last) => {
                used.push(last);
                let part = |(material, of): (MeshMaterial, Vec<usize>)| (material, self.part(&of));
                used.into_iter().map(part).collect()
            }
        }
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
            normals: self.normals.as_ref().map(|of| of.only(triangles)),
            uvs: self.uvs.as_ref().map(|of| of.only(triangles)),
            colors: self.colors.as_ref().map(|of| of.only(triangles)),
            opacities: self.opacities.as_ref().map(|of| of.only(triangles)),
            ..Self::default()
        }
    }
}

impl<T: Copy> CornerValues<T> {
    /// Returns the values of these triangles.
    fn only(&self, triangles: &[usize]) -> Self {
        let (values, triangles) = only(&self.values, &self.triangles, triangles);
        Self { values, triangles }
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
