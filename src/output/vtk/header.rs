//! The XML in front of the raw arrays.

use std::io;

use serde::Serialize;
use vtkio::model::{ByteOrder, Version};
use vtkio::xml::{AttributeData, DataArray, DataArrayFormat, DataSetType, ScalarType, se};

use super::appended::Array;

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
    #[serde(rename = "$value")]
    data_set: DataSet,
}

/// What a file holds.
#[derive(Serialize)]
pub(crate) enum DataSet {
    /// A regular grid of points.
    ImageData(ImageData),
    /// Points and cells.
    UnstructuredGrid(UnstructuredGrid),
}

#[derive(Serialize)]
pub(crate) struct ImageData {
    #[serde(rename = "@WholeExtent")]
    extent: String,
    #[serde(rename = "@Origin")]
    origin: &'static str,
    #[serde(rename = "@Spacing")]
    spacing: &'static str,
    #[serde(rename = "Piece")]
    piece: ImagePiece,
}

#[derive(Serialize)]
struct ImagePiece {
    #[serde(rename = "@Extent")]
    extent: String,
    #[serde(rename = "PointData")]
    point_data: AttributeData,
}

#[derive(Serialize)]
pub(crate) struct UnstructuredGrid {
    #[serde(rename = "Piece")]
    piece: GridPiece,
}

#[derive(Serialize)]
struct GridPiece {
    #[serde(rename = "@NumberOfPoints")]
    n_points: usize,
    #[serde(rename = "@NumberOfCells")]
    n_cells: usize,
    #[serde(rename = "PointData")]
    point_data: AttributeData,
    #[serde(rename = "Points")]
    points: DataArrays,
    #[serde(rename = "Cells")]
    cells: DataArrays,
}

#[derive(Serialize)]
struct DataArrays {
    #[serde(rename = "DataArray")]
    arrays: Vec<DataArray>,
}

impl DataSet {
    /// An image of `width * height` points, one unit apart from the origin on.
    pub(crate) fn image(width: u32, height: u32, point_data: &[Array]) -> Self {
        let extent = format!("0 {} 0 {} 0 0", width - 1, height - 1);
        Self::ImageData(ImageData {
            extent: extent.clone(),
            origin: "0 0 0",
            spacing: "1 1 1",
            piece: ImagePiece {
                extent,
                point_data: attributes(point_data),
            },
        })
    }

    /// As many cells as points.
    pub(super) fn vertices(
        n: usize,
        point_data: &[Array],
        points: &[Array],
        cells: &[Array],
    ) -> Self {
        Self::UnstructuredGrid(UnstructuredGrid {
            piece: GridPiece {
                n_points: n,
                n_cells: n,
                point_data: AttributeData {
                    normals: Some("Normals".to_owned()),
                    ..attributes(point_data)
                },
                points: DataArrays {
                    arrays: data_arrays(points),
                },
                cells: DataArrays {
                    arrays: data_arrays(cells),
                },
            },
        })
    }

    /// The file's text up to the closing tag of the root; `offsets` tells
    /// where each array begins after the underscore, in the arrays' order.
    pub(super) fn xml(self, offsets: &[u64]) -> io::Result<String> {
        let file = VtkFile {
            data_set_type: match self {
                Self::ImageData(_) => DataSetType::ImageData,
                Self::UnstructuredGrid(_) => DataSetType::UnstructuredGrid,
            },
            version: Version::new_xml(1, 0),
            byte_order: native_byte_order(),
            header_type: ScalarType::UInt64,
            data_set: self,
        };
        let xml = se::to_string(&file).map_err(io::Error::other)?;
        // vtkio's offset is 32 bits wide: put ours, of 64, in its places.
        let placeholder = offset_attribute(0);
        let mut parts = xml.split(&placeholder);
        let mut text = parts.next().unwrap_or_default().to_owned();
        for (part, &offset) in parts.zip(offsets) {
            text += &offset_attribute(offset);
            text += part;
        }
        Ok(text.trim_end_matches("</VTKFile>").to_owned())
    }
}

fn offset_attribute(offset: u64) -> String {
    format!("offset=\"{offset}\"")
}

fn attributes(arrays: &[Array]) -> AttributeData {
    AttributeData {
        data_array: data_arrays(arrays),
        ..AttributeData::default()
    }
}

fn data_arrays(arrays: &[Array]) -> Vec<DataArray> {
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
    arrays.iter().map(data_array).collect()
}

fn native_byte_order() -> ByteOrder {
    match cfg!(target_endian = "little") {
        true => ByteOrder::LittleEndian,
        false => ByteOrder::BigEndian,
    }
}
