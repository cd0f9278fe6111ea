//! `frame.vti`, or the pieces that `frame.pvti` lists: arrays of all pixels.

use std::ops::Range;
use std::path::Path;

use super::arrays::{ArrayInfo, Arrays, LoadedArray};
use super::pieces::PieceList;
use host::text::Diagnostic;
use scene::config::MAX_SIDE;
use vtk::read::VtkReader;

/// The open file, or its pieces.
#[derive(Debug)]
pub struct FrameFile {
    width: u32,
    height: u32,
    /// From top to bottom, at least one.
    pieces: Vec<FramePiece>,
}

/// A file with rows of the frame.
#[derive(Debug)]
pub struct FramePiece {
    arrays: Arrays,
    width: u32,
    /// The rows in the file, row 0 of the picture on top.
    stored: Range<u32>,
    /// The rows that no piece above has.
    rows: Range<u32>,
}

impl FrameFile {
    /// Opens `frame.vti` or `frame.pvti` at `path`.
    ///
    /// # Errors
    /// The file, or the file of a piece, cannot be read, is damaged, or was not written by raycost.
    pub fn open(path: &Path) -> Result<Self, Diagnostic> {
        match PieceList::open(path)? {
            None => {
                let piece = FramePiece::open(path, None)?;
                Ok(Self {
                    width: piece.width,
                    height: piece.stored.end,
                    pieces: vec![piece],
                })
            }
            Some(list) => Self::open_pieces(&list),
        }
    }

    fn open_pieces(list: &PieceList) -> Result<Self, Diagnostic> {
        let Some([width, height]) = list.size else {
            return Err(list.foreign("it is not an image"));
        };
        let open = |path| FramePiece::open(path, Some(height));
        let mut pieces: Vec<FramePiece> = list
            .paths
            .iter()
            .map(|path| open(path))
            .collect::<Result<_, _>>()?;
        let mut end = 0;
        for piece in &mut pieces {
            let Range { start, end: next } = piece.stored;
            let is_next = start <= end && end < next && piece.width == width;
            if !is_next || piece.arrays.file.run != list.run {
                return Err(list.foreign("its pieces do not fit together"));
            }
            piece.rows = end..next;
            end = next;
        }
        if end != height {
            return Err(list.foreign("its pieces are not all rows of the picture"));
        }
        Ok(Self {
            width,
            height,
            pieces,
        })
    }

    /// Returns the id of the run that wrote the file, if the file has one.
    pub fn run(&self) -> Option<&str> {
        self.pieces[0].arrays.file.run.as_deref()
    }

    /// Returns the number of columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns the headers of the arrays, in the file's order.
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

    /// Checks that the file has these arrays.
    ///
    /// # Errors
    /// Arrays are missing; the message says how to write them.
    pub fn require(&self, names: &[&str]) -> Result<(), Diagnostic> {
        self.pieces[0].arrays.require(names)
    }

    /// Returns the pieces from top to bottom; a frame in one file is one piece.
    pub fn pieces(&self) -> &[FramePiece] {
        &self.pieces
    }

    /// Reads an array, row-major, `width * height` tuples, row 0 on top as in the film; the file
    /// stores the bottom row first.
    ///
    /// # Errors
    /// The array is missing or damaged; the message says how to write it.
    pub fn read(&self, name: &str) -> Result<LoadedArray, Diagnostic> {
        self.read_rows(name, 0..self.height)
    }

    /// Reads these rows of an array, at least one, as [`Self::read`] does. Needs memory for these
    /// rows.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_rows(&self, name: &str, rows: Range<u32>) -> Result<LoadedArray, Diagnostic> {
        self.joined(|piece| {
            let [start, end] =
                [rows.start, rows.end].map(|row| row.clamp(piece.rows.start, piece.rows.end));
            (start < end)
                .then(|| piece.read_rows(name, start..end))
                .transpose()
        })
    }

    /// Reads the pixels of an array at the intersections of `columns` and `rows`, both ascending,
    /// as [`Self::read`] does. Needs memory for these pixels and one row of the array.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_selected(
        &self,
        name: &str,
        columns: &[u32],
        rows: &[u32],
    ) -> Result<LoadedArray, Diagnostic> {
        self.joined(|piece| {
            let of_piece = rows.iter().filter(|row| piece.rows.contains(row));
            let of_piece: Vec<u32> = of_piece.map(|row| row - piece.stored.start).collect();
            let size = [piece.width as usize, piece.stored.len()];
            if of_piece.is_empty() && !rows.is_empty() {
                return Ok(None);
            }
            let read = piece.arrays.read_selected(name, size, [columns, &of_piece]);
            read.map(Some)
        })
    }

    /// Joins the arrays that `read` returns for each piece.
    fn joined(
        &self,
        read: impl Fn(&FramePiece) -> Result<Option<LoadedArray>, Diagnostic>,
    ) -> Result<LoadedArray, Diagnostic> {
        let mut joined: Option<LoadedArray> = None;
        for piece in &self.pieces {
            let Some(array) = read(piece)? else { continue };
            let Some(joined) = &mut joined else {
                joined = Some(array);
                continue;
            };
            if !joined.append(&array) {
                return Err(piece.arrays.file.foreign("its arrays differ from others"));
            }
        }
        joined.ok_or_else(|| self.pieces[0].arrays.file.foreign("it has no rows"))
    }
}

