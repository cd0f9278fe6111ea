//! The data sets that can be written.

use super::array::Array;

/// A data set with its arrays.
pub(crate) enum DataSet<'a> {
    /// A regular grid of points with spacing 1 and its first point at the origin.
    Image {
        /// Columns and rows.
        size: [u32; 2],
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
        cell_data: Vec<Array<'a>>,
    },
    /// Cells of any type; the last array of `cells` is `types`.
    Grid(CellMesh<'a>),
    /// Lines only.
    Lines(CellMesh<'a>),
}

/// Points and cells with their arrays.
pub(crate) struct CellMesh<'a> {
    pub(crate) n_points: usize,
    pub(crate) n_cells: usize,
    pub(crate) point_data: Vec<Array<'a>>,
    pub(crate) cell_data: Vec<Array<'a>>,
    /// The points' coordinates.
    pub(crate) points: Array<'a>,
    /// `connectivity` and `offsets`, see
    /// [`separate_cells`](super::array::separate_cells).
    pub(crate) cells: Vec<Array<'a>>,
}

impl<'a> DataSet<'a> {
    /// Returns all arrays in the order of the file.
    pub(crate) fn arrays(&self) -> Vec<&Array<'a>> {
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
