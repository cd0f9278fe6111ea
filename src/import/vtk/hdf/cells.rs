//! The cells of a part of a data set.

use hdf5_metno::Group;

use super::super::super::{FileFault, Result};
use super::super::cells::{Cells, POLY_LINE, POLY_VERTEX, POLYGON, STRIP};
use super::super::polyhedra::Polyhedra;
use super::reader::{HdfPart, HdfReader, entry, sum};

impl HdfReader<'_> {
    /// Returns the cells of a part of an unstructured grid.
    pub(super) fn grid(&mut self, part: &HdfPart) -> Result<Cells> {
        let root = self.root.clone();
        let mut cells = Cells::of_points(part.points[1]);
        let [first_cell, _] = self.cell_begins(0)?;
        let n_cells = self.list(&root, "NumberOfCells")?;
        let n_cells = entry(&n_cells, part.index, "NumberOfCells")?;
        let begin = sum([first_cell, part.cells_before])?;
        let types = self.numbers(&root, "Types", begin, n_cells)?;
        self.add_cells(&mut cells, &root, part, 0, |cell| types.at(cell))?;
        if cells.has_polyhedra() {
            cells.polyhedra = self.polyhedra(part, n_cells)?;
        }
        Ok(cells)
    }

    /// Returns the faces of the cells of a part.
    fn polyhedra(&mut self, part: &HdfPart, n_cells: usize) -> Result<Polyhedra> {
        if self.steps.is_some() {
            let expected = "a file without time steps, or without polyhedra";
            return Err(FileFault::new("it has polyhedra over time", expected));
        }
        let root = self.root.clone();
        // The sizes of the part, and of the parts before it.
        let mut sizes = |name| -> Result<(usize, usize)> {
            let of_parts = self.list(&root, name)?;
            let before = (0..part.index).map(|i| entry(&of_parts, i, name));
            let before = sum(before.collect::<Result<Vec<_>>>()?)?;
            Ok((before, entry(&of_parts, part.index, name)?))
        };
        let (faces_before, n_faces) = sizes("NumberOfFaces")?;
        let (points_before, n_points) = sizes("NumberOfFaceConnectivityIds")?;
        let (ids_before, n_ids) = sizes("NumberOfPolyhedronToFaceIds")?;
        // Each list of ends begins with the start of the first.
        let first_face_end = sum([faces_before, part.index, 1])?;
        let first_end = sum([part.cells_before, part.index, 1])?;
        let arrays = [
            self.numbers(&root, "FaceConnectivity", points_before, n_points)?,
            self.numbers(&root, "FaceOffsets", first_face_end, n_faces)?,
            self.numbers(&root, "PolyhedronToFaces", ids_before, n_ids)?,
            self.numbers(&root, "PolyhedronOffsets", first_end, n_cells)?,
        ];
        let n_points = part.points[1];
        Polyhedra::of_arrays(arrays.each_ref(), n_points, self.datasets.budget)
    }

    /// Returns the cells of a part of polydata, in the order of the cells' arrays.
    pub(super) fn polydata(&mut self, part: &HdfPart) -> Result<Cells> {
        let mut cells = Cells::of_points(part.points[1]);
        let kinds = [
            ("Vertices", POLY_VERTEX),
            ("Lines", POLY_LINE),
            ("Polygons", POLYGON),
            ("Strips", STRIP),
        ];
        for (column, (name, cell_type)) in kinds.into_iter().enumerate() {
            if let Ok(group) = self.root.group(name) {
                self.add_cells(&mut cells, &group, part, column, |_| cell_type.into())?;
            }
        }
        Ok(cells)
    }

    /// Adds the cells of a part from a group.
    fn add_cells(
        &mut self,
        cells: &mut Cells,
        group: &Group,
        part: &HdfPart,
        column: usize,
        types: impl Fn(usize) -> f64,
    ) -> Result<()> {
        let [first_cell, first_id] = self.cell_begins(column)?;
        let of_parts = self.list(group, "NumberOfCells")?;
        let ids_of_parts = self.list(group, "NumberOfConnectivityIds")?;
        let first_of_step = part.index - part.of_step;
        let before = |counts: &[i64], name| {
            let range = first_of_step..part.index;
            range
                .map(|i| entry(counts, i, name))
                .collect::<Result<Vec<_>>>()
        };
        let n_cells = entry(&of_parts, part.index, "NumberOfCells")?;
        let n_ids = entry(&ids_of_parts, part.index, "NumberOfConnectivityIds")?;
        let cells_before = sum(before(&of_parts, "NumberOfCells")?)?;
        let ids_before = sum(before(&ids_of_parts, "NumberOfConnectivityIds")?)?;
        // Each part has one end more than cells: the start of the first.
        let first_end = sum([first_cell, first_of_step, cells_before, part.of_step])?;
        let ends = self.numbers(group, "Offsets", first_end, sum([n_cells, 1])?)?;
        let ids = self.numbers(group, "Connectivity", sum([first_id, ids_before])?, n_ids)?;
        cells.add(types, n_cells, &ends, &ids, self.datasets.budget)
    }
}