impl FramePiece {
    /// Opens a piece of a picture with this many rows, or a whole picture.
    fn open(path: &Path, height: Option<u32>) -> Result<Self, Diagnostic> {
        let (file, header) = VtkReader::open(path)?;
        let Some(image) = header.image else {
            return Err(file.foreign("it holds no ImageData"));
        };
        let extent = image.extent();
        let Some((width, stored)) = extent.and_then(|extent| place(&extent, height)) else {
            let why = format!("`{}` is not the extent of a picture", image.extent);
            return Err(file.foreign(&why));
        };
        let n_pixels = u64::from(width) * stored.len() as u64;
        Ok(Self {
            arrays: Arrays::new(file, &image.point_data, n_pixels)?,
            width,
            rows: stored.clone(),
            stored,
        })
    }

    /// Returns true if it has an array of this name.
    pub fn has(&self, name: &str) -> bool {
        self.arrays.position(name).is_some()
    }

    /// Returns the first of its rows.
    pub fn first_row(&self) -> u32 {
        self.rows.start
    }

    /// Reads its rows of an array, row-major, the upper row first.
    ///
    /// # Errors
    /// As [`FrameFile::read`].
    pub fn read(&self, name: &str) -> Result<LoadedArray, Diagnostic> {
        self.read_rows(name, self.rows.clone())
    }

    /// Reads rows of the picture that it stores.
    fn read_rows(&self, name: &str, rows: Range<u32>) -> Result<LoadedArray, Diagnostic> {
        let [start, end] = [rows.start, rows.end].map(|row| (row - self.stored.start) as usize);
        self.arrays.read(name, self.stored.len(), start..end)
    }
}

/// Returns the columns and the rows of an extent, row 0 of the picture on top; `None` unless it
/// consists of whole rows. A picture of unknown height has all of its rows.
fn place([x0, x1, y0, y1]: &[u32; 4], height: Option<u32>) -> Option<(u32, Range<u32>)> {
    let height = match height {
        None => (*y0 == 0).then_some(y1 + 1)?,
        Some(height) => height,
    };
    let is_in = *x0 == 0 && *x1 < MAX_SIDE && y1 < &height && height <= MAX_SIDE;
    is_in.then(|| (x1 + 1, height - y1 - 1..height - y0))
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::{self, Seek, SeekFrom, Write};

    use vtkio::model::ScalarType;

    use super::*;
    use vtk::array::Array;
    use vtk::data_set::{DataSet, Extent};
    use vtk::{ArrayValues, Codec, appended};

    /// A file whose zeros take no space on the disk.
    struct SparseFile(File);

    impl Write for SparseFile {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let is_zero = bytes.len() == ZEROS.len() && bytes == ZEROS;
            if !is_zero {
                return self.0.write(bytes);
            }
            self.0.seek(SeekFrom::Current(bytes.len() as i64))?;
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            self.0.flush()
        }
    }

    impl Seek for SparseFile {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            self.0.seek(to)
        }
    }

    static ZEROS: [u8; 1 << 20] = [0; 1 << 20];

    /// Zeros except for the last bytes.
    fn array<'a>(name: &'a str, n_components: usize, n: u64, last: &'static [u8]) -> Array<'a> {
        let n_bytes = n * n_components as u64;
        Array {
            name,
            scalar: ScalarType::U8,
            n_components,
            n_bytes,
            unit: None,
            write: Box::new(move |out| {
                let n_zeros = n_bytes - last.len() as u64;
                for _ in 0..n_zeros / ZEROS.len() as u64 {
                    out.write_all(&ZEROS)?;
                }
                out.write_all(&ZEROS[..(n_zeros % ZEROS.len() as u64) as usize])?;
                out.write_all(last)
            }),
        }
    }

    /// More than 2^31 pixels, and an array that begins more than 2^32 bytes into the file.
    #[test]
    fn counts_and_offsets_may_have_more_than_32_bits() {
        let size = [MAX_SIDE, 33_000];
        let n = u64::from(size[0]) * u64::from(size[1]);
        assert!(n > 1 << 31);
        let image = DataSet::Image {
            extent: Extent::of_size(size),
            point_data: vec![
                array("RGB", 3, n, &[1, 2, 3]),
                array("depth", 1, n, &[7, 8]),
            ],
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frame.vti");
        let mut file = SparseFile(File::create(&path).unwrap());
        appended::write(&image, Codec::None.into(), &mut file).unwrap();
        assert!(path.metadata().unwrap().len() > 4 * n);
        let frame = FrameFile::open(&path).unwrap();
        assert_eq!([frame.width(), frame.height()], size);
        // The last pixels of the file belong to the upper row.
        let columns = [0, size[0] - 2, size[0] - 1];
        let found = frame.read_selected("depth", &columns, &[0, size[1] - 1]);
        let expected = ArrayValues::U8(vec![0, 7, 8, 0, 0, 0]);
        assert_eq!(found.unwrap().values, expected);
        let found = frame.read_selected("RGB", &columns[1..], &[0]);
        assert_eq!(
            found.unwrap().values,
            ArrayValues::U8(vec![0, 0, 0, 1, 2, 3])
        );
    }
}
