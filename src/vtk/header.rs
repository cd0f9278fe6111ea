//! The XML in front of the arrays.

use std::io;

use serde::Serialize;
use vtkio::model::{ByteOrder, Version};
use vtkio::xml::{AttributeData, DataArray, DataArrayFormat, DataSetType, ScalarType, se};

use super::array::Array;
use super::codec::Compressor;
use crate::provenance::RunId;

/// What a file holds.
pub(crate) enum DataSet<'a> {
    /// A regular grid of points, one unit apart from the origin on.
    Image {
        /// Columns and rows.
        size: [u32; 2],
        point_data: Vec<Array<'a>>,
    },
    /// A regular grid of square cells.
    ImageCells {
        /// Columns and rows.
        size: [u32; 2],
        /// The lower left corner of the first cell.
        origin: [f64; 2],
        /// The side of a cell.
        spacing: f64,
        cell_data: Vec<Array<'a>>,
    },
    /// Cells of any kind; of `cells` the last one is their `types`.
    Grid(Mesh<'a>),
    /// Lines alone.
    Lines(Mesh<'a>),
}

/// Where each array begins after the underscore, in the arrays' order.
pub(crate) enum Offsets<'a> {
    OfRaw(Vec<u64>),
    /// The header has the same length, whatever they are.
    OfCompressed(&'a dyn Compressor, Vec<u64>),
}

/// Points and cells, and what is known of each.
pub(crate) struct Mesh<'a> {
    pub(crate) n_points: usize,
    pub(crate) n_cells: usize,
    pub(crate) point_data: Vec<Array<'a>>,
    pub(crate) cell_data: Vec<Array<'a>>,
    /// Where the points are.
    pub(crate) points: Array<'a>,
    /// `connectivity` and `offsets`, see
    /// [`separate_cells`](super::array::separate_cells).
    pub(crate) cells: Vec<Array<'a>>,
}

impl<'a> DataSet<'a> {
    /// All arrays in the order of the file.
    pub(crate) fn arrays(&self) -> Vec<&Array<'a>> {
        match self {
            Self::Image { point_data, .. } => point_data.iter().collect(),
            Self::ImageCells { cell_data, .. } => cell_data.iter().collect(),
            Self::Grid(mesh) | Self::Lines(mesh) => mesh.arrays().collect(),
        }
    }

    /// The file's text up to the closing tag of the root, which names the run.
    pub(crate) fn xml(&self, run: Option<RunId>, offsets: &Offsets) -> io::Result<String> {
        let (data_set_type, content) = match self {
            Self::Image { size, point_data } => {
                (DataSetType::ImageData, image_element(*size, point_data))
            }
            Self::ImageCells {
                size,
                origin,
                spacing,
                cell_data,
            } => {
                let cells = image_cells_element(*size, *origin, *spacing, cell_data);
                (DataSetType::ImageData, cells)
            }
            Self::Grid(mesh) => (DataSetType::UnstructuredGrid, grid_element(mesh)),
            Self::Lines(mesh) => (DataSetType::PolyData, lines_element(mesh)),
        };
        let file = VtkFile {
            data_set_type,
            version: Version::new_xml(1, 0),
            byte_order: native_byte_order(),
            header_type: ScalarType::UInt64,
            compressor: offsets.compressor().map(Compressor::vtk_class),
            run,
            content,
        };
        let xml = se::to_string(&file).map_err(io::Error::other)?;
        // vtkio's offset is 32 bits wide: put ours, of 64, in its places.
        let mut parts = xml.split(OFFSET);
        let mut text = parts.next().unwrap_or_default().to_owned();
        for (part, attribute) in parts.zip(offsets.attributes()) {
            text += &attribute;
            text += part;
        }
        Ok(text.trim_end_matches("</VTKFile>").to_owned())
    }
}

impl Offsets<'_> {
    fn compressor(&self) -> Option<&dyn Compressor> {
        match self {
            Self::OfRaw(_) => None,
            Self::OfCompressed(compressor, _) => Some(*compressor),
        }
    }

    fn attributes(&self) -> Vec<String> {
        let attribute = |offset: &u64| format!("offset=\"{offset}\"");
        match self {
            Self::OfRaw(offsets) => offsets.iter().map(attribute).collect(),
            // Blanks behind the quotes: within, not all readers take them.
            Self::OfCompressed(_, offsets) => {
                let width = attribute(&u64::MAX).len();
                let padded = |offset| format!("{:width$}", attribute(offset));
                offsets.iter().map(padded).collect()
            }
        }
    }
}

impl<'a> Mesh<'a> {
    fn arrays(&self) -> impl Iterator<Item = &Array<'a>> {
        let data = self.point_data.iter().chain(&self.cell_data);
        data.chain([&self.points]).chain(&self.cells)
    }
}

/// What vtkio writes for each offset.
const OFFSET: &str = "offset=\"0\"";

/// The root element. vtkio's own keeps its parts private and leaves out
/// `NumberOfPoints="0"`, which VTK wants to see.
#[derive(Serialize)]
#[serde(rename = "VTKFile")]
struct VtkFile {
    #[serde(rename = "@type")]
    data_set_type: DataSetType,
    #[serde(rename = "@version")]
    version: Version,
    #[serde(rename = "@byte_order")]
    byte_order: ByteOrder,
    #[serde(rename = "@header_type")]
    header_type: ScalarType,
    #[serde(rename = "@compressor", skip_serializing_if = "Option::is_none")]
    compressor: Option<&'static str>,
    /// VTK passes it over, as do meshio and vtkio.
    #[serde(rename = "@raycost_run", skip_serializing_if = "Option::is_none")]
    run: Option<RunId>,
    #[serde(rename = "$value")]
    content: Content,
}

