//! The XML header of a VTK file. vtkio's types do not support offsets beyond 4 GiB, and
//! read an unknown number type as `Float64`.

use quick_xml::events::Event;
use serde::Deserialize;

/// Maximum number of elements of a header, and of attributes per element; raycost's headers have a
/// few dozen elements of at most seven attributes.
const MAX_ELEMENTS: usize = 512;
const MAX_ATTRIBUTES: usize = 16;
/// Maximum number of numbers per pixel or point: a 3 x 3 tensor.
const MAX_COMPONENTS: u32 = 9;

/// The root element, `VTKFile`.
#[derive(Debug, Deserialize)]
pub struct VtkHeader {
    /// `LittleEndian` or `BigEndian`.
    #[serde(rename = "@byte_order")]
    pub byte_order: String,
    /// The type of the lengths before arrays, such as `UInt64`.
    #[serde(rename = "@header_type")]
    pub header_type: Option<String>,
    /// The VTK class that decompresses the arrays; `None` if they are uncompressed.
    #[serde(rename = "@compressor")]
    pub compressor: Option<String>,
    /// The id of the run that wrote the file.
    #[serde(rename = "@raycost_run")]
    pub run: Option<String>,
    /// The data set if it is an image.
    #[serde(rename = "ImageData")]
    pub image: Option<ImageDataElement>,
    /// The data set if it has cells of any type.
    #[serde(rename = "UnstructuredGrid")]
    pub grid: Option<UnstructuredGridElement>,
}

/// The element `ImageData`.
#[derive(Debug, Deserialize)]
pub struct ImageDataElement {
    #[serde(rename = "FieldData", default)]
    pub field_data: FieldElements,
    #[serde(rename = "Piece")]
    pub piece: ImagePieceElement,
}

/// The element `Piece` of an `ImageData`.
#[derive(Debug, Deserialize)]
pub struct ImagePieceElement {
    /// First and last column, row and layer of the points: six numbers.
    #[serde(rename = "@Extent")]
    pub extent: String,
    /// Arrays with one entry per point.
    #[serde(rename = "PointData", default)]
    pub point_data: DataArraysElement,
}

/// The element `UnstructuredGrid`.
#[derive(Debug, Deserialize)]
pub struct UnstructuredGridElement {
    #[serde(rename = "FieldData", default)]
    pub field_data: FieldElements,
    #[serde(rename = "Piece")]
    pub piece: GridPieceElement,
}

/// The element `Piece` of an `UnstructuredGrid`.
#[derive(Debug, Deserialize)]
pub struct GridPieceElement {
    #[serde(rename = "@NumberOfPoints")]
    pub n_points: u64,
    #[serde(rename = "PointData", default)]
    pub point_data: DataArraysElement,
    #[serde(rename = "Points")]
    pub points: DataArraysElement,
}

/// The elements `PointData` and `Points`: lists of arrays.
#[derive(Debug, Default, Deserialize)]
pub struct DataArraysElement {
    /// The arrays, in the order of the file.
    #[serde(rename = "DataArray", default)]
    pub arrays: Vec<DataArrayElement>,
}

/// The element `FieldData`: arrays of numbers and of texts.
#[derive(Debug, Default, Deserialize)]
pub struct FieldElements {
    #[serde(rename = "DataArray", default)]
    pub(super) arrays: Vec<DataArrayElement>,
    #[serde(rename = "Array", default)]
    pub(super) texts: Vec<TextElement>,
}

/// The element `Array`, of texts.
#[derive(Debug, Deserialize)]
pub(super) struct TextElement {
    #[serde(rename = "@Name")]
    pub(super) name: String,
    #[serde(rename = "$text", default)]
    pub(super) bytes: String,
}

