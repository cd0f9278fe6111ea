//! Field data over time.

use hdf5_metno::Group;
use hdf5_metno::types::{StringError, VarLenAscii};

use super::steps::{table, write_list};
use crate::field::{Field, FieldValues};

/// The field data of all steps.
#[derive(Default)]
pub(super) struct FieldSteps {
    arrays: Vec<FieldOverTime>,
    n_steps: usize,
}

/// An array of field data over time.
struct FieldOverTime {
    name: String,
    /// Values of all steps; equal steps share them.
    values: Vec<FieldValues>,
    /// The start and the number of each step's values among all.
    spans: Vec<[i64; 2]>,
}

impl FieldSteps {
    /// Adds the field data of a step.
    pub(super) fn append(&mut self, fields: &[Field]) {
        for Field { name, values } in fields {
            let known = self.arrays.iter().position(|array| array.name == *name);
            let index = known.unwrap_or_else(|| {
                self.arrays.push(FieldOverTime {
                    name: name.clone(),
                    values: Vec::new(),
                    // The steps before have no values.
                    spans: vec![[0, 0]; self.n_steps],
                });
                self.arrays.len() - 1
            });
            self.arrays[index].append(values);
        }
        self.n_steps += 1;
        for array in &mut self.arrays {
            array.spans.resize(self.n_steps, [0, 0]);
        }
    }

    /// Writes the arrays and, for time steps, the range of each step.
    pub(super) fn write(&self, root: &Group, steps: Option<&Group>) -> hdf5_metno::Result<()> {
        let group = root.create_group("FieldData")?;
        for array in &self.arrays {
            array.write(&group)?;
        }
        let Some(steps) = steps else {
            return Ok(());
        };
        let offsets = steps.create_group("FieldDataOffsets")?;
        let sizes = steps.create_group("FieldDataSizes")?;
        for FieldOverTime { name, spans, .. } in &self.arrays {
            let begins: Vec<i64> = spans.iter().map(|[begin, _]| *begin).collect();
            write_list(&offsets, name, &begins)?;
            // Components and tuples.
            let shapes: Vec<[i64; 2]> = spans.iter().map(|[_, n]| [1, *n]).collect();
            table(&sizes, name, &shapes)?;
        }
        Ok(())
    }
}

impl FieldOverTime {
    fn append(&mut self, values: &FieldValues) {
        let begin = match self.spans.last() {
            Some([begin, _]) if self.values.last() == Some(values) => *begin,
            Some([begin, n]) if !self.values.is_empty() => begin + n,
            _ => 0,
        };
        if self.values.last() != Some(values) {
            self.values.push(values.clone());
        }
        let n = match values {
            FieldValues::Floats(numbers) => numbers.len(),
            FieldValues::Integers(numbers) => numbers.len(),
            FieldValues::Texts(texts) => texts.len(),
        };
        self.spans.push([begin, n as i64]);
    }

    fn write(&self, group: &Group) -> hdf5_metno::Result<()> {
        let (mut floats, mut integers, mut texts) = (Vec::new(), Vec::new(), Vec::new());
        for values in &self.values {
            match values {
                FieldValues::Floats(numbers) => floats.extend_from_slice(numbers),
                FieldValues::Integers(numbers) => integers.extend_from_slice(numbers),
                FieldValues::Texts(some) => texts.extend_from_slice(some),
            }
        }
        match self.values.first() {
            Some(FieldValues::Floats(_)) => write_list(group, &self.name, &floats),
            Some(FieldValues::Integers(_)) => write_list(group, &self.name, &integers),
            Some(FieldValues::Texts(_)) => {
                let texts: Result<Vec<_>, _> = texts.iter().map(|text| ascii(text)).collect();
                let texts = texts.map_err(|error| error.to_string())?;
                write_list(group, &self.name, &texts)
            }
            None => Ok(()),
        }
    }
}

/// Replaces non-ASCII characters by `?`: VTK 9.7 crashes when it reads them from HDF5.
fn ascii(text: &str) -> Result<VarLenAscii, StringError> {
    let known = |c: char| if c.is_ascii() { c } else { '?' };
    VarLenAscii::from_ascii(&text.chars().map(known).collect::<String>())
}
