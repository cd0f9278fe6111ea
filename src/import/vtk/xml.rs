//! VTK's XML files.
//!
//! The format is that of "VTK XML Formats" (docs.vtk.org, VTK file formats). vtkio's reader
//! does not know raw appended data, panics on some damaged files, and has no names for
//! what it skips.

use std::path::PathBuf;

use super::super::fault::cut;
use super::super::{FileFault, Result};
use super::budget::Budget;
use super::cells::{Cells, POLY_LINE, POLY_VERTEX, POLYGON, STRIP};
use super::document::{Element, parse};
use super::encoded::{ArrayEncoding, Base64, Encoded};
use super::numbers::{ByteOrder, NumberType, Numbers};
use super::piece::{
    Lattice, Piece, PieceArrays, PointPositions, Topology, Wanted, grid_size, is_wanted,
};
use crate::vtk::Compressor;

/// What a file has.
#[derive(Debug)]
pub(super) enum Contents {
    Pieces(Vec<Piece>),
    /// Pieces in files of their own, relative to the file's folder.
    Files(Vec<PathBuf>),
}

/// Reads a file, and of its arrays those that are wanted.
pub(super) fn read(bytes: &[u8], wanted: &Wanted, budget: &mut Budget) -> Result<Contents> {
    let (root, appended) = parse(bytes)?;
    let kind = root.attribute("type").unwrap_or_default();
    let data_set = root.child(kind).filter(|_| root.name == "VTKFile");
    let unknown = || {
        let problem = format!("it has no data set of the type `{}`", cut(kind));
        FileFault::new(problem, "an element VTKFile and its data set")
    };
    let data_set = data_set.ok_or_else(unknown)?;
    if kind.starts_with('P') && kind != "PolyData" || kind == "vtkMultiBlockDataSet" {
        let mut files = Vec::new();
        collect_files(data_set, &mut files);
        return Ok(Contents::Files(files));
    }
    let reader = XmlReader {
        storage: storage(&root)?,
        appended: Appended::of(&root, appended),
        data_set,
        wanted,
    };
    let pieces = data_set
        .children
        .iter()
        .filter(|child| child.name == "Piece");
    let read = |piece| reader.piece(kind, piece, budget);
    pieces
        .map(read)
        .collect::<Result<_>>()
        .map(Contents::Pieces)
}

/// The files of the pieces or blocks within an element.
fn collect_files(element: &Element, files: &mut Vec<PathBuf>) {
    let attribute = match element.name.as_str() {
        "Piece" => "Source",
        _ => "file",
    };
    files.extend(element.attribute(attribute).map(PathBuf::from));
    for child in &element.children {
        collect_files(child, files);
    }
}

fn storage(root: &Element) -> Result<ArrayEncoding> {
    let order = match root.attribute("byte_order") {
        Some("BigEndian") => ByteOrder::Big,
        _ => ByteOrder::Little,
    };
    let length_bytes = match root.attribute("header_type") {
        Some("UInt64") => 8,
        _ => 4,
    };
    let compressor = root.attribute("compressor").map(|name| {
        <dyn Compressor>::of_vtk_class(name).ok_or_else(|| {
            let problem = format!("its arrays are compressed by `{}`", cut(name));
            FileFault::new(
                problem,
                "vtkZLibDataCompressor, vtkLZ4DataCompressor or none",
            )
        })
    });
    Ok(ArrayEncoding {
        order,
        length_bytes,
        compressor: compressor.transpose()?,
    })
}

/// The data behind the elements.
#[derive(Debug, Clone, Copy)]
struct Appended<'a> {
    bytes: &'a [u8],
    is_base64: bool,
}

impl<'a> Appended<'a> {
    fn of(root: &Element, bytes: &'a [u8]) -> Self {
        let element = root.child("AppendedData");
        let encoding = element.and_then(|element| element.attribute("encoding"));
        Self {
            bytes,
            is_base64: encoding == Some("base64"),
        }
    }

    /// The bytes from an offset on.
    fn at(self, offset: usize) -> Result<Encoded<'a>> {
        let bytes = self.bytes.get(offset..).ok_or_else(|| {
            let problem = format!(
                "it begins at byte {offset} of {} appended ones",
                self.bytes.len()
            );
            FileFault::new(problem, "a whole file")
        })?;
        Ok(if self.is_base64 {
            Encoded::Base64(Base64::new(bytes))
        } else {
            Encoded::Raw(bytes)
        })
    }
}

/// Reads the pieces of a file.
struct XmlReader<'a> {
    storage: ArrayEncoding,
    appended: Appended<'a>,
    data_set: &'a Element<'a>,
    wanted: &'a Wanted<'a>,
}