/// The element `DataArray`.
#[derive(Debug, Deserialize)]
pub struct DataArrayElement {
    /// VTK's name for the type of the numbers, such as `Float32`.
    #[serde(rename = "@type")]
    pub scalar: String,
    /// The name of the array.
    #[serde(rename = "@Name")]
    pub name: String,
    /// Numbers per entry.
    #[serde(rename = "@NumberOfComponents", default = "one")]
    pub n_components: u32,
    /// Number of tuples; only in field data.
    #[serde(rename = "@NumberOfTuples")]
    pub(super) n_tuples: Option<u64>,
    /// Bytes from the start of the appended data; `None` for data in the header.
    #[serde(rename = "@offset")]
    pub offset: Option<u64>,
}

fn one() -> u32 {
    1
}

impl VtkHeader {
    /// Parses the text from the start of the file to the element `AppendedData`.
    ///
    /// # Errors
    /// The fault, as the end of a sentence.
    pub fn read(xml: &[u8]) -> Result<Self, String> {
        let xml = String::from_utf8_lossy(xml) + "</VTKFile>";
        check_size(&xml)?;
        let damaged = |error| format!("its header is damaged: {error}");
        let header: Self = quick_xml::de::from_str(&xml).map_err(damaged)?;
        let wide = header.arrays().find(|array| {
            let n = array.n_components;
            n == 0 || n > MAX_COMPONENTS
        });
        match wide {
            None => Ok(header),
            Some(DataArrayElement {
                name, n_components, ..
            }) => Err(format!(
                "`{name}` has {n_components} numbers per point, expected 1 to {MAX_COMPONENTS}"
            )),
        }
    }

    fn arrays(&self) -> impl Iterator<Item = &DataArrayElement> {
        let of_image = self.image.iter().map(|image| &image.piece.point_data);
        let of_grid = self.grid.iter();
        let of_grid = of_grid.flat_map(|grid| [&grid.piece.point_data, &grid.piece.points]);
        of_image.chain(of_grid).flat_map(|data| &data.arrays)
    }
}

/// Checks that the text has no more elements and attributes than a header needs, before a parser
/// compares or stores any of them.
fn check_size(xml: &str) -> Result<(), String> {
    let mut reader = quick_xml::Reader::from_str(xml);
    for _ in 0..2 * MAX_ELEMENTS {
        let event = reader.read_event();
        match event.map_err(|error| format!("its header is damaged: {error}"))? {
            Event::Start(element) | Event::Empty(element) => {
                let mut attributes = element.attributes();
                let attributes = attributes.with_checks(false);
                if attributes.nth(MAX_ATTRIBUTES).is_some() {
                    return Err(format!(
                        "an element of its header has more than {MAX_ATTRIBUTES} attributes"
                    ));
                }
            }
            Event::Eof => return Ok(()),
            _ => {}
        }
    }
    Err(format!("its header has more than {MAX_ELEMENTS} elements"))
}

impl ImagePieceElement {
    /// Returns the first and the last column and row; `None` unless the extent has one layer.
    pub fn extent(&self) -> Option<[u32; 4]> {
        extent_of(&self.extent)
    }

    /// Returns columns and rows; `None` as for [`extent`](Self::extent).
    pub fn size(&self) -> Option<(u32, u32)> {
        let [width, height] = size_of_extent(self.extent()?);
        Some((width, height))
    }
}

/// Parses the first and the last column and row of an extent, which must not be negative; `None`
/// unless there is one layer.
pub fn extent_of(text: &str) -> Option<[u32; 4]> {
    let ends = text.split_ascii_whitespace().map(str::parse);
    let ends: Vec<u32> = ends.collect::<Result<_, _>>().ok()?;
    let [x0, x1, y0, y1, z0, z1] = ends[..] else {
        return None;
    };
    let is_plane = x0 <= x1 && y0 <= y1 && z0 == z1 && x1.max(y1) < u32::MAX;
    is_plane.then_some([x0, x1, y0, y1])
}

/// Returns the columns and rows of an extent.
pub fn size_of_extent([x0, x1, y0, y1]: [u32; 4]) -> [u32; 2] {
    [x1 - x0 + 1, y1 - y0 + 1]
}
