//! Isosurfaces: where an array of points has a value within solid cells.
//!
//! Lorensen and Cline, "Marching Cubes: A High Resolution 3D Surface Construction Algorithm"
//! (SIGGRAPH 1987), without its table of cases, so that the cells need not be cubes: the
//! polygons of a cell follow from its faces. On a face, a line leads from the edge before
//! each run of corners that are inside to the edge behind it. Two cells agree on the lines
//! of the face that they share, so that the surface has no holes.

use std::collections::HashMap;

use arrayvec::ArrayVec;
use glam::{DMat3, DVec3, Vec3};

use super::super::mesh::{CornerValues, Mesh, count, fan};
use super::super::{FileFault, Result};
use super::budget::Budget;
use super::cells::{CellShape, VOXEL};
use super::piece::{GHOSTS, Piece, Topology, grid_index};
use super::points::at_point;
use super::{ArrayChoice, ArrayOf, IsosurfaceChoice};
use crate::stop;

/// The isosurfaces of the pieces so far.
pub(super) struct Isosurfaces<'a> {
    choice: &'a IsosurfaceChoice,
    /// The array of the colors.
    array: Option<&'a ArrayChoice>,
    mesh: Mesh,
    /// The directions of descent at the vertices; zero where there is none.
    normals: Vec<Vec3>,
    /// Whether all pieces are grids, which have gradients.
    has_normals: bool,
    scalars: CornerValues<f32>,
    /// The least and the greatest number of the array.
    range: [f32; 2],
}

impl<'a> Isosurfaces<'a> {
    pub(super) fn new(choice: &'a IsosurfaceChoice, array: Option<&'a ArrayChoice>) -> Self {
        Self {
            choice,
            array,
            mesh: Mesh::default(),
            normals: Vec::new(),
            has_normals: true,
            scalars: CornerValues::default(),
            range: [f32::INFINITY, f32::NEG_INFINITY],
        }
    }

    /// Adds the isosurfaces of a piece.
    ///
    /// # Errors
    /// An array that is missing, positions that are not finite, cells of unknown types, or
    /// too many triangles for the memory.
    pub(super) fn add(&mut self, piece: &Piece, budget: &mut Budget) -> Result<()> {
        budget.take_of::<[f32; 2]>(piece.n_points() + piece.n_cells())?;
        let (_, values) = piece.scalars(&self.choice.array)?;
        let colors = self.array.map(|array| piece.scalars(array)).transpose()?;
        self.has_normals &= matches!(piece.topology, Topology::Grid(_));
        for value in values.iter().filter(|value| value.is_finite()) {
            self.range = [self.range[0].min(*value), self.range[1].max(*value)];
        }
        for &level in &self.choice.values {
            let mut contour = Contour {
                piece,
                values: &values,
                level,
                colors: colors.as_ref().map(|(of, values)| (*of, &values[..])),
                vertices: HashMap::new(),
                of_all: self,
                budget,
            };
            contour.add_cells()?;
        }
        Ok(())
    }

    /// The mesh of all pieces.
    ///
    /// # Errors
    /// It has no triangle.
    pub(super) fn finish(self) -> Result<Mesh> {
        let mut mesh = self.mesh;
        if mesh.triangles.is_empty() {
            return Err(nowhere(self.choice, self.range));
        }
        mesh.scalars = self.array.map(|_| self.scalars);
        mesh.normals = Some(if self.has_normals {
            CornerValues {
                values: self.normals,
                triangles: mesh.triangles.clone(),
            }
        } else {
            mesh.smooth_normals()
        });
        Ok(mesh)
    }
}

/// The fault of values that the array has nowhere between the points of a solid cell.
fn nowhere(choice: &IsosurfaceChoice, [low, high]: [f32; 2]) -> FileFault {
    let values: Vec<String> = choice.values.iter().map(f32::to_string).collect();
    let (name, values) = (&choice.array.name, super::super::listed(&values));
    let problem = format!("`{name}` is nowhere {values} in a solid cell");
    let expected = if low < high {
        format!("a value between {low} and {high}, in a grid or other cells with a volume")
    } else {
        "cells with a volume, and an array that varies".to_owned()
    };
    FileFault::new(problem, expected)
}

