//! The header of a file that raycost wrote.

use std::fmt::Display;
use std::str::FromStr;

use super::document::{Element, XmlFault, parse};
use super::encoded::ArrayEncoding;
use crate::header::NATIVE_ORDER;
use host::provenance::KEY;

/// Maximum number of elements of a header, and of attributes per element; raycost's headers have a
/// few dozen elements of at most seven attributes.
const MAX_ELEMENTS: usize = 512;
const MAX_ATTRIBUTES: usize = 16;
/// Maximum number of numbers per pixel or point: a 3 x 3 tensor.
const MAX_COMPONENTS: u32 = 9;

/// The root element, `VTKFile`, and its data set.
#[derive(Debug)]
pub struct VtkHeader {
    /// The id of the run that wrote the file.
    pub run: Option<String>,
    pub(super) encoding: ArrayEncoding,
    /// The field data of the data set.
    pub field_data: FieldElements,
    /// The data set if it is an image.
    pub image: Option<ImageHeader>,
    /// The data set if it has cells of any type.
    pub grid: Option<GridHeader>,
}

/// The piece of an `ImageData`.
#[derive(Debug)]
pub struct ImageHeader {
    /// First and last column, row and layer of the points: six numbers.
    pub extent: String,
    /// Arrays with one entry per point.
    pub point_data: Vec<DataArrayElement>,
}

/// The piece of an `UnstructuredGrid`.
#[derive(Debug)]
pub struct GridHeader {
    /// Number of points.
    pub n_points: u64,
    /// Arrays with one entry per point.
    pub point_data: Vec<DataArrayElement>,
    /// The positions of the points: one array.
    pub points: Vec<DataArrayElement>,
}

/// The element `FieldData`: arrays of numbers and of texts.
#[derive(Debug)]
pub struct FieldElements {
    pub(super) arrays: Vec<DataArrayElement>,
    pub(super) texts: Vec<TextElement>,
}

/// The element `Array`, of texts.
#[derive(Debug)]
pub(super) struct TextElement {
    pub(super) name: String,
    pub(super) bytes: String,
}

/// The element `DataArray`.
#[derive(Debug)]
pub struct DataArrayElement {
    /// VTK's name for the type of the numbers, such as `Float32`.
    pub scalar: String,
    /// The name of the array.
    pub name: String,
    /// Numbers per entry.
    pub n_components: u32,
    /// Number of tuples; only in field data.
    pub(super) n_tuples: Option<u64>,
    /// Bytes from the start of the appended data; `None` for data in the header.
    pub offset: Option<u64>,
}

/// A value, or a fault as the end of a sentence.
type HeaderResult<T> = Result<T, String>;

impl VtkHeader {
    /// Parses the text from the start of the file to the element `AppendedData`.
    ///
    /// # Errors
    /// The fault, as the end of a sentence.
    pub fn read(xml: &[u8]) -> HeaderResult<Self> {
        let xml = String::from_utf8_lossy(xml) + "</VTKFile>";
        let root = parse(xml.as_bytes(), 2 * MAX_ELEMENTS, MAX_ATTRIBUTES);
        let (root, _) = root.map_err(explain)?;
        let encoding = ArrayEncoding::new(&root)
            .map_err(|name| format!("its arrays are compressed by `{name}`"))?;
        if encoding.order != NATIVE_ORDER {
            return Err("its byte order is not this machine's".to_owned());
        }
        if encoding.length_bytes != ArrayEncoding::RAW.length_bytes {
            return Err("the lengths of its arrays are not UInt64".to_owned());
        }
        let [image, grid] = ["ImageData", "UnstructuredGrid"].map(|kind| root.child(kind));
        let field_data = image.or(grid).and_then(|set| set.child("FieldData"));
        Ok(Self {
            run: root.attribute(KEY).map(str::to_owned),
            encoding,
            field_data: FieldElements::read(field_data)?,
            image: image.map(ImageHeader::read).transpose()?,
            grid: grid.map(GridHeader::read).transpose()?,
        })
    }
}

impl ImageHeader {
    fn read(data_set: &Element) -> HeaderResult<Self> {
        let piece = child(data_set, "Piece")?;
        Ok(Self {
            extent: required(piece, "Extent")?,
            point_data: parse_arrays(piece.child("PointData"))?,
        })
    }

    /// Returns the first and the last column and row; `None` unless the extent has one layer.
    pub fn extent(&self) -> Option<[u32; 4]> {
        extent_of(&self.extent)
    }

    /// Returns columns and rows; `None` as for [`extent`](Self::extent).
    pub fn size(&self) -> Option<[u32; 2]> {
        self.extent().map(size_of_extent)
    }
}

impl GridHeader {
    fn read(data_set: &Element) -> HeaderResult<Self> {
        let piece = child(data_set, "Piece")?;
        Ok(Self {
            n_points: number(piece, "NumberOfPoints")?.ok_or_else(|| missing("@NumberOfPoints"))?,
            point_data: parse_arrays(piece.child("PointData"))?,
            points: parse_arrays(Some(child(piece, "Points")?))?,
        })
    }
}

impl FieldElements {
    fn read(element: Option<&Element>) -> HeaderResult<Self> {
        let text = |element: &Element| {
            Ok(TextElement {
                name: required(element, "Name")?,
                bytes: String::from_utf8_lossy(element.text).into_owned(),
            })
        };
        let texts = element
            .into_iter()
            .flat_map(|of| of.children_named("Array"));
        let texts = texts.map(text).collect::<HeaderResult<_>>()?;
        let arrays = parse_arrays(element)?;
        Ok(Self { arrays, texts })
    }
}

impl DataArrayElement {
    fn read(element: &Element) -> HeaderResult<Self> {
        let name = required(element, "Name")?;
        let n_components = number(element, "NumberOfComponents")?.unwrap_or(1);
        if n_components == 0 || n_components > MAX_COMPONENTS {
            return Err(format!(
                "`{name}` has {n_components} numbers per point, expected 1 to {MAX_COMPONENTS}"
            ));
        }
        Ok(Self {
            scalar: required(element, "type")?,
            name,
            n_components,
            n_tuples: number(element, "NumberOfTuples")?,
            offset: number(element, "offset")?,
        })
    }
}

/// Returns the arrays in an element; none without it.
fn parse_arrays(element: Option<&Element>) -> HeaderResult<Vec<DataArrayElement>> {
    let elements = element
        .into_iter()
        .flat_map(|of| of.children_named("DataArray"));
    elements.map(DataArrayElement::read).collect()
}

fn child<'a, 'b>(element: &'b Element<'a>, name: &str) -> HeaderResult<&'b Element<'a>> {
    element.child(name).ok_or_else(|| missing(name))
}

fn required(element: &Element, name: &str) -> HeaderResult<String> {
    let value = element.attribute(name).map(str::to_owned);
    value.ok_or_else(|| missing(&format!("@{name}")))
}

fn number<T: FromStr<Err: Display>>(element: &Element, name: &str) -> HeaderResult<Option<T>> {
    let number = element.attribute(name).map(str::parse).transpose();
    number.map_err(damaged)
}

fn missing(name: &str) -> String {
    damaged(format!("missing field `{name}`"))
}

fn damaged(why: impl Display) -> String {
    format!("its header is damaged: {why}")
}

fn explain(fault: XmlFault) -> String {
    match fault {
        XmlFault::TooManyAttributes => {
            format!("an element of its header has more than {MAX_ATTRIBUTES} attributes")
        }
        XmlFault::TooManyElements => format!("its header has more than {MAX_ELEMENTS} elements"),
        fault => damaged(fault),
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
