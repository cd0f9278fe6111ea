//! The XML elements of data sets.

use serde::Serialize;
use vtkio::xml::{AttributeData, DataArray, DataArrayFormat, DataSetType};

use super::array::Array;
use super::data_set::{CellMesh, DataSet};

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

/// Returns the type and the element of a data set.
pub(super) fn content(data_set: &DataSet) -> (DataSetType, DataElement) {
    match data_set {
        DataSet::Image { size, point_data } => {
            (DataSetType::ImageData, image_element(*size, point_data))
        }
        DataSet::ImageCells {
            size,
            origin,
            spacing,
            cell_data,
        } => {
            let cells = image_cells_element(*size, *origin, *spacing, cell_data);
            (DataSetType::ImageData, cells)
        }
        DataSet::Grid(mesh) => (DataSetType::UnstructuredGrid, grid_element(mesh)),
        DataSet::Lines(mesh) => (DataSetType::PolyData, lines_element(mesh)),
    }
}

fn image_element([width, height]: [u32; 2], point_data: &[Array]) -> DataElement {
    let extent = format!("0 {} 0 {} 0 0", width - 1, height - 1);
    DataElement::ImageData(ImageElement {
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
) -> DataElement {
    let extent = format!("0 {n_columns} 0 {n_rows} 0 0");
    DataElement::ImageData(ImageElement {
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

fn grid_element(mesh: &CellMesh) -> DataElement {
    let piece = MeshPiece {
        n_cells: Some(mesh.n_cells),
        cells: Some(data_arrays(&mesh.cells)),
        ..mesh_piece(mesh)
    };
    DataElement::UnstructuredGrid(MeshElement { piece })
}

fn lines_element(mesh: &CellMesh) -> DataElement {
    let piece = MeshPiece {
        n_lines: Some(mesh.n_cells),
        lines: Some(data_arrays(&mesh.cells)),
        ..mesh_piece(mesh)
    };
    DataElement::PolyData(MeshElement { piece })
}

/// The point array that VTK uses as normals.
const NORMALS: &str = "Normals";

/// The parts that all kinds of meshes have.
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