/// The isosurface of one value in a piece.
struct Contour<'a, 'b> {
    piece: &'a Piece,
    values: &'a [f32],
    level: f32,
    /// The numbers of the colors.
    colors: Option<(ArrayOf, &'a [f32])>,
    /// The vertices by the ends of their edges, the lower number first; both are the same
    /// for a vertex at a point.
    vertices: HashMap<[u32; 2], u32>,
    of_all: &'a mut Isosurfaces<'b>,
    budget: &'a mut Budget,
}

impl Contour<'_, '_> {
    fn add_cells(&mut self) -> Result<()> {
        let piece = self.piece;
        match &piece.topology {
            Topology::Grid([nx, ny, nz]) => {
                let (row, layer) = (*nx as u32, (nx * ny) as u32);
                let mut cell = 0;
                for k in 0..*nz as u32 - 1 {
                    stop::check().map_err(std::io::Error::other)?;
                    for j in 0..*ny as u32 - 1 {
                        for i in 0..row - 1 {
                            let first = i + row * j + layer * k;
                            let corners = [0, 1, row, row + 1].map(|step| first + step);
                            let [a, b, c, d] = corners;
                            let [e, f, g, h] = corners.map(|corner| corner + layer);
                            self.add_cell(cell, VOXEL, &[a, b, c, d, e, f, g, h])?;
                            cell += 1;
                        }
                    }
                }
            }
            Topology::Cells(cells) => {
                for cell in 0..cells.len() {
                    if cell.is_multiple_of(1 << 16) {
                        stop::check().map_err(std::io::Error::other)?;
                    }
                    let (shape, corners) = cells.get(cell)?;
                    match shape {
                        CellShape::Solid(faces) => {
                            self.add_cell(cell, faces, &corners[..shape.min_points()])?;
                        }
                        CellShape::Polyhedron => return Err(cells.polyhedron(cell)),
                        _ => {}
                    }
                }
            }
        }
        Ok(())
    }

    /// Adds the polygons of a solid cell, unless it is hidden or a copy of another piece's,
    /// or a value is missing.
    fn add_cell(&mut self, cell: usize, faces: &[&[u8]], corners: &[u32]) -> Result<()> {
        let mut inside = ArrayVec::<bool, MAX_CORNERS>::new();
        let (mut all, mut any, mut finite) = (true, false, true);
        for &corner in corners {
            let value = self.values[corner as usize];
            let is_inside = value >= self.level;
            (all, any) = (all & is_inside, any | is_inside);
            finite &= value.is_finite();
            inside.push(is_inside);
        }
        if all || !any || !finite {
            return Ok(());
        }
        let ghosts = self.piece.cell_data.get(GHOSTS);
        if ghosts.is_some_and(|ghosts| ghosts.at(cell) != 0.0) {
            return Ok(());
        }
        for polygon in polygons(faces, &inside) {
            let mut vertices = ArrayVec::<u32, MAX_EDGES>::new();
            for [within, beyond] in polygon {
                let vertex = self.vertex(corners[within as usize], corners[beyond as usize])?;
                // Edges that end at the same point may share their vertex.
                if vertices.last() != Some(&vertex) {
                    vertices.push(vertex);
                }
            }
            if vertices.len() > 1 && vertices.first() == vertices.last() {
                vertices.pop();
            }
            if vertices.len() > 2 {
                self.add_polygon(cell, &vertices)?;
            }
        }
        Ok(())
    }

    fn add_polygon(&mut self, cell: usize, vertices: &[u32]) -> Result<()> {
        self.budget.take_of::<[u32; 16]>(vertices.len())?;
        let Isosurfaces { mesh, scalars, .. } = self.of_all;
        mesh.triangles.extend(fan(vertices));
        match self.colors {
            Some((ArrayOf::Points, _)) => scalars.triangles.extend(fan(vertices)),
            Some((ArrayOf::Cells, colors)) => {
                let index = scalars.values.len() as u32;
                scalars.values.push(colors[cell]);
                scalars.triangles.resize(mesh.triangles.len(), [index; 3]);
            }
            None => {}
        }
        Ok(())
    }

    /// The vertex on the edge between a point inside and one that is not.
    fn vertex(&mut self, within: u32, beyond: u32) -> Result<u32> {
        let is_at_point = self.values[within as usize] == self.level;
        let beyond = if is_at_point { within } else { beyond };
        let edge = [within.min(beyond), within.max(beyond)];
        if let Some(vertex) = self.vertices.get(&edge) {
            return Ok(*vertex);
        }
        self.budget.take_of::<[f32; 32]>(1)?;
        let [a, b] = edge.map(|point| point as usize);
        let position = |point: usize| {
            let position = self.piece.position(point);
            position.map_err(|fault| fault.at(at_point(point)))
        };
        let (from, to) = (position(a)?.as_dvec3(), position(b)?.as_dvec3());
        let [at_a, at_b] = [a, b].map(|point| f64::from(self.values[point]));
        let t = match is_at_point {
            true => 0.0,
            false => (f64::from(self.level) - at_a) / (at_b - at_a),
        };
        let normal = match &self.piece.topology {
            Topology::Grid(size) => {
                let [at_a, at_b] = [a, b].map(|point| self.gradient(*size, point));
                let descent = -at_a.lerp(at_b, t).normalize_or_zero();
                if descent.is_finite() {
                    descent.as_vec3()
                } else {
                    Vec3::ZERO
                }
            }
            Topology::Cells(_) => Vec3::ZERO,
        };
        let all = &mut *self.of_all;
        let vertex = count(all.mesh.vertices.len() + 1)? - 1;
        all.mesh.vertices.push(from.lerp(to, t).as_vec3());
        all.normals.push(normal);
        if let Some((ArrayOf::Points, colors)) = self.colors {
            let [at_a, at_b] = [a, b].map(|point| f64::from(colors[point]));
            // Not a sum with a share of 0, which may be of infinity or NaN.
            let color = if t == 0.0 {
                at_a
            } else {
                at_a + t * (at_b - at_a)
            };
            all.scalars.values.push(color as f32);
        }
        self.vertices.insert(edge, vertex);
        Ok(vertex)
    }

