//! Legacy VTK files.
//!
//! The format is described in "VTK File Formats" (The VTK User's Guide, Kitware, 2010), with the
//! cells of version 5.1. Numbers in binary files are big-endian.

mod parts;
mod words;

use std::io::Read;

use super::super::percent::percent_decoded;
use super::super::{FileFault, FileLocation, Result};
use super::budget::Budget;
use super::numbers::{Numbers, scalar_type};
use super::piece::{Piece, Wanted, grid_size, is_wanted};
use parts::{CellArray, DataOf, Parts};
use vtk::ArrayValues;
use vtk::read::{ByteOrder, ScalarType};
use words::Words;

/// The start of all legacy files.
pub(super) const SIGNATURE: &[u8] = b"# vtk DataFile Version";

/// Reads a file with the wanted arrays.
pub(super) fn read(bytes: &[u8], wanted: &Wanted, budget: &mut Budget) -> Result<Piece> {
    let mut words = Words::new(bytes);
    // The version, and a title.
    words.line();
    words.line();
    let encoding = words.next()?.to_ascii_uppercase();
    words.is_binary = match encoding.as_str() {
        "BINARY" => true,
        "ASCII" => false,
        _ => return Err(words.unexpected(&encoding, "`ASCII` or `BINARY`")),
    };
    words.expect("DATASET")?;
    let kind = words.next()?.to_ascii_uppercase();
    let mut reader = LegacyReader {
        words,
        wanted,
        budget,
        parts: Parts::default(),
    };
    while let Some(keyword) = reader.words.next_or_end() {
        let number = reader.words.line_number();
        let read = reader.section(&keyword.to_ascii_uppercase());
        read.map_err(|fault| fault.at(FileLocation::Line(number)))?;
    }
    let piece = reader.parts.piece(&kind, reader.budget)?;
    piece.check()?;
    Ok(piece)
}

struct LegacyReader<'a, 'b> {
    words: Words<'a>,
    wanted: &'b Wanted<'b>,
    budget: &'b mut Budget,
    parts: Parts,
}

impl LegacyReader<'_, '_> {
    /// Reads the section after a keyword.
    fn section(&mut self, keyword: &str) -> Result<()> {
        match keyword {
            "POINTS" => {
                let n = self.words.number::<usize>()?;
                self.parts.points = Some(self.typed_array(n, 3)?);
            }
            "X_COORDINATES" | "Y_COORDINATES" | "Z_COORDINATES" => {
                let n = self.words.number::<usize>()?;
                let axis = usize::from(keyword.as_bytes()[0] - b'X');
                self.parts.axes[axis] = Some(self.typed_array(n, 1)?);
            }
            "DIMENSIONS" => {
                let [x, y, z] = self.words.numbers::<i64, 3>()?;
                self.parts.size = Some(grid_size([1, x, 1, y, 1, z])?);
            }
            "ORIGIN" => self.parts.origin = self.words.numbers()?,
            "SPACING" | "ASPECT_RATIO" => self.parts.spacing = Some(self.words.numbers()?),
            "VERTICES" | "LINES" | "POLYGONS" | "TRIANGLE_STRIPS" | "CELLS" => {
                let cells = self.cells()?;
                self.parts.cells.push((keyword.to_owned(), cells));
            }
            "CELL_TYPES" => {
                let n = self.words.number::<usize>()?;
                self.parts.types = Some(self.array(ScalarType::I32, n)?);
            }
            "POINT_DATA" => self.parts.data_of = Some((DataOf::Points, self.words.number()?)),
            "CELL_DATA" => self.parts.data_of = Some((DataOf::Cells, self.words.number()?)),
            "METADATA" => self.words.skip_metadata(),
            _ => return self.attribute(keyword),
        }
        Ok(())
    }

    /// Reads one or several arrays of points or cells.
    fn attribute(&mut self, keyword: &str) -> Result<()> {
        let name = percent_decoded(self.words.next()?);
        let n_tuples = self.parts.data_of.map_or(0, |(_, n)| n);
        let numbers = match keyword {
            "FIELD" => return self.field(),
            "SCALARS" => {
                let kind = self.words.next()?;
                let n_components = self.words.number_or("LOOKUP_TABLE", 1)?;
                self.words.next()?;
                self.values(kind, n_tuples.saturating_mul(n_components))?
                    .in_tuples_of(n_components)
            }
            "VECTORS" | "NORMALS" => self.typed_array(n_tuples, 3)?,
            "TENSORS" => self.typed_array(n_tuples, 9)?,
            "TENSORS6" => self.typed_array(n_tuples, 6)?,
            "GLOBAL_IDS" | "PEDIGREE_IDS" => self.typed_array(n_tuples, 1)?,
            "TEXTURE_COORDINATES" => {
                let n_components = self.words.number()?;
                self.typed_array(n_tuples, n_components)?
            }
            "COLOR_SCALARS" => {
                let n_components = self.words.number()?;
                self.bytes(n_tuples, n_components)?
            }
            "LOOKUP_TABLE" => {
                let n = self.words.number()?;
                self.bytes(n, 4)?;
                return Ok(());
            }
            _ => return Err(self.words.unexpected(keyword, "a section of a VTK file")),
        };
        if let Some(attributes) = self.parts.attributes() {
            match keyword {
                "NORMALS" => attributes.normals = Some(name.clone()),
                "TEXTURE_COORDINATES" => attributes.uvs = Some(name.clone()),
                _ => {}
            }
            attributes.names.push(name.clone());
            let is_special = matches!(keyword, "NORMALS" | "TEXTURE_COORDINATES");
            if is_special || is_wanted(&name, self.wanted) {
                attributes.arrays.push((name, numbers));
            }
        }
        Ok(())
    }

