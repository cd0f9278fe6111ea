//! Merges the surfaces of all pieces into a mesh.

use glam::{Vec2, Vec3};

use super::super::mesh::{Mesh, count, finite};
use super::super::{FileFault, Result};
use super::array_of_pieces::ArrayOfPieces;
use super::budget::Budget;
use super::numbers::Numbers;
use super::piece::{GHOSTS, Piece};
use super::surface::PieceSurface;
use world::material::{ArrayChoice, ArrayOf};
use world::scene::CornerValues;

/// The mesh of the pieces so far.
pub(super) struct Pieces<'a> {
    array: Option<&'a ArrayChoice>,
    numbers: ArrayOfPieces,
    mesh: Mesh,
    /// True if all pieces have normals.
    has_normals: bool,
    has_uvs: bool,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    scalars: CornerValues<f64>,
    colors: CornerValues<Vec3>,
}

impl<'a> Pieces<'a> {
    pub(super) fn new(array: Option<&'a ArrayChoice>) -> Self {
        Self {
            array,
            numbers: ArrayOfPieces::default(),
            mesh: Mesh::default(),
            has_normals: true,
            has_uvs: true,
            normals: Vec::new(),
            uvs: Vec::new(),
            scalars: CornerValues::default(),
            colors: CornerValues::default(),
        }
    }

    /// Adds the surface of a piece.
    ///
    /// # Errors
    /// Numbers are not finite or too many, or an array is missing.
    pub(super) fn add(&mut self, piece: &Piece, budget: &mut Budget) -> Result<()> {
        if self.mesh.arrays.is_empty() {
            self.mesh.arrays = piece.color_arrays();
        }
        // Extract the surface.
        let PieceSurface {
            mut triangles,
            cells,
            polygons,
        } = PieceSurface::extract(piece, budget)?;
        if triangles.is_empty() {
            return Ok(());
        }
        // Most points of solid cells are in the interior.
        let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        // Re-index its triangles to the used points.
        let first = count(self.mesh.vertices.len() + used.len())? - used.len() as u32;
        budget.take_of::<[f32; 16]>(used.len())?;
        for corner in triangles.as_flattened_mut() {
            // Every corner is in `used`.
            *corner = first + used.partition_point(|point| point < corner) as u32;
        }
        // Add the vertices.
        if self.mesh.vertices.is_empty() {
            self.mesh.origin = piece.origin();
        }
        for &point in &used {
            let position = piece.position(point as usize);
            let at_point = |fault: FileFault| {
                fault.at(super::super::FileLocation::Element(
                    "point".into(),
                    point.into(),
                ))
            };
            let from_origin = position.map_err(at_point)? - self.mesh.origin;
            self.mesh.vertices.push(from_origin.as_vec3());
        }
        polygons.triangulate(&self.mesh.vertices, &mut triangles, &mut []);
        // Add the values of the array.
        if let Some(array) = self.array {
            let surface = (&used[..], &triangles[..], &cells[..]);
            if array.is_color {
                let (of, values) = piece.colors(array)?;
                add_values(&mut self.colors, first, of, &values, surface);
            } else {
                let (of, values) = self.numbers.scalars(piece, array)?;
                self.mesh.scalar_ends.extend(shown_ends(piece, of, &values));
                add_values(&mut self.scalars, first, of, &values, surface);
            }
        }
        // Add normals and texture coordinates.
        self.add_normals(piece.point_data.normals(), &used)?;
        self.add_uvs(piece.point_data.uvs(), &used)?;
        self.mesh.triangles.append(&mut triangles);
        Ok(())
    }

    fn add_normals(&mut self, normals: Option<&Numbers>, used: &[u32]) -> Result<()> {
        self.has_normals &= normals.is_some();
        for &point in used.iter().filter(|_| self.has_normals) {
            let normal = normals.map_or([0.0; 3], |normals| normals.triple(point as usize));
            self.normals
                .push(finite(normal.map(|number| number as f32))?);
        }
        Ok(())
    }

    fn add_uvs(&mut self, uvs: Option<&Numbers>, used: &[u32]) -> Result<()> {
        self.has_uvs &= uvs.is_some();
        for &point in used.iter().filter(|_| self.has_uvs) {
            let at = |k| {
                uvs.map_or(0.0, |uvs| {
                    uvs.at(uvs.n_components * point as usize + k) as f32
                })
            };
            self.uvs.push(finite([at(0), at(1)])?);
        }
        Ok(())
    }

    /// Returns the mesh of all pieces.
    ///
    /// # Errors
    /// No piece has the array.
    pub(super) fn finish(self) -> Result<Mesh> {
        let Self {
            mut mesh,
            normals,
            uvs,
            ..
        } = self;
        mesh.notes.extend(self.numbers.check()?);
        let triangles = &mesh.triangles;
        mesh.normals = self.has_normals.then(|| CornerValues {
            values: normals,
            triangles: triangles.clone(),
        });
        mesh.uvs = self.has_uvs.then(|| CornerValues {
            values: uvs,
            triangles: triangles.clone(),
        });
        match self.array {
            Some(array) if array.is_color => mesh.colors = Some(self.colors),
            array => mesh.scalars = array.map(|_| self.scalars),
        }
        Ok(mesh)
    }
}

/// Returns the least, the least positive and the greatest of the finite numbers of a piece, without
/// those of hidden points or cells and of copies of other pieces'.
fn shown_ends(piece: &Piece, of: ArrayOf, values: &[f64]) -> impl Iterator<Item = f64> {
    let ghosts = match of {
        ArrayOf::Points => piece.point_data.get(GHOSTS),
        ArrayOf::Cells => piece.cell_data.get(GHOSTS),
    };
    let is_shown = |(i, value): &(usize, f64)| {
        value.is_finite() && ghosts.is_none_or(|ghosts| ghosts.at(*i) == 0.0)
    };
    let shown = || {
        let numbered = values.iter().copied().enumerate().filter(is_shown);
        numbered.map(|(_, value)| value)
    };
    let positive = shown().filter(|value| *value >= f32::MIN_POSITIVE.into());
    let ends = [
        shown().reduce(f64::min),
        positive.reduce(f64::min),
        shown().reduce(f64::max),
    ];
    ends.into_iter().flatten()
}

/// Adds the values of an array on a surface, given its used points, its triangles with their
/// corners in the mesh, and their cells. `n_before` is the number of vertices already in the mesh.
fn add_values<T: Copy>(
    into: &mut CornerValues<T>,
    n_before: u32,
    of: ArrayOf,
    values: &[T],
    (used, triangles, cells): (&[u32], &[[u32; 3]], &[u32]),
) {
    let first = into.values.len() as u32;
    match of {
        ArrayOf::Points => {
            let moved = first.wrapping_sub(n_before);
            let corners = triangles
                .iter()
                .map(|t| t.map(|corner| corner.wrapping_add(moved)));
            into.triangles.extend(corners);
            let of_used = used.iter().map(|point| values[*point as usize]);
            into.values.extend(of_used);
        }
        ArrayOf::Cells => {
            for &cell in cells {
                let index = into.values.len() as u32;
                into.values.push(values[cell as usize]);
                into.triangles.push([index; 3]);
            }
        }
    }
}
