//! The XML elements of data sets.

use serde::Serialize;
use vtkio::xml::{AttributeData, DataArray, DataArrayFormat, DataSetType, ScalarType};

use crate::array::Array;
use crate::data_set::{CellMesh, DataSet, Extent};
use crate::field::{Field, FieldValues};

/// The element of a data set.
#[derive(Serialize)]
pub(super) enum DataElement {
    ImageData(ImageElement),
    UnstructuredGrid(MeshElement),
    PolyData(MeshElement),
}

/// The element `ImageData`.
#[derive(Serialize)]
pub(super) struct ImageElement {
    #[serde(rename = "@WholeExtent")]
    extent: String,
    #[serde(rename = "@Origin")]
    origin: String,
    #[serde(rename = "@Spacing")]
    spacing: String,
    #[serde(rename = "FieldData", skip_serializing_if = "Option::is_none")]
    field_data: Option<FieldDataElement>,
    #[serde(rename = "Piece")]
    piece: ImagePiece,
}

/// The piece of an image.
#[derive(Serialize)]
struct ImagePiece {
    #[serde(rename = "@Extent")]
    extent: String,
    #[serde(rename = "PointData")]
    point_data: AttributeData,
    #[serde(rename = "CellData")]
    cell_data: AttributeData,
}

/// The element `UnstructuredGrid` or `PolyData`.
#[derive(Serialize)]
pub(super) struct MeshElement {
    #[serde(rename = "FieldData", skip_serializing_if = "Option::is_none")]
    field_data: Option<FieldDataElement>,
    #[serde(rename = "Piece")]
    piece: MeshPiece,
}

/// The piece of a mesh, without the attributes and elements of absent parts.
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

/// The element `FieldData`.
#[derive(Serialize)]
pub(super) struct FieldDataElement {
    #[serde(rename = "DataArray")]
    numbers: Vec<FieldArray>,
    #[serde(rename = "Array")]
    texts: Vec<TextArray>,
}

/// An array of numbers with its length, which vtkio's type lacks.
#[derive(Serialize)]
struct FieldArray {
    #[serde(rename = "@type")]
    scalar_type: ScalarType,
    #[serde(rename = "@Name")]
    name: String,
    #[serde(rename = "@NumberOfTuples")]
    n_tuples: u64,
    #[serde(rename = "@format")]
    format: DataArrayFormat,
    #[serde(rename = "@offset")]
    offset: u64,
}

/// An array of texts: their bytes as numbers, each text terminated by 0.
#[derive(Serialize)]
struct TextArray {
    #[serde(rename = "@type")]
    kind: &'static str,
    #[serde(rename = "@Name")]
    name: String,
    #[serde(rename = "@NumberOfTuples")]
    n_tuples: usize,
    #[serde(rename = "@format")]
    format: &'static str,
    #[serde(rename = "$text")]
    bytes: String,
}

impl FieldDataElement {
    /// Creates the element; `None` if it would be empty.
    pub(super) fn new<'a>(
        numbers: &[Array],
        texts: impl Iterator<Item = &'a Field>,
    ) -> Option<Self> {
        let numbers = numbers.iter().map(|array| FieldArray {
            scalar_type: array.scalar.into(),
            name: array.name.to_owned(),
            n_tuples: array.n_tuples(),
            format: DataArrayFormat::Appended,
            offset: 0,
        });
        let this = Self {
            numbers: numbers.collect(),
            texts: texts.filter_map(text_array).collect(),
        };
        let is_empty = this.numbers.is_empty() && this.texts.is_empty();
        (!is_empty).then_some(this)
    }
}

fn text_array(field: &Field) -> Option<TextArray> {
    let FieldValues::Texts(texts) = &field.values else {
        return None;
    };
    let bytes = texts.iter().flat_map(|text| text.bytes().chain([0]));
    let bytes: Vec<String> = bytes.map(|byte| byte.to_string()).collect();
    Some(TextArray {
        kind: "String",
        name: field.name.clone(),
        n_tuples: texts.len(),
        format: "ascii",
        bytes: bytes.join(" "),
    })
}

/// Returns the type and the element of a data set with these field data.
pub(super) fn content(
    data_set: &DataSet,
    field_data: Option<FieldDataElement>,
) -> (DataSetType, DataElement) {
    match data_set {
        DataSet::Image { extent, point_data } => {
            let element = image_element(extent, point_data, field_data);
            (DataSetType::ImageData, DataElement::ImageData(element))
        }
        DataSet::ImageCells {
            size,
            origin,
            spacing,
            cell_data,
        } => {
            let element = image_cells_element(*size, *origin, *spacing, cell_data, field_data);
            (DataSetType::ImageData, DataElement::ImageData(element))
        }
        DataSet::Grid(mesh) => {
            let piece = grid_piece(mesh);
            let element = MeshElement { field_data, piece };
            let kind = DataSetType::UnstructuredGrid;
            (kind, DataElement::UnstructuredGrid(element))
        }
        DataSet::Lines(mesh) => {
            let piece = lines_piece(mesh);
            let element = MeshElement { field_data, piece };
            (DataSetType::PolyData, DataElement::PolyData(element))
        }
    }
}

fn image_element(
    extent: &Extent,
    point_data: &[Array],
    field_data: Option<FieldDataElement>,
) -> ImageElement {
    let extent = extent.to_string();
    ImageElement {
        extent: extent.clone(),
        origin: "0 0 0".to_owned(),
        spacing: "1 1 1".to_owned(),
        field_data,
        piece: ImagePiece {
            extent,
            point_data: attributes(point_data),
            cell_data: attributes(&[]),
        },
    }
}

fn image_cells_element(
    [n_columns, n_rows]: [u32; 2],
    [x, y]: [f64; 2],
    spacing: f64,
    cell_data: &[Array],
    field_data: Option<FieldDataElement>,
) -> ImageElement {
    let extent = format!("0 {n_columns} 0 {n_rows} 0 0");
    ImageElement {
        extent: extent.clone(),
        origin: format!("{x} {y} 0"),
        spacing: format!("{spacing} {spacing} {spacing}"),
        field_data,
        piece: ImagePiece {
            extent,
            point_data: attributes(&[]),
            cell_data: attributes(cell_data),
        },
    }
}

fn grid_piece(mesh: &CellMesh) -> MeshPiece {
    MeshPiece {
        n_cells: Some(mesh.n_cells),
        cells: Some(data_arrays(&mesh.cells)),
        ..mesh_piece(mesh)
    }
}

fn lines_piece(mesh: &CellMesh) -> MeshPiece {
    MeshPiece {
        n_lines: Some(mesh.n_cells),
        lines: Some(data_arrays(&mesh.cells)),
        ..mesh_piece(mesh)
    }
}

/// The point array that VTK uses as normals.
const NORMALS: &str = "Normals";

/// Returns the parts that all kinds of meshes have.
fn mesh_piece(mesh: &CellMesh) -> MeshPiece {
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
    DataArrays {
        arrays: arrays.into_iter().map(data_array).collect(),
    }
}

fn data_array(array: &Array) -> DataArray {
    DataArray {
        scalar_type: array.scalar.into(),
        name: array.name.to_owned(),
        num_comp: array.n_components as u32,
        format: DataArrayFormat::Appended,
        offset: Some(0),
        range_min: None,
        range_max: None,
        data: Vec::new(),
    }
}
