//! Images.

use hdf5_metno::Group;

use super::super::super::{FileFault, Result};
use super::super::numbers::Numbers;
use super::super::piece::{Lattice, Piece, PieceArrays, PointPositions, Topology, grid_size};
use super::super::xml::IDENTITY;
use super::reader::HdfReader;
use super::rows::missing;
use super::values::numbers;
use crate::fault::cut;

impl HdfReader<'_> {
    /// Reads an image.
    pub(super) fn image(&mut self) -> Result<Piece> {
        let extent: [i64; 6] = numbers(&self.root, "WholeExtent")?;
        let size = grid_size(extent)?;
        let has_direction = self.root.attr("Direction").is_ok();
        let lattice = Lattice {
            size,
            first: [extent[0], extent[2], extent[4]],
            origin: numbers(&self.root, "Origin")?,
            spacing: numbers(&self.root, "Spacing")?,
            direction: if has_direction {
                numbers(&self.root, "Direction")?
            } else {
                IDENTITY
            },
        };
        let of_cells = size.map(|n| (n - 1).max(1));
        let piece = Piece {
            points: PointPositions::Lattice(lattice),
            topology: Topology::Grid(size),
            point_data: self.image_attributes("PointData", size)?,
            cell_data: self.image_attributes("CellData", of_cells)?,
        };
        piece.check()?;
        Ok(piece)
    }

    /// Reads the arrays of an image, layer by layer; over time, the first index is the step.
    fn image_attributes(&mut self, group_name: &str, size: [usize; 3]) -> Result<PieceArrays> {
        self.arrays_of(group_name, |reader, group, name| {
            reader.image_array(group, group_name, name, size)
        })
    }

    fn image_array(
        &mut self,
        group: &Group,
        group_name: &str,
        name: &str,
        [nx, ny, nz]: [usize; 3],
    ) -> Result<Numbers> {
        let dataset = self.datasets.open(group, name)?;
        let dataset = dataset.ok_or_else(|| missing(name))?;
        let before = match &self.steps {
            None => vec![],
            Some(_) => vec![self.array_begin(group_name, name)?.unwrap_or(self.step)],
        };
        let shape = dataset.shape();
        let of_step = shape.get(before.len()..).unwrap_or_default();
        // Axes of one layer may be left out.
        let all = [nz, ny, nx];
        let thick: Vec<usize> = all.into_iter().filter(|n| *n > 1).collect();
        let sides = [&all[..], &thick]
            .into_iter()
            .find(|of| of_step.starts_with(of));
        let Some(sides) = sides.filter(|sides| !sides.is_empty()) else {
            let problem = format!("the dataset `{}` has the shape {shape:?}", cut(name));
            let expected = format!("{nz} times {ny} times {nx}");
            return Err(FileFault::new(problem, expected));
        };
        let n_components = of_step[sides.len()..].iter().product();
        let rows = 0..of_step[0];
        let numbers = self.datasets.rows(&dataset, name, &before, rows)?;
        Ok(numbers.in_tuples_of(n_components))
    }
}
