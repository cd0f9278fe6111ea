//! The types of VTK's cells, and their faces.
//!
//! The numbers of the types and the order of the corners follow vtkCellType.h and "VTK File
//! Formats" (The VTK User's Guide, Kitware, 2010, figures 2 and 3).

use super::super::{FileFault, FileLocation, Result};
use super::budget::Budget;
use super::numbers::Numbers;
use super::polyhedra::Polyhedra;

/// Cells of any types.
#[derive(Debug, Default)]
pub(super) struct Cells {
    /// Number of points of the piece.
    pub(super) n_points: usize,
    types: Vec<u8>,
    /// The end of each cell's corners.
    ends: Vec<usize>,
    /// Indices of points.
    corners: Vec<u32>,
    /// The faces of polyhedra.
    pub(super) polyhedra: Polyhedra,
}

/// The shape of a cell, ignoring the points on its edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CellShape {
    /// Points or lines: no surface.
    Thin,
    /// A polygon given by its first corners, in order around it.
    Polygon(usize),
    /// A rectangle, given row by row.
    Pixel,
    /// Triangles, each of which shares two corners with the one before.
    Strip,
    /// Faces as corner numbers, counter-clockwise as seen from outside.
    Solid(&'static [&'static [u8]]),
    /// Any number of flat faces, which are in [`Cells::polyhedra`].
    Polyhedron,
}

const TETRA: &[&[u8]] = &[&[0, 1, 3], &[1, 2, 3], &[2, 0, 3], &[0, 2, 1]];
pub(super) const VOXEL: &[&[u8]] = &[
    &[0, 4, 6, 2],
    &[1, 3, 7, 5],
    &[0, 1, 5, 4],
    &[2, 6, 7, 3],
    &[0, 2, 3, 1],
    &[4, 5, 7, 6],
];
const HEXAHEDRON: &[&[u8]] = &[
    &[0, 4, 7, 3],
    &[1, 2, 6, 5],
    &[0, 1, 5, 4],
    &[3, 7, 6, 2],
    &[0, 3, 2, 1],
    &[4, 5, 6, 7],
];
const WEDGE: &[&[u8]] = &[
    &[0, 1, 2],
    &[3, 5, 4],
    &[0, 3, 4, 1],
    &[1, 4, 5, 2],
    &[2, 5, 3, 0],
];
const PYRAMID: &[&[u8]] = &[
    &[0, 3, 2, 1],
    &[0, 1, 4],
    &[1, 2, 4],
    &[2, 3, 4],
    &[3, 0, 4],
];
const PENTAGONAL_PRISM: &[&[u8]] = &[
    &[0, 4, 3, 2, 1],
    &[5, 6, 7, 8, 9],
    &[0, 1, 6, 5],
    &[1, 2, 7, 6],
    &[2, 3, 8, 7],
    &[3, 4, 9, 8],
    &[4, 0, 5, 9],
];
const HEXAGONAL_PRISM: &[&[u8]] = &[
    &[0, 5, 4, 3, 2, 1],
    &[6, 7, 8, 9, 10, 11],
    &[0, 1, 7, 6],
    &[1, 2, 8, 7],
    &[2, 3, 9, 8],
    &[3, 4, 10, 9],
    &[4, 5, 11, 10],
    &[5, 0, 6, 11],
];

/// The types of polydata.
pub(super) const POLY_VERTEX: u8 = 2;
pub(super) const POLY_LINE: u8 = 4;
pub(super) const STRIP: u8 = 6;
pub(super) const POLYGON: u8 = 7;
const POLYHEDRON: u8 = 42;

impl CellShape {
    /// Returns the shape of a cell of a type with `n` points; `None` for unknown types. Curved
    /// cells list their corners before the points on their edges.
    pub(super) fn new(cell_type: u8, n: usize) -> Option<Self> {
        Some(match cell_type {
            // Nothing, vertices, lines; curves.
            0..=4 | 21 | 35 | 68 | 75 => Self::Thin,
            5 | 22 | 34 | 69 | 76 => Self::Polygon(3),
            6 => Self::Strip,
            7 => Self::Polygon(n),
            8 => Self::Pixel,
            9 | 23 | 28 | 30 | 70 | 77 => Self::Polygon(4),
            10 | 24 | 71 | 78 => Self::Solid(TETRA),
            11 => Self::Solid(VOXEL),
            12 | 25 | 29 | 33 | 72 | 79 => Self::Solid(HEXAHEDRON),
            13 | 26 | 31 | 32 | 73 | 80 => Self::Solid(WEDGE),
            14 | 27 | 37 | 74 | 81 => Self::Solid(PYRAMID),
            15 => Self::Solid(PENTAGONAL_PRISM),
            16 => Self::Solid(HEXAGONAL_PRISM),
            36 => Self::Polygon(n / 2),
            POLYHEDRON => Self::Polyhedron,
            _ => return None,
        })
    }

    /// Returns the minimum number of points of such a cell.
    pub(super) fn min_points(self) -> usize {
        match self {
            Self::Thin | Self::Polyhedron => 0,
            Self::Polygon(n) => n.max(3),
            Self::Pixel => 4,
            Self::Strip => 3,
            Self::Solid(faces) => {
                let corners = faces.iter().flat_map(|face| face.iter());
                corners.max().map_or(0, |last| usize::from(*last) + 1)
            }
        }
    }
}

