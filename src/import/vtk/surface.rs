//! Extracts the surface of a piece: its flat cells, and the faces that only one solid cell has.

use super::super::Result;
use super::super::mesh::fan;
use super::super::polygons::Polygons;
use super::budget::Budget;
use super::cells::{CellShape, Cells};
use super::piece::{GHOSTS, Piece, Topology};
use base::stop;

/// Triangles with the cell of each.
#[derive(Debug, Default)]
pub(super) struct PieceSurface {
    /// Indices of points.
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) cells: Vec<u32>,
    pub(super) polygons: Polygons,
}

/// Bits of a cell's ghost type: a copy of a cell of another piece, and a hidden cell.
const COPY: u8 = 1;
const HIDDEN: u8 = 32;

impl PieceSurface {
    /// Returns the surface of a piece.
    ///
    /// # Errors
    /// Cells have unknown types, or there are too many for the memory.
    pub(super) fn extract(piece: &Piece, budget: &mut Budget) -> Result<Self> {
        let ghosts = piece.cell_data.get(GHOSTS);
        let ghost = |cell: usize, points: &[u32]| {
            if piece.has_hidden(points) {
                HIDDEN
            } else {
                ghosts.map_or(0, |ghosts| ghosts.at(cell) as u8)
            }
        };
        let has_ghosts = ghosts.is_some() || piece.point_data.get(GHOSTS).is_some();
        let mut surface = Self::default();
        match &piece.topology {
            Topology::Cells(cells) => surface.add_cells(cells, ghost, budget)?,
            Topology::Grid(size) if has_ghosts => {
                surface.add_cells(&cells_of_grid(*size, budget)?, ghost, budget)?;
            }
            Topology::Grid(size) => surface.add_boundary(*size, budget)?,
        }
        Ok(surface)
    }

    fn polygon(&mut self, cell: usize, corners: &[u32]) {
        let n_before = self.triangles.len();
        self.triangles.extend(fan(corners));
        self.polygons.add(n_before..self.triangles.len());
        self.cells.resize(self.triangles.len(), cell as u32);
    }

    fn add_cells(
        &mut self,
        cells: &Cells,
        ghost: impl Fn(usize, &[u32]) -> u8,
        budget: &mut Budget,
    ) -> Result<()> {
        // Triangulate the flat cells, and collect the faces of the solid ones.
        let (mut faces, mut polygon) = (Vec::new(), Vec::new());
        for cell in 0..cells.len() {
            if cell.is_multiple_of(1 << 16) {
                stop::check().map_err(std::io::Error::other)?;
            }
            let (shape, corners) = cells.get(cell)?;
            let ghost = ghost(cell, corners);
            if ghost & HIDDEN != 0 {
                continue;
            }
            let is_shown = ghost & COPY == 0;
            if let CellShape::Solid(of_cell) = shape {
                budget.take_of::<CellFace>(2 * of_cell.len())?;
                for (number, of_face) in of_cell.iter().enumerate() {
                    polygon.clear();
                    polygon.extend(of_face.iter().map(|corner| corners[*corner as usize]));
                    faces.push(CellFace::new(cell, number, &mut polygon, is_shown));
                }
            } else if shape == CellShape::Polyhedron {
                let of_cell = cells.polyhedra.faces(cell);
                budget.take_of::<CellFace>(2 * of_cell.len())?;
                for (number, of_face) in of_cell.enumerate() {
                    polygon.clear();
                    polygon.extend_from_slice(of_face);
                    faces.push(CellFace::new(cell, number, &mut polygon, is_shown));
                }
            } else if ghost & COPY == 0 {
                budget.take_of::<[u32; 8]>(corners.len())?;
                self.add_flat(cell, shape, corners);
            }
        }
        // Triangulate the faces that only one cell has.
        keep_external(&mut faces, cells.n_points);
        budget.take_of::<[u32; 16]>(faces.len())?;
        for face in faces.iter().filter(|face| face.is_shown) {
            let (shape, corners) = cells.get(face.cell as usize)?;
            if let CellShape::Solid(of_cell) = shape {
                polygon.clear();
                let of_face = of_cell[face.number as usize].iter();
                polygon.extend(of_face.map(|corner| corners[*corner as usize]));
                self.polygon(face.cell as usize, &polygon);
            } else {
                let [cell, number] = [face.cell, face.number].map(|n| n as usize);
                let of_face = cells.polyhedra.face(cell, number);
                budget.take_of::<[u32; 8]>(of_face.len())?;
                self.polygon(cell, of_face);
            }
        }
        Ok(())
    }

    fn add_flat(&mut self, cell: usize, shape: CellShape, corners: &[u32]) {
        match shape {
            CellShape::Polygon(n) => self.polygon(cell, &corners[..n]),
            CellShape::Pixel => {
                let [a, b, c, d] = [corners[0], corners[1], corners[2], corners[3]];
                self.polygon(cell, &[a, b, d, c]);
            }
            CellShape::Strip => {
                for (i, corners) in corners.windows(3).enumerate() {
                    // Every second triangle of a strip is clockwise.
                    let odd = i % 2;
                    self.polygon(cell, &[corners[odd], corners[1 - odd], corners[2]]);
                }
            }
            CellShape::Thin | CellShape::Solid(_) | CellShape::Polyhedron => {}
        }
    }

