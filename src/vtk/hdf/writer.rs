//! Writes data sets to a file, step by step.

use std::io::{self, Write};
use std::path::Path;

use hdf5_metno::{File, Group, H5Type};

use super::fields::FieldSteps;
use super::rows::{self, Place};
use super::steps::{
    StepSize, begins, write_offsets, write_point_offsets, write_sizes, write_times,
};
use crate::array::Array;
use crate::data_set::{CellMesh, DataSet};
use crate::field::Field;

/// The point array that VTK uses as normals.
const NORMALS: &str = "Normals";

/// A file being written: one step per data set, all of one kind and with the same arrays.
pub struct HdfWriter {
    file: File,
    root: Group,
    points: Group,
    steps: Vec<StepSize>,
    fields: FieldSteps,
    /// The names of the point arrays.
    names: Vec<String>,
    is_image: bool,
    /// The times of the steps; `None` for a single data set.
    times: Option<Vec<f64>>,
}

impl HdfWriter {
    /// Creates the file, with a step at each of these times or for a single data set; fails if it
    /// exists.
    pub fn create(path: &Path, times: Option<&[f64]>) -> io::Result<Self> {
        let create = || -> hdf5_metno::Result<Self> {
            let file = File::create_excl(path)?;
            let root = file.create_group("VTKHDF")?;
            let points = root.create_group("PointData")?;
            Ok(Self {
                file,
                root,
                points,
                steps: Vec::new(),
                fields: FieldSteps::default(),
                names: Vec::new(),
                is_image: false,
                times: times.map(<[f64]>::to_vec),
            })
        };
        create().map_err(io::Error::other)
    }

    /// Appends a data set: an image of points or a grid.
    ///
    /// # Errors
    /// Its kind or arrays differ from the first data set's, or an error of HDF5.
    pub fn append(&mut self, data_set: &DataSet, fields: &[Field]) -> io::Result<()> {
        let step = match data_set {
            DataSet::Image { extent, point_data } => {
                self.begin(data_set, point_data)?;
                let size = [extent.columns, extent.rows].map(|[first, last]| last - first + 1);
                self.append_image(size, point_data)?;
                StepSize::default()
            }
            DataSet::Grid(mesh) => {
                self.begin(data_set, &mesh.point_data)?;
                self.append_grid(mesh)?
            }
            DataSet::ImageCells { .. } | DataSet::Lines(_) => {
                return Err(io::ErrorKind::Unsupported.into());
            }
        };
        if self.steps.is_empty() && self.names.iter().any(|name| name == NORMALS) {
            rows::set_attribute(&self.points, NORMALS, NORMALS)?;
        }
        self.fields.append(fields);
        self.steps.push(step);
        Ok(())
    }

    /// Takes kind and arrays from the first data set, and checks that later ones have the same
    /// arrays.
    fn begin(&mut self, data_set: &DataSet, point_data: &[Array]) -> io::Result<()> {
        let names = point_data.iter().map(|array| array.name.to_owned());
        let names: Vec<String> = names.collect();
        if self.steps.is_empty() {
            self.is_image = matches!(data_set, DataSet::Image { .. });
            self.names = names;
            self.write_kind(data_set).map_err(io::Error::other)
        } else if names == self.names {
            Ok(())
        } else {
            let [names, expected] = [&names, &self.names].map(|names| names.join(", "));
            let message = format!("a step has the arrays {names} instead of {expected}");
            Err(io::Error::other(message))
        }
    }

    /// Completes the file.
    pub fn finish(self) -> io::Result<()> {
        let finish = || {
            let times = self.times.as_deref();
            let version = if times.is_some() { [2_i64, 0] } else { [1, 0] };
            attribute(&self.root, "Version", &version)?;
            if !self.is_image {
                write_sizes(&self.root, &self.steps)?;
            }
            let steps = times
                .map(|times| write_times(&self.root, times))
                .transpose()?;
            if let Some(steps) = &steps {
                let begins = if self.is_image {
                    begins(&self.steps, |_| 1)
                } else {
                    write_offsets(steps, &self.steps)?;
                    begins(&self.steps, |step| step.n_points)
                };
                write_point_offsets(steps, &self.names, &begins)?;
            }
            self.fields.write(&self.root, steps.as_ref())?;
            self.file.flush()
        };
        finish().map_err(io::Error::other)
    }

