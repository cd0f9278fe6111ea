//! Merges the meshes of a scene into one.

use glam::{DVec3, Vec2, Vec3, Vec4};
use gltf_json::accessor::Accessor;
use gltf_json::material::Material;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Index, Root};

use super::accessor::Accessors;
use super::attributes::{Moving, attribute};
use super::materials::{self, Placing};
use super::nodes::PlacedMesh;
use super::pose::{MeshPose, normal_matrix};
use crate::budget::Budget;
use crate::mesh::{Mesh, append_corners, completed, count, fan, finite, moved, point};
use crate::{FileFault, Result};
use base::numbers::counted;
use world::scene::CornerValues;

/// Upper bound of the memory of a vertex with its attributes in bytes, while lists grow.
const BYTES_PER_VERTEX: u64 = 160;
/// Upper bound of the memory of a triangle corner in bytes; in a strip, each one adds a triangle.
const BYTES_PER_CORNER: u64 = 120;

/// The triangles merged so far.
pub(super) struct FlatScene<'a> {
    accessors: Accessors<'a>,
    mesh: Mesh,
    vertices: Vec<DVec3>,
    normals: CornerValues<Vec3>,
    uvs: CornerValues<Vec2>,
    colors: CornerValues<Vec3>,
    opacities: CornerValues<f32>,
    /// The number of primitives of points or lines, and of those whose tangents are not read.
    n_without_triangles: u64,
    n_with_tangents: u64,
}

/// A triangle mesh of one material, as stored in the file.
struct Part<'a> {
    primitive: &'a Primitive,
    /// The corners of the triangles.
    triangles: Vec<[u32; 3]>,
    n_vertices: usize,
    material: u32,
    pose: MeshPose<'a>,
}

impl<'a> FlatScene<'a> {
    pub(super) fn new(accessors: Accessors<'a>) -> Self {
        Self {
            accessors,
            mesh: Mesh::default(),
            vertices: Vec::new(),
            normals: CornerValues::default(),
            uvs: CornerValues::default(),
            colors: CornerValues::default(),
            opacities: CornerValues::default(),
            n_without_triangles: 0,
            n_with_tangents: 0,
        }
    }

    /// Takes the memory of all meshes, which nodes may share.
    ///
    /// # Errors
    /// Too little is left.
    pub(super) fn take_memory(&self, placed: &[PlacedMesh], budget: &mut Budget) -> Result<()> {
        let root = self.accessors.root;
        let meshes = placed.iter().filter_map(|placed| root.get(placed.mesh));
        let of_primitive = |primitive: &Primitive| {
            let positions = attribute(primitive, Semantic::Positions);
            let n_vertices = positions.map_or(0, |index| self.accessors.count(index));
            let n_corners = primitive
                .indices
                .map_or(n_vertices, |index| self.accessors.count(index));
            let of_vertices = n_vertices.saturating_mul(BYTES_PER_VERTEX);
            of_vertices.saturating_add(n_corners.saturating_mul(BYTES_PER_CORNER))
        };
        let primitives = meshes.flat_map(|mesh| &mesh.primitives);
        budget.take(primitives.map(of_primitive).fold(0, u64::saturating_add))
    }

    /// Adds the triangles of a mesh.
    ///
    /// # Errors
    /// A number is not finite, an index is out of range, or there are too many.
    pub(super) fn add(&mut self, placed: &PlacedMesh, budget: &mut Budget) -> Result<()> {
        let root = self.accessors.root;
        let mesh = root.get(placed.mesh);
        for (i, primitive) in mesh.iter().flat_map(|mesh| &mesh.primitives).enumerate() {
            let at = |fault: FileFault| {
                let place = format!("`meshes[{}].primitives[{i}]`", placed.mesh.value());
                FileFault::new(format!("{place}: {}", fault.problem), fault.expected)
            };
            self.add_primitive(primitive, placed, budget).map_err(at)?;
        }
        Ok(())
    }

