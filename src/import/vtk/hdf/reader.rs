//! The parts of a time step, and the datasets that they share.

use hdf5_metno::Group;

use super::super::super::{FileFault, Result};
use super::super::cells::Cells;
use super::super::numbers::Numbers;
use super::super::piece::{Piece, PointPositions, Topology, Wanted};
use super::rows::{Datasets, damaged, missing};

pub(super) struct HdfReader<'a> {
    pub(super) root: Group,
    /// The group of time steps, if there are any.
    pub(super) steps: Option<Group>,
    pub(super) step: usize,
    pub(super) wanted: &'a Wanted<'a>,
    pub(super) datasets: Datasets<'a>,
}

/// The rows of the datasets that belong to a part of a time step.
pub(super) struct HdfPart {
    /// Index among the parts of all steps.
    pub(super) index: usize,
    /// Index among the parts of its step.
    pub(super) of_step: usize,
    /// The number of points in the step's parts before it, and in the part.
    pub(super) points: [usize; 2],
    /// The start of the step's point arrays, and of its cell arrays.
    pub(super) first_point: usize,
    /// The number of cells in the step's parts before it.
    pub(super) cells_before: usize,
}

impl HdfReader<'_> {
    /// Checks that the time step exists.
    pub(super) fn check_step(&self) -> Result<()> {
        let n_steps = match &self.steps {
            None => 1,
            Some(steps) => {
                let n = steps.attr("NSteps").and_then(|n| n.read_scalar::<i64>());
                let n = n.map_err(|error| damaged("Steps/NSteps", &error))?;
                usize::try_from(n).unwrap_or(0)
            }
        };
        if self.step < n_steps {
            return Ok(());
        }
        let problem = format!("it has no time step {}", self.step);
        let expected = format!("one of its {n_steps}, of which the first is 0");
        Err(FileFault::new(problem, expected))
    }

    /// Returns the time step's number in a list of the group of steps; `None` without steps or
    /// list.
    fn of_step(&mut self, name: &str) -> Result<Option<usize>> {
        let Some(steps) = self.steps.clone() else {
            return Ok(None);
        };
        let Some(row) = self.row_of_step(&steps, name)? else {
            return Ok(None);
        };
        entry(&row, 0, name).map(Some)
    }

    /// Returns the time step's row in a table of a group.
    pub(super) fn row_of_step(&mut self, group: &Group, name: &str) -> Result<Option<Vec<i64>>> {
        let Some(dataset) = self.datasets.open(group, name)? else {
            return Ok(None);
        };
        let step = self.step..self.step + 1;
        let numbers = self.datasets.rows(&dataset, name, &[], step)?;
        Ok(Some(numbers.iter().map(|number| number as i64).collect()))
    }

    /// Reads a list of the root.
    pub(super) fn list(&mut self, group: &Group, name: &str) -> Result<Vec<i64>> {
        let found = self.datasets.list(group, name)?;
        found.ok_or_else(|| missing(name))
    }

    /// Reads the pieces of the time step, one per part.
    pub(super) fn pieces(
        &mut self,
        topology: impl Fn(&mut Self, &HdfPart) -> Result<Cells>,
    ) -> Result<Vec<Piece>> {
        // Find the parts of the time step.
        let root = self.root.clone();
        let n_points = self.list(&root, "NumberOfPoints")?;
        let first_part = self.of_step("PartOffsets")?.unwrap_or(0);
        let n_parts = match (self.of_step("NumberOfParts")?, &self.steps) {
            (Some(n), _) => n,
            (None, Some(_)) => 1,
            (None, None) => n_points.len(),
        };
        let first_point = self.of_step("PointOffsets")?.unwrap_or(0);
        let mut pieces = Vec::new();
        let (mut points_before, mut cells_before) = (0, 0);
        // Read each part, after the points and cells of the parts before.
        for of_step in 0..n_parts {
            let index = first_part.saturating_add(of_step);
            let n = entry(&n_points, index, "NumberOfPoints")?;
            let part = HdfPart {
                index,
                of_step,
                points: [points_before, n],
                first_point,
                cells_before,
            };
            let begin = sum([first_point, points_before])?;
            let points = self.numbers(&root, "Points", begin, n)?;
            let cells = topology(self, &part)?;
            let n_cells = cells.len();
            let piece = Piece {
                points: PointPositions::Explicit(points.in_tuples_of(3)),
                topology: Topology::Cells(cells),
                point_data: self.attributes("PointData", part.points, part.first_point)?,
                cell_data: self.cell_attributes(&part, n_cells)?,
            };
            piece.check()?;
            pieces.push(piece);
            points_before = sum([points_before, n])?;
            cells_before = sum([cells_before, n_cells])?;
        }
        Ok(pieces)
    }

    /// Reads rows of a dataset.
    pub(super) fn numbers(
        &mut self,
        group: &Group,
        name: &str,
        begin: usize,
        n: usize,
    ) -> Result<Numbers> {
        let dataset = self.datasets.open(group, name)?;
        let dataset = dataset.ok_or_else(|| missing(name))?;
        let rows = begin..sum([begin, n])?;
        self.datasets.rows(&dataset, name, &[], rows)
    }

    /// Returns the start of the cells and of their points for the time step, for one kind of
    /// polydata.
    pub(super) fn cell_begins(&mut self, column: usize) -> Result<[usize; 2]> {
        let Some(steps) = self.steps.clone() else {
            return Ok([0; 2]);
        };
        let mut begin = |name| match self.row_of_step(&steps, name)? {
            Some(row) => entry(&row, column.min(row.len().max(1) - 1), name),
            None => Ok(0),
        };
        Ok([begin("CellOffsets")?, begin("ConnectivityIdOffsets")?])
    }
}

/// Returns an entry of a list of sizes or starts.
pub(super) fn entry(numbers: &[i64], index: usize, name: &str) -> Result<usize> {
    let found = numbers.get(index).and_then(|n| usize::try_from(*n).ok());
    found.ok_or_else(|| {
        let problem = format!("the dataset `{name}` has no number {index} that is 0 or more");
        FileFault::new(problem, "one for each part or time step")
    })
}

/// Adds sizes that a file claims, with a check for overflow.
pub(super) fn sum(sizes: impl IntoIterator<Item = usize>) -> Result<usize> {
    let sum = sizes.into_iter().try_fold(0_usize, usize::checked_add);
    sum.ok_or_else(|| {
        FileFault::new(
            "its sizes are larger than any file",
            "the sizes of its datasets",
        )
    })
}