impl Cells {
    pub(super) fn of_points(n_points: usize) -> Self {
        Self {
            n_points,
            ..Self::default()
        }
    }

    /// Returns the number of cells.
    pub(super) fn len(&self) -> usize {
        self.types.len()
    }

    /// Adds cells of these types, whose corners end at `ends` in `connectivity`.
    ///
    /// # Errors
    /// Ends or points do not exist, or there are too many for the memory.
    pub(super) fn add(
        &mut self,
        types: impl Fn(usize) -> f64,
        n_cells: usize,
        ends: &Numbers,
        connectivity: &Numbers,
        budget: &mut Budget,
    ) -> Result<()> {
        // Some files give the start of the first cell too.
        let n_before = usize::from(ends.len() > n_cells);
        ends.check("offsets", n_cells + n_before)?;
        budget.take_of::<[u32; 4]>(n_cells)?;
        budget.take_of::<u32>(connectivity.len())?;
        let mut begin = 0;
        for cell in 0..n_cells {
            let end = ends.at(n_before + cell);
            let in_range = end >= begin as f64 && end <= connectivity.len() as f64;
            if !in_range {
                let problem = format!("its corners end at {end} of {}", connectivity.len());
                let fault = FileFault::new(problem, format!("at {begin} or later"));
                return Err(fault.at(at_cell(self.len())));
            }
            let corners = begin..end as usize;
            self.push(types(cell), corners.map(|i| connectivity.at(i)))?;
            begin = end as usize;
        }
        Ok(())
    }

    /// Adds a cell.
    ///
    /// # Errors
    /// A point does not exist.
    pub(super) fn push(&mut self, cell_type: f64, points: impl Iterator<Item = f64>) -> Result<()> {
        for point in points {
            if !(point >= 0.0 && point < self.n_points as f64) {
                let problem = format!("there is no point {point}");
                let expected = format!(
                    "one of the {} points, of which the first is 0",
                    self.n_points
                );
                return Err(FileFault::new(problem, expected).at(at_cell(self.len())));
            }
            self.corners.push(point as u32);
        }
        self.types.push(cell_type as u8);
        self.ends.push(self.corners.len());
        Ok(())
    }

    /// Returns true if there are polyhedra.
    pub(super) fn has_polyhedra(&self) -> bool {
        self.types.contains(&POLYHEDRON)
    }

    /// Returns the points of a cell in order along it, if it is a line.
    pub(super) fn line(&self, cell: usize) -> Option<impl ExactSizeIterator<Item = u32> + '_> {
        let (cell_type, points) = (self.types[cell], self.points(cell));
        // Curves list their ends before the points between them.
        let is_curve = match cell_type {
            3 | POLY_LINE => false,
            21 | 35 | 68 => true,
            _ => return None,
        };
        let n = points.len();
        let at = move |i| match i {
            0 => 0,
            _ if !is_curve => i,
            _ if i == n - 1 => 1,
            _ => i + 1,
        };
        Some((0..n).map(move |i| points[at(i)]))
    }

    /// Returns the points of a cell.
    fn points(&self, cell: usize) -> &[u32] {
        let begin = cell.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.corners[begin..self.ends[cell]]
    }

    /// Returns the fault of a polyhedron whose faces do not close it.
    pub(super) fn open_polyhedron(&self, cell: usize) -> FileFault {
        let expected = "each of its edges in two of its faces";
        FileFault::new("the faces of this polyhedron leave a hole", expected).at(at_cell(cell))
    }

    /// Returns the shape and the points of a cell.
    ///
    /// # Errors
    /// The cell has an unknown type, or too few points.
    pub(super) fn get(&self, cell: usize) -> Result<(CellShape, &[u32])> {
        let corners = self.points(cell);
        let (cell_type, n) = (self.types[cell], corners.len());
        let is_bare = cell_type == POLYHEDRON && self.polyhedra.faces(cell).len() == 0;
        let shape = CellShape::new(cell_type, n).filter(|_| !is_bare);
        let shape = shape.ok_or_else(|| {
            let what = match cell_type {
                41 => "a convex point set".to_owned(),
                POLYHEDRON => "a polyhedron without faces".to_owned(),
                _ => format!("of the type {cell_type}"),
            };
            let expected = "triangles, quads, polygons, strips, pixels, tetrahedra, voxels, \
                 hexahedra, wedges, pyramids, prisms or, in XML files, polyhedra (ParaView's filter Extract Surface makes \
                 polygons of all cells)";
            FileFault::new(format!("it is {what}"), expected).at(at_cell(cell))
        })?;
        if n < shape.min_points() {
            let problem = format!("it has {n} points");
            let expected = format!("at least {}", shape.min_points());
            return Err(FileFault::new(problem, expected).at(at_cell(cell)));
        }
        Ok((shape, corners))
    }
}

fn at_cell(cell: usize) -> FileLocation {
    FileLocation::Element("cell".into(), cell as u64)
}