    fn add_primitive(
        &mut self,
        primitive: &Primitive,
        placed: &PlacedMesh,
        budget: &mut Budget,
    ) -> Result<()> {
        let Some(positions) = attribute(primitive, Semantic::Positions) else {
            self.n_without_triangles += 1;
            return Ok(());
        };
        // Read the triangles, and check their indices.
        let mut triangles = self.triangles(primitive, positions, budget)?;
        if triangles.is_empty() {
            self.n_without_triangles += 1;
            return Ok(());
        }
        let mut vertices = self.accessors.vectors::<3>(positions, budget)?;
        let n_vertices = vertices.len();
        let corners = triangles.as_flattened().iter();
        if let Some(wrong) = corners
            .copied()
            .find(|corner| *corner as usize >= n_vertices)
        {
            let problem = format!("there is no vertex {wrong}");
            return Err(FileFault::new(
                problem,
                format!("one of the {n_vertices}, from 0"),
            ));
        }
        let pose = MeshPose::new(self.accessors, placed, primitive, n_vertices, budget)?;
        for corners in &mut triangles {
            if pose.at(corners[0] as usize).determinant() < 0.0 {
                // Mirrored: swap corners so that the same side stays outside.
                corners.swap(1, 2);
            }
        }
        // Add the attributes.
        let part = Part {
            primitive,
            triangles,
            n_vertices,
            material: self.material_of(primitive),
            pose,
        };
        let material = part.material_in(self.accessors.root);
        let has_normal_map = material.is_some_and(|of| of.normal_texture.is_some());
        if has_normal_map && attribute(primitive, Semantic::Tangents).is_some() {
            self.n_with_tangents += 1;
        }
        let moving = Moving {
            primitive,
            weights: placed.weights,
        };
        self.accessors
            .move_by_targets(&moving, |of| of.positions, &mut vertices, budget)?;
        self.add_normals(&part, &moving, budget)?;
        self.add_uvs(&part, budget)?;
        self.add_colors(&part, budget)?;
        // Place the vertices, and append the triangles.
        let first = count(self.vertices.len() + n_vertices)? - n_vertices as u32;
        for (i, vertex) in vertices.into_iter().enumerate() {
            let vertex: Vec3 = finite(vertex)?;
            let placed = part.pose.at(i).transform_point3(vertex.as_dvec3());
            self.vertices.push(point(placed.to_array())?);
        }
        let n = self.mesh.triangles.len() + part.triangles.len();
        self.mesh.triangles.extend(moved(&part.triangles, first));
        self.mesh.material_of.resize(n, part.material);
        self.mesh.node_of.resize(n, placed.node);
        Ok(())
    }

    /// Returns the index of a primitive's material; the default material is the last.
    fn material_of(&self, primitive: &Primitive) -> u32 {
        let default = self.accessors.root.materials.len();
        primitive.material.map_or(default, |index| index.value()) as u32
    }

    /// Returns the triangles of a primitive; none for points and lines.
    fn triangles(
        &self,
        primitive: &Primitive,
        positions: Index<Accessor>,
        budget: &mut Budget,
    ) -> Result<Vec<[u32; 3]>> {
        let mode = match &primitive.mode {
            Checked::Valid(mode) => *mode,
            Checked::Invalid => Mode::Triangles,
        };
        if !matches!(
            mode,
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
        ) {
            return Ok(Vec::new());
        }
        let corners = match primitive.indices {
            Some(indices) => self.accessors.indices(indices, budget)?,
            None => {
                let n = self.accessors.count(positions);
                budget.take(n.saturating_mul(4))?;
                (0..count(n as usize)?).collect()
            }
        };
        budget.take_of::<[u32; 3]>(corners.len())?;
        let strip = |(i, corners): (usize, &[u32])| match *corners {
            [a, b, c] if i % 2 == 0 => [a, b, c],
            [a, b, c] => [b, a, c],
            _ => [0; 3],
        };
        Ok(match mode {
            Mode::TriangleStrip => corners.windows(3).enumerate().map(strip).collect(),
            Mode::TriangleFan => fan(&corners).collect(),
            _ => corners.as_chunks().0.to_vec(),
        })
    }

