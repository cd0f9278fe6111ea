//! Legacy VTK files.
//!
//! The format is that of "VTK File Formats" (The VTK User's Guide, Kitware, 2010), with the
//! cells of version 5.1. Numbers in binary files are big-endian.

use super::super::fault::cut;
use super::super::{FileFault, FileLocation, Result};
use super::budget::Budget;
use super::cells::{Cells, POLY_LINE, POLY_VERTEX, POLYGON, STRIP};
use super::numbers::{ByteOrder, NumberType, Numbers};
use super::piece::{
    Lattice, Piece, PieceArrays, PointPositions, Topology, Wanted, grid_size, is_wanted,
};
use super::xml::IDENTITY;

/// What all legacy files begin with.
pub(super) const SIGNATURE: &[u8] = b"# vtk DataFile Version";

/// Reads a file, and of its arrays those that are wanted.
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

/// What the sections of a file gave.
#[derive(Debug, Default)]
struct Parts {
    points: Option<Numbers>,
    axes: [Option<Numbers>; 3],
    size: Option<[usize; 3]>,
    origin: [f64; 3],
    spacing: Option<[f64; 3]>,
    /// The cells by their sections: the ends of cells and their points.
    cells: Vec<(String, CellArray)>,
    types: Option<Numbers>,
    point_data: PieceArrays,
    cell_data: PieceArrays,
    /// What the arrays that come next are of, and how many tuples they have.
    data_of: Option<(DataOf, usize)>,
}

#[derive(Debug, Clone, Copy)]
enum DataOf {
    Points,
    Cells,
}

/// Cells: where the points of each end, and the points of all.
#[derive(Debug)]
struct CellArray {
    ends: Numbers,
    points: Numbers,
}

struct LegacyReader<'a, 'b> {
    words: Words<'a>,
    wanted: &'b Wanted<'b>,
    budget: &'b mut Budget,
    parts: Parts,
}

impl LegacyReader<'_, '_> {
    /// Reads what follows a keyword.
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
                self.parts.types = Some(self.array(NumberType::I32, n)?);
            }
            "POINT_DATA" => self.parts.data_of = Some((DataOf::Points, self.words.number()?)),
            "CELL_DATA" => self.parts.data_of = Some((DataOf::Cells, self.words.number()?)),
            "METADATA" => self.words.skip_metadata(),
            _ => return self.attribute(keyword),
        }
        Ok(())
    }

    /// Reads an array of points or cells, or several.
    fn attribute(&mut self, keyword: &str) -> Result<()> {
        let name = decoded_name(self.words.next()?);
        let n_tuples = self.parts.data_of.map_or(0, |(_, n)| n);
        let numbers = match keyword {
            "FIELD" => return self.field(),
            "SCALARS" => {
                let kind = self.number_type()?;
                let n_components = self.words.number_or("LOOKUP_TABLE", 1)?;
                self.words.next()?;
                self.array(kind, n_tuples.saturating_mul(n_components))?
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

    /// Reads the arrays of a field; those that are of nothing have no meaning for surfaces.
    fn field(&mut self) -> Result<()> {
        let n_arrays = self.words.number::<usize>()?;
        for _ in 0..n_arrays {
            let mut name = self.words.next()?;
            // The keys of the array before.
            while name == "METADATA" {
                self.words.skip_metadata();
                name = self.words.next()?;
            }
            let name = decoded_name(name);
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
            let kind = self.number_type()?;
            let ends = self.array(kind, n)?;
            self.words.expect("CONNECTIVITY")?;
            let kind = self.number_type()?;
            let points = self.array(kind, n_numbers)?;
            return Ok(CellArray { ends, points });
        }
        let lists = self.array(NumberType::I32, n_numbers)?;
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
            ends: Numbers::of_text(&ends),
            points: Numbers::of_text(&points),
        })
    }

    fn number_type(&mut self) -> Result<NumberType> {
        let name = self.words.next()?;
        NumberType::named(name).ok_or_else(|| {
            self.words
                .unexpected(name, "a type of numbers, such as `float` or `int`")
        })
    }

    /// Reads tuples of a type that is named before them.
    fn typed_array(&mut self, n_tuples: usize, n_components: usize) -> Result<Numbers> {
        let kind = self.number_type()?;
        let numbers = self.array(kind, n_tuples.saturating_mul(n_components))?;
        Ok(numbers.in_tuples_of(n_components))
    }

    /// Reads colors: bytes in binary files, numbers from 0 to 1 in others.
    fn bytes(&mut self, n_tuples: usize, n_components: usize) -> Result<Numbers> {
        let numbers = self.array(NumberType::U8, n_tuples.saturating_mul(n_components))?;
        Ok(numbers.in_tuples_of(n_components))
    }

    fn array(&mut self, kind: NumberType, n: usize) -> Result<Numbers> {
        if self.words.is_binary {
            let n_bytes = n.saturating_mul(kind.n_bytes());
            let bytes = self.words.bytes(n_bytes)?;
            self.budget.take(n_bytes as u64)?;
            return Ok(Numbers::new(kind, ByteOrder::Big, bytes.to_vec()));
        }
        // A number takes two bytes of the text at least.
        self.budget
            .take_of::<[f64; 3]>(n.min(self.words.rest.len() / 2 + 1))?;
        let numbers = (0..n).map(|_| self.words.number::<f64>());
        Ok(Numbers::of_text(&numbers.collect::<Result<Vec<f64>>>()?))
    }
}