    /// Writes the type of the data sets, and the geometry of an image.
    fn write_kind(&self, data_set: &DataSet) -> hdf5_metno::Result<()> {
        let DataSet::Image { extent, .. } = data_set else {
            return rows::set_text(&self.root, "Type", "UnstructuredGrid");
        };
        let [right, top] = [extent.columns, extent.rows].map(|[_, last]| i64::from(last));
        rows::set_text(&self.root, "Type", "ImageData")?;
        attribute(&self.root, "WholeExtent", &[0, right, 0, top, 0, 0])?;
        attribute(&self.root, "Origin", &[0.0; 3])?;
        attribute(&self.root, "Spacing", &[1.0; 3])?;
        let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        attribute(&self.root, "Direction", &identity)
    }

    fn append_image(&self, size: [u32; 2], point_data: &[Array]) -> io::Result<()> {
        let [width, height] = size.map(|n| n as usize);
        let step = self.steps.len();
        // The single layer has no dimension; steps have their own.
        let (before, size) = match self.times {
            Some(_) => (vec![step], vec![step + 1, height]),
            None => (vec![], vec![height]),
        };
        let place = Place {
            before,
            first_row: 0,
            row: Some(width),
            size,
        };
        let mut arrays = point_data.iter();
        arrays.try_for_each(|array| rows::write(&self.points, array.name, array, &place))
    }

    fn append_grid(&self, mesh: &CellMesh) -> io::Result<StepSize> {
        let lengths = |of: fn(&StepSize) -> i64| self.steps.iter().map(of).sum::<i64>() as usize;
        let write = |group, name, array: &Array, first: usize| {
            let n = array.n_tuples() as usize;
            rows::write(group, name, array, &Place::of_list(first, n))
        };
        let first_point = lengths(|step| step.n_points);
        for array in &mesh.point_data {
            write(&self.points, array.name, array, first_point)?;
        }
        write(&self.root, "Points", &mesh.points, first_point)?;
        let mut n_ids = 0;
        for array in &mesh.cells {
            match array.name {
                "connectivity" => {
                    n_ids = array.n_tuples() as i64;
                    let first = lengths(|step| step.n_ids);
                    write(&self.root, "Connectivity", &wide(array, false), first)?;
                }
                "offsets" => {
                    // Each step has one offset more than cells: the start of the first.
                    let first = lengths(|step| step.n_cells + 1);
                    write(&self.root, "Offsets", &wide(array, true), first)?;
                }
                _ => write(&self.root, "Types", array, lengths(|step| step.n_cells))?,
            }
        }
        Ok(StepSize {
            n_points: mesh.n_points as i64,
            n_cells: mesh.n_cells as i64,
            n_ids,
        })
    }
}

/// Widens the numbers to 64-bit integers, VTK's type of ids; prepends a 0 if `has_begin`.
fn wide<'a>(array: &'a Array, has_begin: bool) -> Array<'a> {
    let begin: &[i64] = if has_begin { &[0] } else { &[] };
    let is_narrow = array.scalar.size() == size_of::<i32>();
    Array {
        n_bytes: 8 * (begin.len() as u64 + array.n_tuples()),
        scalar: vtkio::model::ScalarType::I64,
        write: Box::new(move |out| {
            out.write_all(bytemuck::cast_slice(begin))?;
            if is_narrow {
                (array.write)(&mut Widening {
                    out,
                    rest: Vec::new(),
                })
            } else {
                (array.write)(out)
            }
        }),
        ..Array::new(array.name, 0, std::iter::empty::<i64>)
    }
}

/// Widens 32-bit integers to 64 bits as they are written.
struct Widening<'a> {
    out: &'a mut dyn Write,
    /// The first bytes of an incomplete integer.
    rest: Vec<u8>,
}

impl Write for Widening<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.rest.extend_from_slice(bytes);
        let (integers, rest) = self.rest.as_chunks();
        let wide: Vec<i64> = integers
            .iter()
            .map(|&i| i32::from_ne_bytes(i).into())
            .collect();
        let rest = rest.to_vec();
        self.out.write_all(bytemuck::cast_slice(&wide))?;
        self.rest = rest;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

fn attribute<T: H5Type>(group: &Group, name: &str, values: &[T]) -> hdf5_metno::Result<()> {
    let attribute = group.new_attr::<T>().shape(values.len()).create(name)?;
    attribute.write_raw(values)
}
