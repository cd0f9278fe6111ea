//! The arrays of points of a VTK file.

use std::ops::Range;

use host::text::Diagnostic;
use render::film::{Column, columns};
use scene::config::{CostMode, Repeats};
use vtk::read::{ArrayLocation, ArrayValues, DataArrayElement, Selection, VtkReader};

/// The header of an array.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArrayInfo {
    /// Name.
    pub name: String,
    /// VTK's type of the numbers: `Float32`, `UInt32`, …
    pub vtk_type: String,
    /// Numbers per pixel or point.
    pub n_components: usize,
}

/// An array in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedArray {
    /// Name.
    pub name: String,
    /// Numbers per pixel or point.
    pub n_components: usize,
    /// Numbers, with the components of a pixel or point interleaved.
    pub values: ArrayValues,
}

impl LoadedArray {
    /// Appends the tuples of the same array in the next piece; false if the types differ.
    pub(super) fn append(&mut self, next: &Self) -> bool {
        self.n_components == next.n_components && self.values.append(&next.values)
    }
}

/// The point arrays of a file.
#[derive(Debug)]
pub(super) struct Arrays {
    pub(super) file: VtkReader,
    /// The arrays that the scene chose; `None` if the file has all, or if unknown.
    pub(super) chosen: Option<Vec<String>>,
    pub(super) infos: Vec<ArrayInfo>,
    places: Vec<ArrayLocation>,
}

impl Arrays {
    /// Lists the arrays of a file with this many tuples.
    pub(super) fn new(
        file: VtkReader,
        arrays: &[DataArrayElement],
        n_tuples: u64,
    ) -> Result<Self, Diagnostic> {
        let info = |array: &DataArrayElement| ArrayInfo {
            name: array.name.clone(),
            vtk_type: array.scalar.clone(),
            n_components: array.n_components as usize,
        };
        let infos = arrays.iter().map(info).collect();
        let place = |array| file.place(array, n_tuples);
        let places: Vec<ArrayLocation> = arrays.iter().map(place).collect::<Result<_, _>>()?;
        file.check_overlap(&places)?;
        Ok(Self {
            file,
            chosen: None,
            infos,
            places,
        })
    }

    pub(super) fn position(&self, name: &str) -> Option<usize> {
        self.infos.iter().position(|info| info.name == name)
    }

    fn index(&self, name: &str) -> Result<usize, Diagnostic> {
        self.position(name).ok_or_else(|| self.missing(name))
    }

    /// Reads rows of an array that the file stores in `n_rows` rows, bottom row first; returns the
    /// upper row first.
    pub(super) fn read(
        &self,
        name: &str,
        n_rows: usize,
        rows: Range<usize>,
    ) -> Result<LoadedArray, Diagnostic> {
        let index = self.index(name)?;
        Ok(LoadedArray {
            name: name.to_owned(),
            n_components: self.infos[index].n_components,
            values: self.file.read_rows(&self.places[index], n_rows, rows)?,
        })
    }

    /// Reads the selected pixels of an array of an image of this size.
    pub(super) fn read_selected(
        &self,
        name: &str,
        size: [usize; 2],
        [columns, rows]: [&[u32]; 2],
    ) -> Result<LoadedArray, Diagnostic> {
        let index = self.index(name)?;
        let n_components = self.infos[index].n_components;
        let selection = Selection {
            size,
            n_components,
            columns,
            rows,
        };
        Ok(LoadedArray {
            name: name.to_owned(),
            n_components,
            values: self.file.read_selected(&self.places[index], &selection)?,
        })
    }

    /// Checks that the file has these arrays.
    ///
    /// # Errors
    /// Arrays are missing; the message says how to write them.
    pub(super) fn require(&self, names: &[&str]) -> Result<(), Diagnostic> {
        let mut missing = names.iter().filter(|name| self.position(name).is_none());
        match (missing.next(), &self.chosen) {
            (None, _) => Ok(()),
            (Some(first), None) => Err(self.missing(first)),
            (Some(first), Some(_)) => {
                let all: Vec<&str> = std::iter::once(first).chain(missing).copied().collect();
                Err(self.left_out(&all))
            }
        }
    }

    /// Returns the error for arrays that the scene did not choose.
    fn left_out(&self, names: &[&str]) -> Diagnostic {
        let path = self.file.path.display();
        let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        let (arrays, them) = match names {
            [_] => ("array", "it"),
            _ => ("arrays", "them"),
        };
        let list = quoted.join(", ");
        let message = format!("`{path}` has no {arrays} {list}: `output.arrays` leaves {them} out");
        Diagnostic::new(message)
            .with_help(format!("add {list} to `output.arrays`, and render again"))
    }

    /// Returns the error for a missing array, with the option that writes it.
    fn missing(&self, name: &str) -> Diagnostic {
        let is_left_out = |chosen: &Vec<String>| chosen.iter().all(|other| other != name);
        if self.chosen.as_ref().is_some_and(is_left_out) {
            return self.left_out(&[name]);
        }
        let path = self.file.path.display();
        let error = Diagnostic::new(format!("`{path}` has no array `{name}`"));
        let written_with = |mode, repeats| columns(mode, repeats).any(|column| column.name == name);
        if written_with(CostMode::Counters, Repeats::ONCE) {
            return error.with_help("render again without `--no-cost`");
        }
        if written_with(CostMode::Time, Repeats::ONCE) {
            return error.with_help("render again with `--cost time`");
        }
        if written_with(CostMode::Time, Repeats::Auto) {
            return error.with_help("render again with `--repeats 10`");
        }
        if name == Column::RADIANCE.name {
            return error.with_help("render again with `--also radiance`");
        }
        let names: Vec<&str> = self.infos.iter().map(|info| info.name.as_str()).collect();
        error.with_help(format!("its arrays are {}", names.join(", ")))
    }
}
