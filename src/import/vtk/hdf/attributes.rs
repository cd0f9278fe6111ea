//! Arrays of points and cells, and the attributes of groups and datasets.

use hdf5_metno::Group;

use super::super::super::Result;
use super::super::numbers::Numbers;
use super::super::piece::{PieceArrays, is_wanted};
use super::reader::{HdfPart, HdfReader, entry, sum};
use super::values::{members, text};

impl HdfReader<'_> {
    /// Returns the wanted arrays of the points of a part, which has these rows after the parts
    /// before it; the step's rows begin at `first` unless the file says otherwise.
    pub(super) fn attributes(
        &mut self,
        group_name: &str,
        [before, n]: [usize; 2],
        first: usize,
    ) -> Result<PieceArrays> {
        self.arrays_of(group_name, |reader, group, name| {
            let begin = reader.array_begin(group_name, name)?.unwrap_or(first);
            reader.numbers(group, name, sum([begin, before])?, n)
        })
    }

    /// Returns the wanted arrays of a group, as `read` returns them by name.
    pub(super) fn arrays_of(
        &mut self,
        group_name: &str,
        read: impl Fn(&mut Self, &Group, &str) -> Result<Numbers>,
    ) -> Result<PieceArrays> {
        let mut attributes = PieceArrays::default();
        let Ok(group) = self.root.group(group_name) else {
            return Ok(attributes);
        };
        for name in members(&group, group_name)? {
            let kind = self.name_attribute(&group, &name, &mut attributes)?;
            if kind || is_wanted(&name, self.wanted) {
                let numbers = read(self, &group, &name)?;
                attributes.arrays.push((name.clone(), numbers));
            }
            attributes.names.push(name);
        }
        Ok(attributes)
    }

    pub(super) fn cell_attributes(
        &mut self,
        part: &HdfPart,
        n_cells: usize,
    ) -> Result<PieceArrays> {
        // The arrays of polydata store one kind after the other.
        let row = match self.steps.clone() {
            Some(steps) => self.row_of_step(&steps, "CellOffsets")?.unwrap_or_default(),
            None => Vec::new(),
        };
        let begins = (0..row.len()).map(|column| entry(&row, column, "CellOffsets"));
        let first = sum(begins.collect::<Result<Vec<_>>>()?)?;
        self.attributes("CellData", [part.cells_before, n_cells], first)
    }

    /// Records the name of a dataset that is the active array of normals or of texture coordinates;
    /// returns true if it is one.
    fn name_attribute(
        &self,
        group: &Group,
        name: &str,
        attributes: &mut PieceArrays,
    ) -> Result<bool> {
        let Some(dataset) = self.datasets.open(group, name)? else {
            return Ok(false);
        };
        if !dataset
            .attr_names()
            .is_ok_and(|names| names.iter().any(|name| name == "Attribute"))
        {
            return Ok(false);
        }
        let slot = match text(&dataset, "Attribute")?.as_str() {
            "Normals" => &mut attributes.normals,
            "TCoords" => &mut attributes.uvs,
            _ => return Ok(false),
        };
        *slot = Some(name.to_owned());
        Ok(true)
    }

    /// Returns the start of an array for the time step, if the file gives it.
    pub(super) fn array_begin(&mut self, group_name: &str, name: &str) -> Result<Option<usize>> {
        let offsets = self.steps.as_ref().and_then(|steps| {
            let group = steps.group(&format!("{group_name}Offsets"));
            group.ok()
        });
        let Some(offsets) = offsets else {
            return Ok(None);
        };
        let row = self.row_of_step(&offsets, name)?;
        row.map(|row| entry(&row, 0, name)).transpose()
    }
}
