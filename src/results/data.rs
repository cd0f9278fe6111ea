//! The two VTK files of a rendering, `frame.vti` and `hits.vtu`.

use std::path::Path;

use crate::config::{CostMode, MAX_SIDE, Repeats};
use crate::film::{Column, columns};
use crate::text::Diagnostic;
use crate::vtk::read::{
    ArrayLocation, ArrayValues, DataArrayElement, DataArraysElement, Scalar, Selection, VtkReader,
};

/// The header of an array.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArrayInfo {
    /// Its name.
    pub name: String,
    /// The VTK type of its numbers: `Float32`, `UInt32`, …
    pub vtk_type: String,
    /// Numbers per pixel or point.
    pub n_components: usize,
}

/// An array in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedArray {
    /// Its name.
    pub name: String,
    /// Numbers per pixel or point.
    pub n_components: usize,
    /// Its numbers, with the components of a pixel or point interleaved.
    pub values: ArrayValues,
}

/// An open `frame.vti`: arrays of all pixels.
#[derive(Debug)]
pub struct FrameFile {
    width: u32,
    height: u32,
    arrays: Arrays,
}

/// An open `hits.vtu`: a point for each pixel with a hit.
#[derive(Debug)]
pub struct HitsFile {
    n_points: usize,
    arrays: Arrays,
    points: ArrayLocation,
}

/// The point arrays of a file.
#[derive(Debug)]
struct Arrays {
    file: VtkReader,
    infos: Vec<ArrayInfo>,
    places: Vec<ArrayLocation>,
}

impl FrameFile {
    /// Opens the file at `path`.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or raycost did not write it.
    pub fn open(path: &Path) -> Result<Self, Diagnostic> {
        let (file, header) = VtkReader::open(path)?;
        let Some(image) = header.image else {
            return Err(file.foreign("it holds no ImageData"));
        };
        let is_picture = |&(width, height): &(u32, u32)| width <= MAX_SIDE && height <= MAX_SIDE;
        let Some((width, height)) = image.piece.size().filter(is_picture) else {
            let why = format!("`{}` is not the extent of a picture", image.piece.extent);
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

    /// The id of the run that wrote the file, if the file has one.
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

    /// The headers of the arrays, in the file's order.
    pub fn arrays(&self) -> &[ArrayInfo] {
        &self.arrays.infos
    }

    /// Whether the file has an array of this name.
    pub fn has(&self, name: &str) -> bool {
        self.arrays.position(name).is_some()
    }

    /// Reads an array, row-major, `width * height` tuples, row 0 on top as in the
    /// film; the file stores the bottom row first.
    ///
    /// # Errors
    /// The array is missing, with the option that writes it, or damaged.
    pub fn read(&mut self, name: &str) -> Result<LoadedArray, Diagnostic> {
        self.arrays.read(name, self.height as usize)
    }

    /// Reads the pixels of an array at the intersections of `columns` and `rows`,
    /// both ascending, as [`Self::read`] does. Takes the memory of these pixels and
    /// of one row of the array.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_selected(
        &mut self,
        name: &str,
        columns: &[u32],
        rows: &[u32],
    ) -> Result<LoadedArray, Diagnostic> {
        let index = self.arrays.index(name)?;
        let n_components = self.arrays.infos[index].n_components;
        let selection = Selection {
            size: [self.width as usize, self.height as usize],
            n_components,
            columns,
            rows,
        };
        Ok(LoadedArray {
            name: name.to_owned(),
            n_components,
            values: self
                .arrays
                .file
                .read_selected(&self.arrays.places[index], &selection)?,
        })
    }
}

impl HitsFile {
    /// Opens the file at `path`.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or raycost did not write it.
    pub fn open(path: &Path) -> Result<Self, Diagnostic> {
        let (file, header) = VtkReader::open(path)?;
        let Some(grid) = header.grid else {
            return Err(file.foreign("it holds no UnstructuredGrid"));
        };
        let [
            points @ DataArrayElement {
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

    /// The id of the run that wrote the file, if the file has one.
    pub fn run(&self) -> Option<&str> {
        self.arrays.file.run.as_deref()
    }

    /// The number of pixels with a hit.
    pub fn n_points(&self) -> usize {
        self.n_points
    }

    /// The headers of the arrays except the points, in the file's order.
    pub fn arrays(&self) -> &[ArrayInfo] {
        &self.arrays.infos
    }

    /// Whether the file has an array of this name.
    pub fn has(&self, name: &str) -> bool {
        self.arrays.position(name).is_some()
    }

    /// Reads an array, in the order of the pixels, row 0 on top.
    ///
    /// # Errors
    /// The array is missing, with the option that writes it, or damaged.
    pub fn read(&mut self, name: &str) -> Result<LoadedArray, Diagnostic> {
        self.arrays.read(name, 1)
    }

    /// Reads the points in world space, in the order of the pixels.
    ///
    /// # Errors
    /// The points are damaged, or are not `Float32`.
    pub fn read_points(&mut self) -> Result<Vec<[f32; 3]>, Diagnostic> {
        let values = self.arrays.file.read(&self.points, 1)?;
        match f32::of(&values) {
            Some(numbers) => Ok(bytemuck::cast_slice(numbers).to_vec()),
            None => Err(self.arrays.file.foreign("its points are not Float32")),
        }
    }
}

impl Arrays {
    fn of(file: VtkReader, arrays: &DataArraysElement, n_tuples: u64) -> Result<Self, Diagnostic> {
        let info = |array: &DataArrayElement| ArrayInfo {
            name: array.name.clone(),
            vtk_type: array.scalar.clone(),
            n_components: array.n_components as usize,
        };
        let infos = arrays.arrays.iter().map(info).collect();
        let place = |array| file.place(array, n_tuples);
        let places: Vec<ArrayLocation> =
            arrays.arrays.iter().map(place).collect::<Result<_, _>>()?;
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

    fn read(&mut self, name: &str, n_rows: usize) -> Result<LoadedArray, Diagnostic> {
        let index = self.index(name)?;
        Ok(LoadedArray {
            name: name.to_owned(),
            n_components: self.infos[index].n_components,
            values: self.file.read(&self.places[index], n_rows)?,
        })
    }

    /// The error for a missing array, with the option that writes it.
    fn missing(&self, name: &str) -> Diagnostic {
        let path = self.file.path.display();
        let error = Diagnostic::new(format!("`{path}` has no array `{name}`"));
        let written_with = |mode, repeats| columns(mode, repeats).any(|column| column.name == name);
        if written_with(CostMode::Counters, Repeats::ONCE) {
            return error.with_help("render again without `--no-cost`");
        }
        if written_with(CostMode::AttributedTime, Repeats::ONCE) {
            return error.with_help("render again with `--cost attributed_time`");
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
