//! The XML in front of the arrays. vtkio's own types have no room for
//! offsets beyond 4 GiB, and take a type they do not know for `Float64`.

use serde::Deserialize;

/// The root element.
#[derive(Debug, Deserialize)]
pub(super) struct Header {
    #[serde(rename = "@byte_order")]
    pub(super) byte_order: String,
    #[serde(rename = "@header_type")]
    pub(super) header_type: Option<String>,
    #[serde(rename = "@compressor")]
    pub(super) compressor: Option<String>,
    #[serde(rename = "ImageData")]
    pub(super) image: Option<Image>,
    #[serde(rename = "UnstructuredGrid")]
    pub(super) grid: Option<Grid>,
}

/// A regular grid of points.
#[derive(Debug, Deserialize)]
pub(super) struct Image {
    #[serde(rename = "Piece")]
    pub(super) piece: ImagePiece,
}

#[derive(Debug, Deserialize)]
pub(super) struct ImagePiece {
    #[serde(rename = "@Extent")]
    pub(super) extent: String,
    #[serde(rename = "PointData", default)]
    pub(super) point_data: DataArrays,
}

/// Points and cells.
#[derive(Debug, Deserialize)]
pub(super) struct Grid {
    #[serde(rename = "Piece")]
    pub(super) piece: GridPiece,
}

#[derive(Debug, Deserialize)]
pub(super) struct GridPiece {
    #[serde(rename = "@NumberOfPoints")]
    pub(super) n_points: u64,
    #[serde(rename = "PointData", default)]
    pub(super) point_data: DataArrays,
    #[serde(rename = "Points")]
    pub(super) points: DataArrays,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct DataArrays {
    #[serde(rename = "DataArray", default)]
    pub(super) arrays: Vec<DataArray>,
}

#[derive(Debug, Deserialize)]
pub(super) struct DataArray {
    #[serde(rename = "@type")]
    pub(super) scalar: String,
    #[serde(rename = "@Name")]
    pub(super) name: String,
    #[serde(rename = "@NumberOfComponents", default = "one")]
    pub(super) n_components: u32,
    #[serde(rename = "@offset")]
    pub(super) offset: Option<u64>,
}

fn one() -> u32 {
    1
}

impl ImagePiece {
    /// Columns and rows of an image of one layer.
    pub(super) fn size(&self) -> Option<(u32, u32)> {
        let ends = self.extent.split_ascii_whitespace().map(str::parse);
        let ends: Vec<i64> = ends.collect::<Result<_, _>>().ok()?;
        let [x0, x1, y0, y1, z0, z1] = ends[..] else {
            return None;
        };
        let n = |from: i64, to: i64| {
            let n = to.checked_sub(from)?.checked_add(1)?;
            u32::try_from(n).ok().filter(|&n| n > 0)
        };
        (n(z0, z1)? == 1).then_some(())?;
        Some((n(x0, x1)?, n(y0, y1)?))
    }
}
