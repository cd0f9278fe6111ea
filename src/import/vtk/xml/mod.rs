//! VTK's XML files.
//!
//! The format is described in "VTK XML Formats" (docs.vtk.org, VTK file formats). vtkio's reader
//! does not support raw appended data, panics on some damaged files, and does not name what it
//! skips.

mod arrays;

use std::path::PathBuf;

use super::super::fault::cut;
use super::super::{FileFault, Result};
use super::budget::Budget;
use super::cells::{Cells, POLY_LINE, POLY_VERTEX, POLYGON, STRIP};
use super::document::{number_or, numbers, parse};
use super::numbers::Numbers;
use super::piece::{
    Lattice, Piece, PieceArrays, PointPositions, Topology, Wanted, grid_size, is_wanted,
};
use super::polyhedra::Polyhedra;
use arrays::XmlArrays;
use vtk::read::Element;

/// The contents of a file.
#[derive(Debug)]
pub(super) enum Contents {
    Pieces(Vec<Piece>),
    /// Pieces in separate files, relative to the file's folder.
    Files(Vec<PathBuf>),
}

/// Reads a file with the wanted arrays.
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
        arrays: XmlArrays::new(&root, appended)?,
        data_set,
        wanted,
    };
    let pieces = data_set.children_named("Piece");
    pieces
        .map(|piece| reader.piece(kind, piece, budget))
        .collect::<Result<_>>()
        .map(Contents::Pieces)
}

/// Returns the files of the pieces or blocks within an element.
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

/// Reads the pieces of a file.
struct XmlReader<'a> {
    arrays: XmlArrays<'a>,
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
                let size = grid_size(numbers(piece, "Extent")?)?;
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
        let mut found = Piece {
            points,
            topology,
            point_data: PieceArrays::default(),
            cell_data: PieceArrays::default(),
        };
        let (n_points, n_cells) = (found.n_points(), found.n_cells());
        found.point_data = self.attributes(piece.child("PointData"), n_points, budget)?;
        found.cell_data = self.attributes(piece.child("CellData"), n_cells, budget)?;
        found.check()?;
        Ok(found)
    }

    fn points(&self, piece: &Element, budget: &mut Budget) -> Result<PointPositions> {
        let array = piece
            .child("Points")
            .and_then(|points| points.child("DataArray"));
        let points = match array {
            Some(array) => self.arrays.numbers("Points", array, budget)?,
            None => Numbers::from_text(Vec::new()),
        };
        Ok(PointPositions::Explicit(points.in_tuples_of(3)))
    }

    fn grid_cells(&self, piece: &Element, budget: &mut Budget) -> Result<Cells> {
        let mut cells = Cells::of_points(number_or(piece, "NumberOfPoints", 0)?);
        let n_cells = number_or(piece, "NumberOfCells", 0)?;
        if n_cells > 0 {
            let element = piece.child("Cells").unwrap_or(piece);
            let types = self.arrays.named(element, "types", budget)?;
            types.check("types", n_cells)?;
            self.add_cells(&mut cells, element, |cell| types.at(cell), n_cells, budget)?;
            if cells.has_polyhedra() {
                cells.polyhedra = self.polyhedra(element, cells.n_points, budget)?;
            }
        }
        Ok(cells)
    }

    fn polyhedra(
        &self,
        element: &Element,
        n_points: usize,
        budget: &mut Budget,
    ) -> Result<Polyhedra> {
        let mut array = |name: &str| self.arrays.named(element, name, budget);
        if element.array("polyhedron_offsets").is_some() {
            let arrays = [
                array("face_connectivity")?,
                array("face_offsets")?,
                array("polyhedron_to_faces")?,
                array("polyhedron_offsets")?,
            ];
            return Polyhedra::of_arrays(arrays.each_ref(), n_points, budget);
        }
        if element.array("faceoffsets").is_some() {
            let arrays = [array("faces")?, array("faceoffsets")?];
            return Polyhedra::of_stream(arrays.each_ref(), n_points, budget);
        }
        Ok(Polyhedra::default())
    }

    /// Reads the cells of polydata, in the order of the cell arrays.
    fn poly_cells(&self, piece: &Element, budget: &mut Budget) -> Result<Cells> {
        let mut cells = Cells::of_points(number_or(piece, "NumberOfPoints", 0)?);
        for (name, cell_type) in [
            ("Verts", POLY_VERTEX),
            ("Lines", POLY_LINE),
            ("Polys", POLYGON),
            ("Strips", STRIP),
        ] {
            let n_cells = number_or(piece, &format!("NumberOf{name}"), 0)?;
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
        let ends = self.arrays.named(element, "offsets", budget)?;
        let connectivity = self.arrays.named(element, "connectivity", budget)?;
        cells.add(types, n_cells, &ends, &connectivity, budget)
    }

    fn rectilinear(
        &self,
        piece: &Element,
        budget: &mut Budget,
    ) -> Result<(PointPositions, Topology)> {
        let size = grid_size(numbers(piece, "Extent")?)?;
        let element = piece.child("Coordinates").unwrap_or(piece);
        let axes: Vec<&Element> = element.children.iter().collect();
        let [x, y, z] = axes[..] else {
            let problem = format!("it has coordinates of {} axes", axes.len());
            return Err(FileFault::new(problem, "three"));
        };
        let axis = |i: usize, array: &Element, budget: &mut Budget| {
            let numbers = self.arrays.numbers("Coordinates", array, budget)?;
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
        let extent: [i64; 6] = numbers(piece, "Extent")?;
        let size = grid_size(extent)?;
        let direction = match self.data_set.attribute("Direction") {
            Some(_) => numbers(self.data_set, "Direction")?,
            None => IDENTITY,
        };
        let lattice = Lattice {
            size,
            first: [extent[0], extent[2], extent[4]],
            origin: numbers(self.data_set, "Origin")?,
            spacing: numbers(self.data_set, "Spacing")?,
            direction,
        };
        Ok((PointPositions::Lattice(lattice), Topology::Grid(size)))
    }

    /// Reads the wanted arrays of `PointData` or `CellData`.
    fn attributes(
        &self,
        element: Option<&Element>,
        n_tuples: usize,
        budget: &mut Budget,
    ) -> Result<PieceArrays> {
        let mut attributes = PieceArrays::default();
        let Some(element) = element else {
            return Ok(attributes);
        };
        let active = |name: &str| element.attribute(name).map(str::to_owned);
        (attributes.normals, attributes.uvs) = (active("Normals"), active("TCoords"));
        for array in element.children_named("DataArray") {
            let name = array.attribute("Name").unwrap_or_default().to_owned();
            let is_active = [&attributes.normals, &attributes.uvs].contains(&&Some(name.clone()));
            if is_active || is_wanted(&name, self.wanted) {
                let numbers = self.arrays.tuples(&name, array, n_tuples, budget)?;
                attributes.arrays.push((name.clone(), numbers));
            }
            // Texts give no colors.
            if array.attribute("type") != Some("String") {
                attributes.names.push(name);
            }
        }
        Ok(attributes)
    }
}

/// The axes of images without a direction.
pub(super) const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
