//! The contents of a legacy file's sections, and their conversion to a piece.

use super::super::budget::Budget;
use super::super::cells::{Cells, POLY_LINE, POLY_VERTEX, POLYGON, STRIP};
use super::super::numbers::Numbers;
use super::super::piece::{Lattice, Piece, PieceArrays, PointPositions, Topology};
use super::super::xml::IDENTITY;
use crate::fault::cut;
use crate::{FileFault, Result};

/// The sections of a file read so far.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub(super) points: Option<Numbers>,
    pub(super) axes: [Option<Numbers>; 3],
    pub(super) size: Option<[usize; 3]>,
    pub(super) origin: [f64; 3],
    pub(super) spacing: Option<[f64; 3]>,
    /// The cells by their sections: the ends of cells and their points.
    pub(super) cells: Vec<(String, CellArray)>,
    pub(super) types: Option<Numbers>,
    pub(super) point_data: PieceArrays,
    pub(super) cell_data: PieceArrays,
    /// The kind of the arrays that follow, and their number of tuples.
    pub(super) data_of: Option<(DataOf, usize)>,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum DataOf {
    Points,
    Cells,
}

/// Cells: the end of each cell's points, and the points of all.
#[derive(Debug)]
pub(super) struct CellArray {
    pub(super) ends: Numbers,
    pub(super) points: Numbers,
}

impl Parts {
    /// Returns the arrays to which the next ones are added.
    pub(super) fn attributes(&mut self) -> Option<&mut PieceArrays> {
        Some(match self.data_of?.0 {
            DataOf::Points => &mut self.point_data,
            DataOf::Cells => &mut self.cell_data,
        })
    }

    pub(super) fn piece(mut self, kind: &str, budget: &mut Budget) -> Result<Piece> {
        let points = self
            .points
            .take()
            .unwrap_or_else(|| Numbers::from_text(Vec::new()));
        let points = points.in_tuples_of(3);
        let (points, topology) = match kind {
            "POLYDATA" | "UNSTRUCTURED_GRID" => {
                let cells = self.cells(points.len() / 3, budget)?;
                (PointPositions::Explicit(points), Topology::Cells(cells))
            }
            "STRUCTURED_GRID" => (
                PointPositions::Explicit(points),
                Topology::Grid(self.size()?),
            ),
            "RECTILINEAR_GRID" => {
                let size = self.size()?;
                let axes = self
                    .axes
                    .map(|axis| axis.unwrap_or_else(|| Numbers::from_text(Vec::new())));
                for (axis, n) in axes.iter().zip(size) {
                    axis.check("COORDINATES", n)?;
                }
                (PointPositions::Axes(axes), Topology::Grid(size))
            }
            "STRUCTURED_POINTS" => {
                let size = self.size()?;
                let lattice = Lattice {
                    size,
                    first: [0; 3],
                    origin: self.origin,
                    spacing: self.spacing.unwrap_or([1.0; 3]),
                    direction: IDENTITY,
                };
                (PointPositions::Lattice(lattice), Topology::Grid(size))
            }
            _ => {
                let problem = format!("it is a data set of the type `{}`", cut(kind));
                let expected = "POLYDATA, UNSTRUCTURED_GRID, STRUCTURED_GRID, RECTILINEAR_GRID \
                     or STRUCTURED_POINTS";
                return Err(FileFault::new(problem, expected));
            }
        };
        Ok(Piece {
            points,
            topology,
            point_data: self.point_data,
            cell_data: self.cell_data,
        })
    }

    fn size(&self) -> Result<[usize; 3]> {
        let missing = || FileFault::new("it has no `DIMENSIONS`", "the dimensions of the grid");
        self.size.ok_or_else(missing)
    }

    /// Returns the cells, in the order of the cell arrays.
    fn cells(&self, n_points: usize, budget: &mut Budget) -> Result<Cells> {
        let mut cells = Cells::of_points(n_points);
        for (name, cell_type) in [
            ("VERTICES", Some(POLY_VERTEX)),
            ("LINES", Some(POLY_LINE)),
            ("POLYGONS", Some(POLYGON)),
            ("TRIANGLE_STRIPS", Some(STRIP)),
            ("CELLS", None),
        ] {
            let sections = self.cells.iter().filter(|(known, _)| known == name);
            for (_, CellArray { ends, points }) in sections {
                // The first end is the start of the first cell.
                let n_cells = ends.len().saturating_sub(1);
                let types = match cell_type {
                    Some(cell_type) => vec![f64::from(cell_type); n_cells],
                    None => self.types.iter().flat_map(Numbers::iter).collect(),
                };
                if types.len() != n_cells {
                    let problem = format!("{n_cells} cells have {} types", types.len());
                    return Err(FileFault::new(problem, "`CELL_TYPES` with one for each"));
                }
                cells.add(|cell| types[cell], n_cells, ends, points, budget)?;
            }
        }
        Ok(cells)
    }
}
