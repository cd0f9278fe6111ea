//! `hits.vtu`, or the pieces that `hits.pvtu` lists: a point for each pixel with a hit.

use std::path::Path;

use super::arrays::{ArrayInfo, Arrays, LoadedArray};
use super::pieces::PieceList;
use host::text::Diagnostic;
use vtk::ArrayValues;
use vtk::read::{ArrayLocation, DataArrayElement, VtkReader};

/// The open file, or its pieces.
#[derive(Debug)]
pub struct HitsFile {
    /// From top to bottom of the picture, at least one.
    pieces: Vec<HitsPiece>,
}

/// A file with points of the cloud.
#[derive(Debug)]
pub struct HitsPiece {
    n_points: usize,
    arrays: Arrays,
    points: ArrayLocation,
}

impl HitsFile {
    /// Opens `hits.vtu` or `hits.pvtu` at `path`.
    ///
    /// # Errors
    /// The file, or the file of a piece, cannot be read, is damaged, or was not written by raycost.
    pub fn open(path: &Path) -> Result<Self, Diagnostic> {
        let Some(list) = PieceList::open(path)? else {
            return Ok(Self {
                pieces: vec![HitsPiece::open(path)?],
            });
        };
        let open = |path| HitsPiece::open(path);
        let pieces: Vec<HitsPiece> = list
            .paths
            .iter()
            .map(|path| open(path))
            .collect::<Result<_, _>>()?;
        if pieces.iter().any(|piece| piece.arrays.file.run != list.run) {
            return Err(list.foreign("its pieces do not fit together"));
        }
        Ok(Self { pieces })
    }

    /// Returns the id of the run that wrote the file, if the file has one.
    pub fn run(&self) -> Option<&str> {
        self.pieces[0].arrays.file.run.as_deref()
    }

    /// Returns the number of pixels with a hit.
    pub fn n_points(&self) -> usize {
        self.pieces.iter().map(|piece| piece.n_points).sum()
    }

    /// Returns the headers of the arrays except the points, in the file's order.
    pub fn arrays(&self) -> &[ArrayInfo] {
        &self.pieces[0].arrays.infos
    }

    /// Returns true if the file has an array of this name.
    pub fn has(&self, name: &str) -> bool {
        self.pieces[0].arrays.position(name).is_some()
    }

    /// Sets the arrays that the scene chose, for messages.
    pub(super) fn set_chosen(&mut self, chosen: Option<&Vec<String>>) {
        for piece in &mut self.pieces {
            piece.arrays.chosen = chosen.cloned();
        }
    }

    /// Returns the pieces in the order of the pixels; a cloud in one file is one piece.
    pub fn pieces(&self) -> &[HitsPiece] {
        &self.pieces
    }

    /// Reads an array, in the order of the pixels, row 0 on top.
    ///
    /// # Errors
    /// The array is missing or damaged; the message says how to write it.
    pub fn read(&self, name: &str) -> Result<LoadedArray, Diagnostic> {
        let (first, others) = self.pieces.split_at(1);
        let mut joined = first[0].read(name)?;
        for piece in others {
            if !joined.append(&piece.read(name)?) {
                return Err(piece.arrays.file.foreign("its arrays differ from others"));
            }
        }
        Ok(joined)
    }

    /// Reads the points in world space, in the order of the pixels.
    ///
    /// # Errors
    /// The points are damaged, or are neither `Float32` nor `Float64`.
    pub fn read_points(&self) -> Result<Vec<[f64; 3]>, Diagnostic> {
        let of_pieces = self.pieces.iter().map(HitsPiece::read_points);
        Ok(of_pieces.collect::<Result<Vec<_>, _>>()?.concat())
    }
}

impl HitsPiece {
    fn open(path: &Path) -> Result<Self, Diagnostic> {
        let (file, header) = VtkReader::open(path)?;
        let Some(grid) = header.grid else {
            return Err(file.foreign("it holds no UnstructuredGrid"));
        };
        let [
            points @ DataArrayElement {
                n_components: 3, ..
            },
        ] = &grid.points[..]
        else {
            return Err(file.foreign("its points are not one array of three numbers each"));
        };
        let n_points = grid.n_points;
        let points = file.place(points, n_points)?;
        let arrays = Arrays::new(file, &grid.point_data, n_points)?;
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

    /// Reads an array of its points.
    ///
    /// # Errors
    /// As [`HitsFile::read`].
    pub fn read(&self, name: &str) -> Result<LoadedArray, Diagnostic> {
        self.arrays.read(name, 1, 0..1)
    }

    /// Reads its points in world space.
    ///
    /// # Errors
    /// As [`HitsFile::read_points`].
    pub fn read_points(&self) -> Result<Vec<[f64; 3]>, Diagnostic> {
        let numbers: Vec<f64> = match self.arrays.file.read(&self.points)? {
            ArrayValues::F32(numbers) => numbers.into_iter().map(f64::from).collect(),
            ArrayValues::F64(numbers) => numbers,
            _ => {
                let problem = "its points are neither Float32 nor Float64";
                return Err(self.arrays.file.foreign(problem));
            }
        };
        Ok(numbers.as_chunks().0.to_vec())
    }
}