impl XmlReader<'_> {
    fn piece(&self, kind: &str, piece: &Element, budget: &mut Budget) -> Result<Piece> {
        let (points, topology) = match kind {
            "UnstructuredGrid" => {
                let cells = self.grid_cells(piece, budget)?;
                (self.points(piece, budget)?, Topology::Cells(cells))
            }
            "PolyData" => {
                let cells = self.poly_cells(piece, budget)?;
                (self.points(piece, budget)?, Topology::Cells(cells))
            }
            "StructuredGrid" => {
                let size = grid_size(piece.numbers("Extent")?)?;
                (self.points(piece, budget)?, Topology::Grid(size))
            }
            "RectilinearGrid" => self.rectilinear(piece, budget)?,
            "ImageData" => self.image(piece)?,
            _ => {
                let problem = format!("it is a data set of the type `{}`", cut(kind));
                let expected = "PolyData, UnstructuredGrid, StructuredGrid, RectilinearGrid or \
                     ImageData";
                return Err(FileFault::new(problem, expected));
            }
        };
        let piece = Piece {
            points,
            topology,
            point_data: self.attributes(piece.child("PointData"), budget)?,
            cell_data: self.attributes(piece.child("CellData"), budget)?,
        };
        piece.check()?;
        Ok(piece)
    }

    fn points(&self, piece: &Element, budget: &mut Budget) -> Result<PointPositions> {
        let array = piece
            .child("Points")
            .and_then(|points| points.child("DataArray"));
        let points = match array {
            Some(array) => self.numbers("Points", array, budget)?,
            None => Numbers::of_text(&[]),
        };
        Ok(PointPositions::Explicit(points.in_tuples_of(3)))
    }

    fn grid_cells(&self, piece: &Element, budget: &mut Budget) -> Result<Cells> {
        let mut cells = Cells::of_points(piece.number("NumberOfPoints")?);
        let n_cells = piece.number("NumberOfCells")?;
        if n_cells > 0 {
            let element = piece.child("Cells").unwrap_or(piece);
            let types = self.named(element, "types", budget)?;
            types.check("types", n_cells)?;
            self.add_cells(&mut cells, element, |cell| types.at(cell), n_cells, budget)?;
        }
        Ok(cells)
    }

    /// The cells of polydata, in the order of the cells' arrays.
    fn poly_cells(&self, piece: &Element, budget: &mut Budget) -> Result<Cells> {
        let mut cells = Cells::of_points(piece.number("NumberOfPoints")?);
        for (name, cell_type) in [
            ("Verts", POLY_VERTEX),
            ("Lines", POLY_LINE),
            ("Polys", POLYGON),
            ("Strips", STRIP),
        ] {
            let n_cells = piece.number(&format!("NumberOf{name}"))?;
            if n_cells > 0 {
                let element = piece.child(name).unwrap_or(piece);
                self.add_cells(&mut cells, element, |_| cell_type.into(), n_cells, budget)?;
            }
        }
        Ok(cells)
    }

    fn add_cells(
        &self,
        cells: &mut Cells,
        element: &Element,
        types: impl Fn(usize) -> f64,
        n_cells: usize,
        budget: &mut Budget,
    ) -> Result<()> {
        let ends = self.named(element, "offsets", budget)?;
        let connectivity = self.named(element, "connectivity", budget)?;
        cells.add(types, n_cells, &ends, &connectivity, budget)
    }

    fn rectilinear(
        &self,
        piece: &Element,
        budget: &mut Budget,
    ) -> Result<(PointPositions, Topology)> {
        let size = grid_size(piece.numbers("Extent")?)?;
        let element = piece.child("Coordinates").unwrap_or(piece);
        let axes: Vec<&Element> = element.children.iter().collect();
        let [x, y, z] = axes[..] else {
            let problem = format!("it has coordinates of {} axes", axes.len());
            return Err(FileFault::new(problem, "three"));
        };
        let axis = |i: usize, array: &Element, budget: &mut Budget| {
            let numbers = self.numbers("Coordinates", array, budget)?;
            numbers.check("Coordinates", size[i]).map(|()| numbers)
        };
        let axes = [
            axis(0, x, budget)?,
            axis(1, y, budget)?,
            axis(2, z, budget)?,
        ];
        Ok((PointPositions::Axes(axes), Topology::Grid(size)))
    }

    fn image(&self, piece: &Element) -> Result<(PointPositions, Topology)> {
        let extent: [i64; 6] = piece.numbers("Extent")?;
        let size = grid_size(extent)?;
        let direction = match self.data_set.attribute("Direction") {
            Some(_) => self.data_set.numbers("Direction")?,
            None => IDENTITY,
        };
        let lattice = Lattice {
            size,
            first: [extent[0], extent[2], extent[4]],
            origin: self.data_set.numbers("Origin")?,
            spacing: self.data_set.numbers("Spacing")?,
            direction,
        };
        Ok((PointPositions::Lattice(lattice), Topology::Grid(size)))
    }

    /// The arrays of `PointData` or `CellData` that are wanted.
    fn attributes(&self, element: Option<&Element>, budget: &mut Budget) -> Result<PieceArrays> {
        let mut attributes = PieceArrays::default();
        let Some(element) = element else {
            return Ok(attributes);
        };
        let active = |name: &str| element.attribute(name).map(str::to_owned);
        (attributes.normals, attributes.uvs) = (active("Normals"), active("TCoords"));
        for array in element
            .children
            .iter()
            .filter(|child| child.name == "DataArray")
        {
            let name = array.attribute("Name").unwrap_or_default().to_owned();
            let is_active = [&attributes.normals, &attributes.uvs].contains(&&Some(name.clone()));
            if is_active || is_wanted(&name, self.wanted) {
                let numbers = self.numbers(&name, array, budget)?;
                attributes.arrays.push((name.clone(), numbers));
            }
            attributes.names.push(name);
        }
        Ok(attributes)
    }

    /// The array of this name within an element.
    fn named(&self, element: &Element, name: &str, budget: &mut Budget) -> Result<Numbers> {
        let mut arrays = element.children.iter();
        let array = arrays.find(|array| array.attribute("Name") == Some(name));
        let missing = || {
            let problem = format!("its element `{}` has no array `{name}`", element.name);
            FileFault::new(problem, "a VTK file as VTK writes it")
        };
        self.numbers(name, array.ok_or_else(missing)?, budget)
    }

    /// The numbers of an array.
    fn numbers(&self, name: &str, array: &Element, budget: &mut Budget) -> Result<Numbers> {
        let decoded = self.decode(array, budget).map_err(|fault| {
            let problem = format!("the array `{}`: {}", cut(name), fault.problem);
            FileFault { problem, ..fault }
        })?;
        let n_components = array.attribute("NumberOfComponents");
        let n_components = match n_components {
            Some(_) => array.number("NumberOfComponents")?,
            None => 1,
        };
        if n_components == 0 || !decoded.len().is_multiple_of(n_components) {
            let problem = format!("the array `{}` has {} numbers", cut(name), decoded.len());
            let expected = format!("a multiple of its {n_components} components");
            return Err(FileFault::new(problem, expected));
        }
        Ok(decoded.in_tuples_of(n_components))
    }

    fn decode(&self, array: &Element, budget: &mut Budget) -> Result<Numbers> {
        let kind = array.required("type")?;
        let kind = NumberType::named(kind).ok_or_else(|| {
            let problem = format!("it has values of the type `{}`", cut(kind));
            FileFault::new(problem, "numbers of 8 to 64 bits")
        })?;
        let bytes = match array.attribute("format").unwrap_or("ascii") {
            "ascii" => return ascii(array.text, budget),
            "binary" => {
                let text = Encoded::Base64(Base64::new(array.text));
                self.storage.decode(text, budget)?
            }
            "appended" => {
                let [offset] = array.numbers("offset")?;
                self.storage.decode(self.appended.at(offset)?, budget)?
            }
            other => {
                let problem = format!("its format is `{}`", cut(other));
                return Err(FileFault::new(problem, "ascii, binary or appended"));
            }
        };
        if !bytes.len().is_multiple_of(kind.n_bytes()) {
            let problem = format!("it has {} bytes", bytes.len());
            let expected = format!("a multiple of {}", kind.n_bytes());
            return Err(FileFault::new(problem, expected));
        }
        Ok(Numbers::new(kind, self.storage.order, bytes))
    }
}

/// The numbers of a text.
fn ascii(text: &[u8], budget: &mut Budget) -> Result<Numbers> {
    budget.take_of::<[f64; 2]>(text.len() / 2)?;
    let words = text
        .split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty());
    let numbers = words.map(|word| {
        let word = String::from_utf8_lossy(word);
        let no_number = |_| FileFault::new(format!("`{}` is no number", cut(&word)), "a number");
        word.parse::<f64>().map_err(no_number)
    });
    Ok(Numbers::of_text(&numbers.collect::<Result<Vec<f64>>>()?))
}

/// The axes of images without a direction.
pub(super) const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