impl Parts {
    /// The arrays that come next.
    fn attributes(&mut self) -> Option<&mut PieceArrays> {
        Some(match self.data_of?.0 {
            DataOf::Points => &mut self.point_data,
            DataOf::Cells => &mut self.cell_data,
        })
    }

    fn piece(mut self, kind: &str, budget: &mut Budget) -> Result<Piece> {
        let points = self.points.take().unwrap_or_else(|| Numbers::of_text(&[]));
        let points = points.in_tuples_of(3);
        let (points, topology) = match kind {
            "POLYDATA" | "UNSTRUCTURED_GRID" => {
                let cells = self.cells(points.len() / 3, budget)?;
                (PointPositions::Explicit(points), Topology::Cells(cells))
            }
            "STRUCTURED_GRID" => (
                PointPositions::Explicit(points),
                Topology::Grid(self.size()?),
            ),
            "RECTILINEAR_GRID" => {
                let size = self.size()?;
                let axes = self
                    .axes
                    .map(|axis| axis.unwrap_or_else(|| Numbers::of_text(&[])));
                for (axis, n) in axes.iter().zip(size) {
                    axis.check("COORDINATES", n)?;
                }
                (PointPositions::Axes(axes), Topology::Grid(size))
            }
            "STRUCTURED_POINTS" => {
                let size = self.size()?;
                let lattice = Lattice {
                    size,
                    first: [0; 3],
                    origin: self.origin,
                    spacing: self.spacing.unwrap_or([1.0; 3]),
                    direction: IDENTITY,
                };
                (PointPositions::Lattice(lattice), Topology::Grid(size))
            }
            _ => {
                let problem = format!("it is a data set of the type `{}`", cut(kind));
                let expected = "POLYDATA, UNSTRUCTURED_GRID, STRUCTURED_GRID, RECTILINEAR_GRID \
                     or STRUCTURED_POINTS";
                return Err(FileFault::new(problem, expected));
            }
        };
        Ok(Piece {
            points,
            topology,
            point_data: self.point_data,
            cell_data: self.cell_data,
        })
    }

    fn size(&self) -> Result<[usize; 3]> {
        let missing = || FileFault::new("it has no `DIMENSIONS`", "those of the grid");
        self.size.ok_or_else(missing)
    }

    /// The cells, in the order of their arrays.
    fn cells(&self, n_points: usize, budget: &mut Budget) -> Result<Cells> {
        let mut cells = Cells::of_points(n_points);
        for (name, cell_type) in [
            ("VERTICES", Some(POLY_VERTEX)),
            ("LINES", Some(POLY_LINE)),
            ("POLYGONS", Some(POLYGON)),
            ("TRIANGLE_STRIPS", Some(STRIP)),
            ("CELLS", None),
        ] {
            let sections = self.cells.iter().filter(|(known, _)| known == name);
            for (_, CellArray { ends, points }) in sections {
                // The first end is the begin of the first cell.
                let n_cells = ends.len().saturating_sub(1);
                let types = match cell_type {
                    Some(cell_type) => vec![f64::from(cell_type); n_cells],
                    None => self.types.iter().flat_map(Numbers::iter).collect(),
                };
                if types.len() != n_cells {
                    let problem = format!("{n_cells} cells have {} types", types.len());
                    return Err(FileFault::new(problem, "`CELL_TYPES` with one for each"));
                }
                cells.add(|cell| types[cell], n_cells, ends, points, budget)?;
            }
        }
        Ok(cells)
    }
}