    /// Reads the arrays of a field; arrays outside of points and cells mean nothing to surfaces.
    fn field(&mut self) -> Result<()> {
        let n_arrays = self.words.number::<usize>()?;
        for _ in 0..n_arrays {
            let mut name = self.words.next()?;
            // The metadata of the array before.
            while name == "METADATA" {
                self.words.skip_metadata();
                name = self.words.next()?;
            }
            let name = percent_decoded(name);
            let [n_components, n_tuples] = self.words.numbers::<usize, 2>()?;
            if self
                .words
                .skip_strings(n_components.saturating_mul(n_tuples))?
            {
                continue;
            }
            let numbers = self.typed_array(n_tuples, n_components)?;
            if let Some(attributes) = self.parts.attributes() {
                attributes.names.push(name.clone());
                if is_wanted(&name, self.wanted) {
                    attributes.arrays.push((name, numbers));
                }
            }
        }
        Ok(())
    }

    /// Reads cells: as lists with their lengths or, since version 5.1, as two arrays.
    fn cells(&mut self) -> Result<CellArray> {
        let [n, n_numbers] = self.words.numbers::<usize, 2>()?;
        if self.words.skip_word("OFFSETS") {
            let kind = self.words.next()?;
            let ends = self.values(kind, n)?;
            self.words.expect("CONNECTIVITY")?;
            let kind = self.words.next()?;
            let points = self.values(kind, n_numbers)?;
            return Ok(CellArray { ends, points });
        }
        let lists = self.array(ScalarType::I32, n_numbers)?;
        self.budget.take_of::<[f64; 4]>(lists.len())?;
        let (mut ends, mut points) = (vec![0.0], Vec::new());
        let mut at = 0;
        for cell in 0..n {
            let length = if at < lists.len() { lists.at(at) } else { -1.0 };
            let end = at as f64 + 1.0 + length;
            if length < 0.0 || end > lists.len() as f64 {
                let problem = format!("cell {cell} does not fit the {n_numbers} numbers of all");
                return Err(FileFault::new(problem, "a whole file"));
            }
            points.extend((at + 1..end as usize).map(|i| lists.at(i)));
            ends.push(points.len() as f64);
            at = end as usize;
        }
        Ok(CellArray {
            ends: Numbers::from_text(ends),
            points: Numbers::from_text(points),
        })
    }

    /// Reads numbers of the type with this name, which has been read. In binary files the first bit
    /// is the most significant one of its byte.
    fn values(&mut self, kind: &str, n: usize) -> Result<Numbers> {
        if !kind.eq_ignore_ascii_case("bit") {
            let expected = "a type of numbers, such as `float` or `int`";
            let known = scalar_type(kind);
            return self.array(
                known.ok_or_else(|| self.words.unexpected(kind, expected))?,
                n,
            );
        }
        if !self.words.is_binary {
            return self.array(ScalarType::U8, n);
        }
        let packed = self.words.bytes(n.div_ceil(8))?;
        self.budget.take(n as u64)?;
        let bits = (0..n).map(|i| packed[i / 8] >> (7 - i % 8) & 1);
        Ok(Numbers::new(ArrayValues::U8(bits.collect())))
    }

    /// Reads tuples, preceded by the name of their type.
    fn typed_array(&mut self, n_tuples: usize, n_components: usize) -> Result<Numbers> {
        let kind = self.words.next()?;
        let numbers = self.values(kind, n_tuples.saturating_mul(n_components))?;
        Ok(numbers.in_tuples_of(n_components))
    }

    /// Reads colors: bytes in binary files, numbers from 0 to 1 in text files.
    fn bytes(&mut self, n_tuples: usize, n_components: usize) -> Result<Numbers> {
        let numbers = self.array(ScalarType::U8, n_tuples.saturating_mul(n_components))?;
        Ok(numbers.in_tuples_of(n_components))
    }

    fn array(&mut self, scalar: ScalarType, n: usize) -> Result<Numbers> {
        if self.words.is_binary {
            let n_bytes = n.saturating_mul(scalar.size());
            let mut bytes = self.words.bytes(n_bytes)?;
            self.budget.take(n_bytes as u64)?;
            let fill = |into: &mut [u8]| bytes.read_exact(into);
            let values = ArrayValues::read(scalar, n, ByteOrder::BigEndian, fill)?;
            return Ok(Numbers::new(values));
        }
        // A number takes at least two bytes of text.
        self.budget
            .take_of::<[f64; 3]>(n.min(self.words.rest.len() / 2 + 1))?;
        let numbers = (0..n).map(|_| self.words.number::<f64>());
        Ok(Numbers::from_text(numbers.collect::<Result<_>>()?))
    }
}