    /// The gradient at a point of a grid, by differences between its neighbors.
    fn gradient(&self, size: [usize; 3], point: usize) -> DVec3 {
        let at = grid_index(size, point);
        let strides = [1, size[0], size[0] * size[1]];
        let (mut ways, mut steps) = ([DVec3::ZERO; 3], DVec3::ZERO);
        for axis in 0..3 {
            let before = if at[axis] > 0 {
                point - strides[axis]
            } else {
                point
            };
            let is_last = at[axis] + 1 == size[axis];
            let behind = if is_last {
                point
            } else {
                point + strides[axis]
            };
            let place = |point| {
                self.piece
                    .position(point)
                    .map_or(DVec3::NAN, |p| p.as_dvec3())
            };
            ways[axis] = place(behind) - place(before);
            let [low, high] = [before, behind].map(|point| f64::from(self.values[point]));
            steps[axis] = high - low;
        }
        // The scalar products of the gradient with the ways are the steps.
        let [x, y, z] = ways;
        DMat3::from_cols(x, y, z).transpose().inverse() * steps
    }
}

/// Most corners and edges of a solid cell: a hexagonal prism's.
const MAX_CORNERS: usize = 12;
const MAX_EDGES: usize = 18;

/// An edge of a cell: the corner inside, and the other one.
type CrossedEdge = [u8; 2];

/// The polygons that separate the corners inside from the others, each as the edges that it
/// crosses: counter-clockwise as seen from the other side.
fn polygons(
    faces: &[&[u8]],
    inside: &[bool],
) -> ArrayVec<ArrayVec<CrossedEdge, MAX_EDGES>, MAX_EDGES> {
    let mut lines = ArrayVec::<[CrossedEdge; 2], MAX_EDGES>::new();
    let is_inside = |corner: u8| inside[usize::from(corner)];
    for face in faces {
        let n = face.len();
        for i in 0..n {
            let [before, first] = [face[i], face[(i + 1) % n]];
            if is_inside(before) || !is_inside(first) {
                continue;
            }
            let mut last = i + 1;
            while is_inside(face[(last + 1) % n]) {
                last += 1;
            }
            let behind = [face[last % n], face[(last + 1) % n]];
            lines.push([[first, before], behind]);
        }
    }
    let mut found = ArrayVec::new();
    while let Some([first, mut next]) = lines.pop() {
        let mut polygon = ArrayVec::from_iter([first]);
        // Each edge belongs to two faces: one line ends at it, and another one begins.
        while let Some(at) = lines.iter().position(|[from, _]| *from == next) {
            polygon.push(next);
            next = lines.remove(at)[1];
        }
        found.push(polygon);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_of_a_voxel_is_cut_off_by_a_triangle_that_faces_the_others() {
        let mut inside = [false; 8];
        inside[0] = true;
        let found = polygons(VOXEL, &inside);
        assert_eq!(found.len(), 1);
        let at = |edge: &CrossedEdge| match edge {
            [0, 1] => 'x',
            [0, 2] => 'y',
            [0, 4] => 'z',
            _ => '?',
        };
        let edges: String = found[0].iter().chain(&found[0]).map(at).collect();
        assert!(edges.contains("xyz"), "{edges}");
    }

    /// Each crossed edge belongs to one polygon, for all cases of all cells.
    #[test]
    fn every_crossed_edge_is_in_one_polygon() {
        for (cell_type, n) in [
            (10, 4),
            (11, 8),
            (12, 8),
            (13, 6),
            (14, 5),
            (15, 10),
            (16, 12),
        ] {
            let Some(CellShape::Solid(faces)) = CellShape::of(cell_type, n) else {
                panic!("{cell_type} is solid");
            };
            for case in 0..1_u32 << n {
                let inside: Vec<bool> = (0..n).map(|corner| case >> corner & 1 == 1).collect();
                let polygons = polygons(faces, &inside);
                let mut found: Vec<CrossedEdge> = polygons.iter().flatten().copied().collect();
                found.sort_unstable();
                let mut expected = Vec::new();
                for face in faces {
                    for i in 0..face.len() {
                        let [a, b] = [face[i], face[(i + 1) % face.len()]];
                        if inside[usize::from(a)] && !inside[usize::from(b)] {
                            expected.push([a, b]);
                        }
                    }
                }
                expected.sort_unstable();
                assert_eq!(found, expected, "{cell_type} {case}");
                assert!(polygons.iter().all(|polygon| polygon.len() > 2));
            }
        }
    }
}