/// The name of an array, in which VTK writes blanks and other characters as `%20`.
fn decoded_name(name: &str) -> String {
    let mut bytes = Vec::with_capacity(name.len());
    let mut rest = name.as_bytes();
    while let Some((&byte, behind)) = rest.split_first() {
        let code = behind.get(..2).and_then(|code| str::from_utf8(code).ok());
        let code = code.and_then(|code| u8::from_str_radix(code, 16).ok());
        match code.filter(|_| byte == b'%') {
            Some(code) => {
                bytes.push(code);
                rest = &behind[2..];
            }
            None => {
                bytes.push(byte);
                rest = behind;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The words of a file, with bytes between them in binary ones.
struct Words<'a> {
    all: &'a [u8],
    rest: &'a [u8],
    is_binary: bool,
}

impl<'a> Words<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            all: bytes,
            rest: bytes,
            is_binary: false,
        }
    }

    /// The rest of the line.
    fn line(&mut self) -> &'a [u8] {
        let end = memchr::memchr(b'\n', self.rest);
        let (line, rest) = self
            .rest
            .split_at(end.map_or(self.rest.len(), |end| end + 1));
        self.rest = rest;
        line
    }

    /// The number of the line of the next word; in a binary file that of line feeds.
    fn line_number(&self) -> u64 {
        let before = &self.all[..self.all.len() - self.rest.len()];
        memchr::memchr_iter(b'\n', before).count() as u64 + 1
    }

    /// The next word, if there is one.
    fn next_or_end(&mut self) -> Option<&'a str> {
        let rest = self.rest.trim_ascii_start();
        let end = rest.iter().position(u8::is_ascii_whitespace);
        let (word, rest) = rest.split_at(end.unwrap_or(rest.len()));
        self.rest = rest;
        // Other bytes are no word of a VTK file.
        (!word.is_empty()).then(|| str::from_utf8(word).unwrap_or("\u{fffd}"))
    }

    fn next(&mut self) -> Result<&'a str> {
        let ends = || FileFault::new("it ends early", "a whole file");
        self.next_or_end().ok_or_else(ends)
    }

    /// Skips the next word if it is this one; returns whether it was.
    fn skip_word(&mut self, word: &str) -> bool {
        let before = self.rest;
        let is_it = self
            .next_or_end()
            .is_some_and(|next| next.eq_ignore_ascii_case(word));
        if !is_it {
            self.rest = before;
        }
        is_it
    }

    fn expect(&mut self, word: &str) -> Result<()> {
        if self.skip_word(word) {
            return Ok(());
        }
        let found = self.next()?;
        Err(self.unexpected(found, &format!("`{word}`")))
    }

    fn number<T: std::str::FromStr>(&mut self) -> Result<T> {
        let word = self.next()?;
        word.parse().map_err(|_| self.unexpected(word, "a number"))
    }

    fn numbers<T: std::str::FromStr + Copy + Default, const N: usize>(&mut self) -> Result<[T; N]> {
        let mut numbers = [T::default(); N];
        for number in &mut numbers {
            *number = self.number()?;
        }
        Ok(numbers)
    }

    /// The number before a word, or `default` if there is only the word. Skips the word.
    fn number_or(&mut self, word: &str, default: usize) -> Result<usize> {
        if self.skip_word(word) {
            return Ok(default);
        }
        let number = self.number()?;
        self.expect(word).map(|()| number)
    }

    /// The bytes behind the line feed.
    fn bytes(&mut self, n: usize) -> Result<&'a [u8]> {
        self.line();
        let ends = || FileFault::new("it ends early", "a whole file");
        let (bytes, rest) = self.rest.split_at_checked(n).ok_or_else(ends)?;
        self.rest = rest;
        Ok(bytes)
    }

    /// Skips the lines up to a blank one.
    fn skip_metadata(&mut self) {
        self.line();
        while !self.rest.is_empty() && !self.line().trim_ascii().is_empty() {}
    }

    /// Skips so many strings if those are what comes next; returns whether they were.
    fn skip_strings(&mut self, n: usize) -> Result<bool> {
        if !self.skip_word("string") {
            return Ok(false);
        }
        self.line();
        for _ in 0..n {
            if self.is_binary {
                // The two highest bits of the length give the number of its bytes.
                let ends = || FileFault::new("it ends early", "a whole file");
                let first = *self.rest.first().ok_or_else(ends)?;
                let n_length = 1 << (3 - (first >> 6));
                let (length, rest) = self.rest.split_at_checked(n_length).ok_or_else(ends)?;
                let mask = u64::MAX >> (66 - 8 * n_length);
                let length = ByteOrder::Big.length(length) & mask;
                self.rest = rest;
                let length = usize::try_from(length).map_err(|_| ends())?;
                self.rest = self.rest.get(length..).ok_or_else(ends)?;
            } else if self.rest.is_empty() {
                return Err(FileFault::new("it ends early", "a whole file"));
            } else {
                self.line();
            }
        }
        Ok(true)
    }

    fn unexpected(&self, word: &str, expected: &str) -> FileFault {
        FileFault::new(format!("`{}` does not belong here", cut(word)), expected)
    }
}
