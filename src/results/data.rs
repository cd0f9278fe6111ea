//! The two files of a rendering.

use std::path::Path;

use crate::config::{CostMode, Repeats};
use crate::film::columns;
use crate::text::Diagnostic;
use crate::vtk::read::{DataArray, DataArrays, Number, Pick, Place, Values, VtkFile};

/// What is known of an array before it is read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArrayInfo {
    /// Its name.
    pub name: String,
    /// What VTK calls its numbers: `Float32`, `UInt32`, …
    pub vtk_type: String,
    /// How many numbers a pixel or point.
    pub n_components: usize,
}

/// An array that was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Its name.
    pub name: String,
    /// How many numbers a pixel or point.
    pub n_components: usize,
    /// Its numbers, those of a pixel or point together.
    pub values: Values,
}

/// `frame.vti`: every pixel, hit or not.
#[derive(Debug)]
pub struct Frame {
    width: u32,
    height: u32,
    arrays: Arrays,
}

/// `hits.vtu`: the pixels that see something.
#[derive(Debug)]
pub struct Hits {
    n_points: usize,
    arrays: Arrays,
    points: Place,
}

/// The point arrays of a file.
#[derive(Debug)]
struct Arrays {
    file: VtkFile,
    infos: Vec<ArrayInfo>,
    places: Vec<Place>,
}

impl Frame {
    /// Opens the file at `path`.
    ///
    /// # Errors
    /// A diagnostic where it cannot be read, is damaged or none of raycost's.
    pub fn open(path: &Path) -> Result<Self, Diagnostic> {
        let (file, header) = VtkFile::open(path)?;
        let Some(image) = header.image else {
            return Err(file.foreign("it holds no ImageData"));
        };
        let Some((width, height)) = image.piece.size() else {
            let why = format!("`{}` is no extent of a picture", image.piece.extent);
            return Err(file.foreign(&why));
        };
        let n_pixels = u64::from(width) * u64::from(height);
        let arrays = Arrays::of(file, &image.piece.point_data, n_pixels)?;
        Ok(Self {
            width,
            height,
            arrays,
        })
    }

    /// The run that wrote it, where it says so.
    pub fn run(&self) -> Option<&str> {
        self.arrays.file.run.as_deref()
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The arrays that are there, in the file's order.
    pub fn arrays(&self) -> &[ArrayInfo] {
        &self.arrays.infos
    }

    /// Whether there is an array of this name.
    pub fn has(&self, name: &str) -> bool {
        self.arrays.position(name).is_some()
    }

    /// Reads an array, row-major, `width * height` tuples, row 0 on top as in
    /// the film: the file's rows go up.
    ///
    /// # Errors
    /// A diagnostic where it is missing (it says which flag left it out) or
    /// damaged.
    pub fn read(&mut self, name: &str) -> Result<Array, Diagnostic> {
        self.arrays.read(name, self.height as usize)
    }

    /// Reads the pixels of an array in these columns of these rows, both
    /// ascending; otherwise as [`Self::read`] does. Takes no more memory than
    /// they do, and a row.
    ///
    /// # Errors
    /// A diagnostic where the array is missing or damaged.
    pub fn read_picked(
        &mut self,
        name: &str,
        columns: &[u32],
        rows: &[u32],
    ) -> Result<Array, Diagnostic> {
        let index = self.arrays.index(name)?;
        let n_components = self.arrays.infos[index].n_components;
        let pick = Pick {
            size: [self.width as usize, self.height as usize],
            n_components,
            columns,
            rows,
        };
        Ok(Array {
            name: name.to_owned(),
            n_components,
            values: self
                .arrays
                .file
                .read_picked(&self.arrays.places[index], &pick)?,
        })
    }
}

impl Hits {
    /// Opens the file at `path`.
    ///
    /// # Errors
    /// A diagnostic where it cannot be read, is damaged or none of raycost's.
    pub fn open(path: &Path) -> Result<Self, Diagnostic> {
        let (file, header) = VtkFile::open(path)?;
        let Some(grid) = header.grid else {
            return Err(file.foreign("it holds no UnstructuredGrid"));
        };
        let [
            points @ DataArray {
                n_components: 3, ..
            },
        ] = &grid.piece.points.arrays[..]
        else {
            return Err(file.foreign("its points are not one array of three numbers each"));
        };
        let n_points = grid.piece.n_points;
        let points = file.place(points, n_points)?;
        let arrays = Arrays::of(file, &grid.piece.point_data, n_points)?;
        let Ok(n_points) = usize::try_from(n_points) else {
            return Err(arrays
                .file
                .foreign("it has more points than fit into memory"));
        };
        Ok(Self {
            n_points,
            arrays,
            points,
        })
    }

    /// The run that wrote it, where it says so.
    pub fn run(&self) -> Option<&str> {
        self.arrays.file.run.as_deref()
    }

    /// How many pixels see something.
    pub fn n_points(&self) -> usize {
        self.n_points
    }

    /// The arrays that are there, in the file's order, the points left out.
    pub fn arrays(&self) -> &[ArrayInfo] {
        &self.arrays.infos
    }

    /// Whether there is an array of this name.
    pub fn has(&self, name: &str) -> bool {
        self.arrays.position(name).is_some()
    }

    /// Reads an array, in the order of the pixels, row 0 on top.
    ///
    /// # Errors
    /// A diagnostic where it is missing (it says which flag left it out) or
    /// damaged.
    pub fn read(&mut self, name: &str) -> Result<Array, Diagnostic> {
        self.arrays.read(name, 1)
    }

    /// Reads the points in world space, in the order of the pixels.
    ///
    /// # Errors
    /// A diagnostic where they are damaged or no `Float32`.
    pub fn read_points(&mut self) -> Result<Vec<[f32; 3]>, Diagnostic> {
        let values = self.arrays.file.read(&self.points, 1)?;
        match f32::of(&values) {
            Some(numbers) => Ok(bytemuck::cast_slice(numbers).to_vec()),
            None => Err(self.arrays.file.foreign("its points are no Float32")),
        }
    }
}

impl Arrays {
    fn of(file: VtkFile, arrays: &DataArrays, n_tuples: u64) -> Result<Self, Diagnostic> {
        let info = |array: &DataArray| ArrayInfo {
            name: array.name.clone(),
            vtk_type: array.scalar.clone(),
            n_components: array.n_components as usize,
        };
        let infos = arrays.arrays.iter().map(info).collect();
        let place = |array| file.place(array, n_tuples);
        let places: Vec<Place> = arrays.arrays.iter().map(place).collect::<Result<_, _>>()?;
        file.check_overlap(&places)?;
        Ok(Self {
            file,
            infos,
            places,
        })
    }

    fn position(&self, name: &str) -> Option<usize> {
        self.infos.iter().position(|info| info.name == name)
    }

    fn index(&self, name: &str) -> Result<usize, Diagnostic> {
        self.position(name).ok_or_else(|| self.missing(name))
    }

    fn read(&mut self, name: &str, n_rows: usize) -> Result<Array, Diagnostic> {
        let index = self.index(name)?;
        Ok(Array {
            name: name.to_owned(),
            n_components: self.infos[index].n_components,
            values: self.file.read(&self.places[index], n_rows)?,
        })
    }

    /// The array is not there: which run would have written it.
    fn missing(&self, name: &str) -> Diagnostic {
        let path = self.file.path().display();
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
        let names: Vec<&str> = self.infos.iter().map(|info| info.name.as_str()).collect();
        error.with_help(format!("its arrays are {}", names.join(", ")))
    }
}