    fn add_normals(&mut self, part: &Part, moving: &Moving, budget: &mut Budget) -> Result<()> {
        let Some(mut normals) = self.accessors.values::<3>(
            part.primitive,
            Semantic::Normals,
            part.n_vertices,
            budget,
        )?
        else {
            return Ok(());
        };
        self.accessors
            .move_by_targets(moving, |of| of.normals, &mut normals, budget)?;
        let placed = normals.into_iter().enumerate().map(|(i, normal)| {
            let normal: Vec3 = finite(normal)?;
            let placed = normal_matrix(part.pose.at(i)) * normal.as_dvec3();
            Ok(placed.normalize_or_zero().as_vec3())
        });
        let placed = placed.collect::<Result<_>>()?;
        let n_before = self.mesh.triangles.len();
        append_corners(&mut self.normals, placed, &part.triangles, n_before)
    }

    fn add_uvs(&mut self, part: &Part, budget: &mut Budget) -> Result<()> {
        let material = part.material_in(self.accessors.root);
        let placing = material.map_or(Placing::default(), materials::of_material);
        let semantic = Semantic::TexCoords(placing.set);
        let Some(uvs) =
            self.accessors
                .values::<2>(part.primitive, semantic, part.n_vertices, budget)?
        else {
            return Ok(());
        };
        let placed = uvs.into_iter().map(|uv| {
            let Vec2 { x, y } = placing.picture_from_set.transform_point2(finite(uv)?);
            // Move the origin from the upper left corner to the lower left one.
            finite([x, 1.0 - y])
        });
        let placed = placed.collect::<Result<_>>()?;
        let n_before = self.mesh.triangles.len();
        append_corners(&mut self.uvs, placed, &part.triangles, n_before)
    }

    fn add_colors(&mut self, part: &Part, budget: &mut Budget) -> Result<()> {
        let Some(colors) = self.accessors.values::<4>(
            part.primitive,
            Semantic::Colors(0),
            part.n_vertices,
            budget,
        )?
        else {
            return Ok(());
        };
        let colors = colors.into_iter().map(|color| {
            let color: Vec4 = finite(color)?;
            Ok(color.clamp(Vec4::ZERO, Vec4::ONE))
        });
        let colors = colors.collect::<Result<Vec<_>>>()?;
        let n_before = self.mesh.triangles.len();
        let material = part.material_in(self.accessors.root);
        if material.is_some_and(materials::has_opacity) && colors.iter().any(|color| color.w < 1.0)
        {
            let opacities = colors.iter().map(|color| color.w).collect();
            append_corners(&mut self.opacities, opacities, &part.triangles, n_before)?;
        }
        let light = colors.into_iter().map(Vec4::truncate).collect();
        append_corners(&mut self.colors, light, &part.triangles, n_before)
    }

    /// Returns the mesh of all triangles.
    pub(super) fn finish(self) -> Mesh {
        let Self {
            mut mesh,
            vertices,
            normals,
            uvs,
            colors,
            opacities,
            n_without_triangles,
            n_with_tangents,
            ..
        } = self;
        let n = mesh.triangles.len();
        mesh.take_vertices(vertices);
        mesh.uvs = completed(uvs, n, Vec2::ZERO);
        mesh.colors = completed(colors, n, Vec3::ONE);
        mesh.opacities = completed(opacities, n, 1.0);
        mesh.take_normals(normals);
        let [bare, with_tangents] = [n_without_triangles, n_with_tangents]
            .map(|n| (n > 0).then(|| counted(n, "primitive")));
        mesh.notes
            .extend(bare.map(|n| format!("{n} without triangles left out, such as points")));
        mesh.notes.extend(with_tangents.map(|n| {
            format!("the tangents of {n} are not read: bumps lie along the texture coordinates")
        }));
        mesh
    }
}

impl Part<'_> {
    /// Returns the material; `None` for the default one.
    fn material_in<'a>(&self, root: &'a Root) -> Option<&'a Material> {
        root.get(self.primitive.material?)
    }
}