    /// Adds the outer faces of a grid of solid cells, or all faces of a flat grid.
    fn add_boundary(&mut self, size: [usize; 3], budget: &mut Budget) -> Result<()> {
        let n_cells = size.map(|n| n - 1);
        let flat: Vec<usize> = (0..3).filter(|axis| n_cells[*axis] == 0).collect();
        match flat[..] {
            [] => {
                for (axis, last) in n_cells.into_iter().enumerate() {
                    self.add_layer(size, axis, 0, true, budget)?;
                    self.add_layer(size, axis, last, false, budget)?;
                }
            }
            [axis] => self.add_layer(size, axis, 0, false, budget)?,
            // Lines and points have no surface.
            _ => {}
        }
        Ok(())
    }

    /// Adds the squares of a grid at this index of points along an axis; backward ones face against
    /// the axis.
    fn add_layer(
        &mut self,
        size: [usize; 3],
        axis: usize,
        layer: usize,
        is_backward: bool,
        budget: &mut Budget,
    ) -> Result<()> {
        let strides = [1, size[0], size[0] * size[1]];
        let n_cells = size.map(|n| (n - 1).max(1));
        let cell_strides = [1, n_cells[0], n_cells[0] * n_cells[1]];
        let [right, up] = [(axis + 1) % 3, (axis + 2) % 3];
        budget.take_of::<[u32; 32]>(n_cells[right] * n_cells[up])?;
        let of_layer = layer.min(n_cells[axis] - 1) * cell_strides[axis];
        for j in 0..n_cells[up] {
            for i in 0..n_cells[right] {
                let first = layer * strides[axis] + i * strides[right] + j * strides[up];
                let [along, across] = [strides[right], strides[up]];
                let corners = [first, first + along, first + along + across, first + across];
                let mut corners = corners.map(|point| point as u32);
                if is_backward {
                    corners.reverse();
                }
                let cell = of_layer + i * cell_strides[right] + j * cell_strides[up];
                self.polygon(cell, &corners);
            }
        }
        Ok(())
    }
}

/// A face of a solid cell.
#[derive(Debug)]
struct CellFace {
    /// The least four points in ascending order, on which two cells that share the face agree.
    key: [u32; 4],
    cell: u32,
    /// Index among the faces of the cell.
    number: u32,
    is_shown: bool,
}

impl CellFace {
    /// Creates the face with these points, and sorts them.
    fn new(cell: usize, number: usize, points: &mut [u32], is_shown: bool) -> Self {
        points.sort_unstable();
        let mut key = [u32::MAX; 4];
        for (of_key, point) in key.iter_mut().zip(points) {
            *of_key = *point;
        }
        Self {
            key,
            cell: cell as u32,
            number: number as u32,
            is_shown,
        }
    }
}

/// Removes the faces that several cells share.
fn keep_external(faces: &mut Vec<CellFace>, n_points: usize) {
    // Group the faces by their least points, of which a face without points has none.
    let least = |face: &CellFace| (face.key[0] as usize).min(n_points);
    let mut ends = vec![0; n_points + 1];
    for face in faces.iter() {
        ends[least(face)] += 1;
    }
    let mut n_before = 0;
    for end in &mut ends {
        n_before += std::mem::replace(end, n_before);
    }
    let mut grouped = vec![0; faces.len()];
    for (index, face) in faces.iter().enumerate() {
        let end = &mut ends[least(face)];
        grouped[*end] = index;
        *end += 1;
    }
    // Compare the faces of each group.
    let mut is_shared = vec![false; faces.len()];
    let mut begin = 0;
    for end in ends {
        let group = &mut grouped[begin..end];
        group.sort_unstable_by_key(|&index| faces[index].key);
        let several = group.chunk_by(|&a, &b| faces[a].key == faces[b].key);
        for same in several.filter(|same| same.len() > 1) {
            same.iter().for_each(|&index| is_shared[index] = true);
        }
        begin = end;
    }
    let mut is_shared = is_shared.into_iter();
    faces.retain(|_| !is_shared.next().unwrap_or_default());
}

/// Returns the cells of a grid one by one.
fn cells_of_grid(size: [usize; 3], budget: &mut Budget) -> Result<Cells> {
    let n_points = size.iter().product();
    budget.take_of::<[u32; 16]>(n_points)?;
    let mut cells = Cells::of_points(n_points);
    let [nx, ny, nz] = size.map(|n| (n - 1).max(1));
    let thick: Vec<usize> = (0..3).filter(|axis| size[*axis] > 1).collect();
    let strides = [1, size[0], size[0] * size[1]];
    // Pixels and voxels.
    let cell_type = [1, 3, 8, 11][thick.len()];
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                let first = i * strides[0] + j * strides[1] + k * strides[2];
                let corner = |corner: usize| {
                    let along = (0..thick.len()).filter(|bit| corner >> bit & 1 == 1);
                    first + along.map(|bit| strides[thick[bit]]).sum::<usize>()
                };
                let corners = (0..1 << thick.len()).map(|at| corner(at) as f64);
                cells.push(f64::from(cell_type), corners)?;
            }
        }
    }
    Ok(cells)
}