/// The element of the data set.
#[derive(Serialize)]
enum Content {
    ImageData(ImageElement),
    UnstructuredGrid(MeshElement),
    PolyData(MeshElement),
}

#[derive(Serialize)]
struct ImageElement {
    #[serde(rename = "@WholeExtent")]
    extent: String,
    #[serde(rename = "@Origin")]
    origin: String,
    #[serde(rename = "@Spacing")]
    spacing: String,
    #[serde(rename = "Piece")]
    piece: ImagePiece,
}

#[derive(Serialize)]
struct ImagePiece {
    #[serde(rename = "@Extent")]
    extent: String,
    #[serde(rename = "PointData")]
    point_data: AttributeData,
    #[serde(rename = "CellData")]
    cell_data: AttributeData,
}

#[derive(Serialize)]
struct MeshElement {
    #[serde(rename = "Piece")]
    piece: MeshPiece,
}

/// The parts that a mesh has none of are left out, numbers and elements.
#[derive(Serialize)]
struct MeshPiece {
    #[serde(rename = "@NumberOfPoints")]
    n_points: usize,
    #[serde(rename = "@NumberOfCells", skip_serializing_if = "Option::is_none")]
    n_cells: Option<usize>,
    #[serde(rename = "@NumberOfLines", skip_serializing_if = "Option::is_none")]
    n_lines: Option<usize>,
    #[serde(rename = "PointData")]
    point_data: AttributeData,
    #[serde(rename = "CellData")]
    cell_data: AttributeData,
    #[serde(rename = "Points")]
    points: DataArrays,
    #[serde(rename = "Cells", skip_serializing_if = "Option::is_none")]
    cells: Option<DataArrays>,
    #[serde(rename = "Lines", skip_serializing_if = "Option::is_none")]
    lines: Option<DataArrays>,
}

#[derive(Serialize)]
struct DataArrays {
    #[serde(rename = "DataArray")]
    arrays: Vec<DataArray>,
}

fn image_element([width, height]: [u32; 2], point_data: &[Array]) -> Content {
    let extent = format!("0 {} 0 {} 0 0", width - 1, height - 1);
    Content::ImageData(ImageElement {
        extent: extent.clone(),
        origin: "0 0 0".to_owned(),
        spacing: "1 1 1".to_owned(),
        piece: ImagePiece {
            extent,
            point_data: attributes(point_data),
            cell_data: attributes(&[]),
        },
    })
}

fn image_cells_element(
    [n_columns, n_rows]: [u32; 2],
    [x, y]: [f64; 2],
    spacing: f64,
    cell_data: &[Array],
) -> Content {
    let extent = format!("0 {n_columns} 0 {n_rows} 0 0");
    Content::ImageData(ImageElement {
        extent: extent.clone(),
        origin: format!("{x} {y} 0"),
        spacing: format!("{spacing} {spacing} {spacing}"),
        piece: ImagePiece {
            extent,
            point_data: attributes(&[]),
            cell_data: attributes(cell_data),
        },
    })
}

fn grid_element(mesh: &Mesh) -> Content {
    let piece = MeshPiece {
        n_cells: Some(mesh.n_cells),
        cells: Some(data_arrays(&mesh.cells)),
        ..mesh_piece(mesh)
    };
    Content::UnstructuredGrid(MeshElement { piece })
}

fn lines_element(mesh: &Mesh) -> Content {
    let piece = MeshPiece {
        n_lines: Some(mesh.n_cells),
        lines: Some(data_arrays(&mesh.cells)),
        ..mesh_piece(mesh)
    };
    Content::PolyData(MeshElement { piece })
}

/// The points' array that their surface is lit by.
const NORMALS: &str = "Normals";

/// What meshes of all kinds have.
fn mesh_piece(mesh: &Mesh) -> MeshPiece {
    let normals = mesh.point_data.iter().any(|array| array.name == NORMALS);
    MeshPiece {
        n_points: mesh.n_points,
        n_cells: None,
        n_lines: None,
        point_data: AttributeData {
            normals: normals.then(|| NORMALS.to_owned()),
            ..attributes(&mesh.point_data)
        },
        cell_data: attributes(&mesh.cell_data),
        points: data_arrays([&mesh.points]),
        cells: None,
        lines: None,
    }
}

fn attributes(arrays: &[Array]) -> AttributeData {
    AttributeData {
        data_array: data_arrays(arrays).arrays,
        ..AttributeData::default()
    }
}

fn data_arrays<'a: 'b, 'b>(arrays: impl IntoIterator<Item = &'b Array<'a>>) -> DataArrays {
    let data_array = |array: &Array| DataArray {
        scalar_type: array.scalar.into(),
        name: array.name.to_owned(),
        num_comp: array.n_components as u32,
        format: DataArrayFormat::Appended,
        offset: Some(0),
        range_min: None,
        range_max: None,
        data: Vec::new(),
    };
    DataArrays {
        arrays: arrays.into_iter().map(data_array).collect(),
    }
}

fn native_byte_order() -> ByteOrder {
    if cfg!(target_endian = "little") {
        ByteOrder::LittleEndian
    } else {
        ByteOrder::BigEndian
    }
}
