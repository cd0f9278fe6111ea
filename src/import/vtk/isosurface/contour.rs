//! The isosurface of one value in a piece.

use arrayvec::ArrayVec;
use glam::{DVec3, Vec3};

use super::super::super::Result;
use super::super::super::mesh::{count, fan};
use super::super::cells::{CellShape, Cells, VOXEL};
use super::super::piece::{GHOSTS, Topology};
use super::super::points::at_point;
use super::gradient::gradient;
use super::polygons::{MAX_CORNERS, MAX_EDGES, polygons};
use super::{Budget, HashMap, Isosurfaces, Piece, polyhedron};
use base::stop;
use world::material::ArrayOf;

/// The isosurface of one value in a piece.
pub(super) struct Contour<'a, 'b> {
    pub(super) piece: &'a Piece,
    pub(super) values: &'a [f64],
    pub(super) level: f64,
    /// The numbers that give colors.
    pub(super) colors: Option<(ArrayOf, &'a [f64])>,
    /// The vertices by the ends of their edges, the lower number first; both are equal for a vertex
    /// at a point.
    pub(super) vertices: HashMap<[u32; 2], u32>,
    pub(super) of_all: &'a mut Isosurfaces<'b>,
    pub(super) budget: &'a mut Budget,
}

impl Contour<'_, '_> {
    /// Adds the isosurface in all cells.
    pub(super) fn add_cells(&mut self) -> Result<()> {
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
                        CellShape::Polyhedron => self.add_polyhedron(cell, cells)?,
                        _ => {}
                    }
                }
            }
        }
        Ok(())
    }

    /// Adds the polygons in a solid cell, unless it is hidden or a copy of another piece's cell, or
    /// a value is missing.
    fn add_cell(&mut self, cell: usize, faces: &[&[u8]], corners: &[u32]) -> Result<()> {
        if !self.is_crossed(cell, corners) {
            return Ok(());
        }
        let is_inside = |corner: &u32| self.is_inside(*corner);
        let inside: ArrayVec<bool, MAX_CORNERS> = corners.iter().map(is_inside).collect();
        for polygon in polygons(faces, &inside) {
            let mut vertices = ArrayVec::<u32, MAX_EDGES>::new();
            for edge in polygon {
                let [within, beyond] = edge.map(|corner| corners[usize::from(corner)]);
                let vertex = self.vertex(within, beyond)?;
                // Edges that end at the same point may share their vertex.
                if vertices.last() != Some(&vertex) {
                    vertices.push(vertex);
                }
            }
            self.add_polygon(cell, &vertices)?;
        }
        Ok(())
    }

    /// Adds the polygons in a polyhedron, as [`add_cell`](Self::add_cell) does.
    fn add_polyhedron(&mut self, cell: usize, cells: &Cells) -> Result<()> {
        let faces = || cells.polyhedra.faces(cell);
        let corners: Vec<u32> = faces().flatten().copied().collect();
        if !self.is_crossed(cell, &corners) {
            return Ok(());
        }
        self.budget.take_of::<[u32; 32]>(corners.len())?;
        let found = polyhedron::polygons(faces(), |point| self.is_inside(point));
        for polygon in found.ok_or_else(|| cells.open_polyhedron(cell))? {
            let mut vertices: Vec<u32> = Vec::with_capacity(polygon.len());
            let mut descent = DVec3::ZERO;
            for [within, beyond] in polygon {
                let vertex = self.vertex(within, beyond)?;
                if vertices.last() != Some(&vertex) {
                    vertices.push(vertex);
                }
                descent += self.position(beyond)? - self.position(within)?;
            }
            if area_vector(&vertices, &self.of_all.mesh.vertices).dot(descent) < 0.0 {
                vertices.reverse();
            }
            let n_before = self.of_all.mesh.triangles.len();
            self.add_polygon(cell, &vertices)?;
            let fan = n_before..self.of_all.mesh.triangles.len();
            self.of_all.polygons.add(fan);
        }
        Ok(())
    }

    fn is_inside(&self, point: u32) -> bool {
        self.values[point as usize] >= self.level
    }

    /// Returns true if some of a cell's points are inside and some are not, all have a value, and
    /// the cell is neither hidden nor a copy.
    fn is_crossed(&self, cell: usize, points: &[u32]) -> bool {
        let (mut all, mut any, mut finite) = (true, false, true);
        for &point in points {
            let is_inside = self.is_inside(point);
            (all, any) = (all & is_inside, any | is_inside);
            finite &= self.values[point as usize].is_finite();
        }
        let ghosts = self.piece.cell_data.get(GHOSTS);
        let is_ghost = || ghosts.is_some_and(|ghosts| ghosts.at(cell) != 0.0);
        any && !all && finite && !is_ghost() && !self.piece.has_hidden(points)
    }

    /// Adds the polygon of these vertices, whose neighbors are distinct except for the last and the
    /// first, unless it has no area.
    fn add_polygon(&mut self, cell: usize, vertices: &[u32]) -> Result<()> {
        let n_same = usize::from(vertices.first() == vertices.last());
        let vertices = &vertices[..vertices.len() - n_same];
        if vertices.len() < 3 {
            return Ok(());
        }
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

    /// Returns the vertex on the edge between a point inside and one outside.
    fn vertex(&mut self, within: u32, beyond: u32) -> Result<u32> {
        // Reuse the vertex if another cell has made it.
        let is_at_point = self.values[within as usize] == self.level;
        let beyond = if is_at_point { within } else { beyond };
        let edge = [within.min(beyond), within.max(beyond)];
        if let Some(vertex) = self.vertices.get(&edge) {
            return Ok(*vertex);
        }
        // Find the point on the edge by linear interpolation.
        self.budget.take_of::<[f32; 32]>(1)?;
        let [a, b] = edge.map(|point| point as usize);
        let [from, to] = [self.position(edge[0])?, self.position(edge[1])?];
        let [at_a, at_b] = [a, b].map(|point| self.values[point]);
        let t = if is_at_point {
            0.0
        } else {
            (self.level - at_a) / (at_b - at_a)
        };
        // Interpolate the gradient, along whose descent the normal points.
        let normal = match &self.piece.topology {
            Topology::Grid(size) => {
                let [at_a, at_b] =
                    [a, b].map(|point| gradient(self.piece, self.values, *size, point));
                let descent = -at_a.lerp(at_b, t).normalize_or_zero();
                if descent.is_finite() {
                    descent.as_vec3()
                } else {
                    Vec3::ZERO
                }
            }
            Topology::Cells(_) => Vec3::ZERO,
        };
        // Add the vertex with its attributes.
        let all = &mut *self.of_all;
        let vertex = count(all.mesh.vertices.len() + 1)? - 1;
        let from_origin = from.lerp(to, t) - all.mesh.origin;
        all.mesh.vertices.push(from_origin.as_vec3());
        all.normals.push(normal);
        if let Some((ArrayOf::Points, colors)) = self.colors {
            let [at_a, at_b] = [a, b].map(|point| colors[point]);
            // Not a sum with a weight of 0, which may multiply infinity or NaN.
            let color = if t == 0.0 {
                at_a
            } else {
                at_a + t * (at_b - at_a)
            };
            all.scalars.values.push(color);
        }
        self.vertices.insert(edge, vertex);
        Ok(vertex)
    }

    fn position(&self, point: u32) -> Result<DVec3> {
        let position = self.piece.position(point as usize);
        position.map_err(|fault| fault.at(at_point(point as usize)))
    }
}

/// Returns twice the area of a polygon along its normal, about which it is counter-clockwise.
fn area_vector(polygon: &[u32], vertices: &[Vec3]) -> DVec3 {
    let at = |corner: u32| vertices[corner as usize].as_dvec3();
    let triangles = fan(polygon).map(|triangle| triangle.map(at));
    triangles.map(|[a, b, c]| (b - a).cross(c - a)).sum()
}
