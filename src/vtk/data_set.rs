//! The data sets that can be written.

use std::fmt;

use crate::array::Array;

/// A data set with its arrays.
pub enum DataSet<'a> {
    /// A regular grid of points with spacing 1, or a piece of one; the first point of the grid is
    /// at the origin.
    Image {
        /// The location of the points in the whole grid.
        extent: Extent,
        /// One entry per point, row by row from the bottom.
        point_data: Vec<Array<'a>>,
    },
    /// A regular grid of square cells.
    ImageCells {
        /// Columns and rows.
        size: [u32; 2],
        /// The lower left corner of the first cell.
        origin: [f64; 2],
        /// The side of a cell.
        spacing: f64,
        /// One entry per cell, row by row from the bottom.
        cell_data: Vec<Array<'a>>,
    },
    /// Cells of any type; the last array of `cells` is `types`.
    Grid(CellMesh<'a>),
    /// Lines only.
    Lines(CellMesh<'a>),
}

/// The first and the last column and row of a plane of points, both included. VTK orders rows
/// from bottom to top.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extent {
    /// The first and the last column.
    pub columns: [u32; 2],
    /// The first and the last row, from the bottom.
    pub rows: [u32; 2],
}

impl Extent {
    /// Returns the extent of `width` columns and `height` rows, at least one each.
    pub fn of_size([width, height]: [u32; 2]) -> Self {
        Self {
            columns: [0, width - 1],
            rows: [0, height - 1],
        }
    }
}

/// Formats as in VTK's files.
impl fmt::Display for Extent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([left, right], [bottom, top]) = (self.columns, self.rows);
        write!(f, "{left} {right} {bottom} {top} 0 0")
    }
}

/// Points and cells with their arrays.
pub struct CellMesh<'a> {
    /// Number of points.
    pub n_points: usize,
    /// Number of cells.
    pub n_cells: usize,
    /// Arrays with one entry per point.
    pub point_data: Vec<Array<'a>>,
    /// Arrays with one entry per cell.
    pub cell_data: Vec<Array<'a>>,
    /// The points' coordinates.
    pub points: Array<'a>,
    /// `connectivity` and `offsets`, see
    /// [`separate_cells`](super::array::separate_cells).
    pub cells: Vec<Array<'a>>,
}

impl<'a> DataSet<'a> {
    /// Returns all arrays in the order of the file.
    pub fn arrays(&self) -> Vec<&Array<'a>> {
        match self {
            Self::Image { point_data, .. } => point_data.iter().collect(),
            Self::ImageCells { cell_data, .. } => cell_data.iter().collect(),
            Self::Grid(mesh) | Self::Lines(mesh) => mesh.arrays().collect(),
        }
    }
}

impl<'a> CellMesh<'a> {
    fn arrays(&self) -> impl Iterator<Item = &Array<'a>> {
        let data = self.point_data.iter().chain(&self.cell_data);
        data.chain([&self.points]).chain(&self.cells)
    }
}
