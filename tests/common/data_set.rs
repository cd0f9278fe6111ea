//! The contents of a VTK file, read with or without VTK.

use std::io::Read;
use std::path::Path;
use std::process::Command;

use serde::Deserialize;

use super::in_repository;

/// A data set, as read or as expected.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct DataSet {
    /// `ImageData`, `UnstructuredGrid` or `PolyData`.
    pub kind: String,
    pub n_points: usize,
    /// The cells of a grid, or the lines of PolyData.
    pub n_cells: Option<usize>,
    /// Of an image, as the three below.
    pub extent: Option<[i32; 6]>,
    pub origin: Option<[f64; 3]>,
    pub spacing: Option<[f64; 3]>,
    /// The active array of normals.
    pub normals: Option<String>,
    /// Those of field data first.
    pub arrays: Vec<Array>,
    /// The arrays of texts in the field data.
    pub texts: Vec<(String, Vec<String>)>,
    /// The time by which ParaView plays it.
    pub time: Option<f64>,
}

/// One of its arrays.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Array {
    pub name: String,
    /// The type of its numbers: `UInt8`, `Float32`, …
    pub scalar: String,
    pub n_components: usize,
    /// In native byte order.
    #[serde(skip)]
    pub bytes: Vec<u8>,
}

impl DataSet {
    /// Reads a file by the format's specification: arrays after an underscore, at
    /// the offsets in the header. Supports only the XML that raycost writes.
    pub fn read(path: &Path) -> Self {
        let file = std::fs::read(path).unwrap();
        let tag = b"<AppendedData encoding=\"raw\">";
        let at = file.windows(tag.len()).position(|bytes| bytes == tag);
        let (header, rest) = file.split_at(at.expect("no appended data"));
        let header = str::from_utf8(header).unwrap();
        let blanks_and_raw = rest[tag.len()..].trim_ascii_start();
        let raw = blanks_and_raw.strip_prefix(b"_").unwrap();
        let raw = raw
            .strip_suffix(b"\n</AppendedData>\n</VTKFile>\n")
            .unwrap();
        assert!(header.contains(" header_type=\"UInt64\""), "{header}");

        let mut next = 0;
        let array = |element: &str| {
            let offset: usize = number(element, "offset").unwrap();
            assert_eq!(offset, next, "a gap between the arrays");
            let (bytes, n_bytes) = match attribute(header, "compressor") {
                None => {
                    let bytes = block(&raw[offset..]);
                    (bytes.to_vec(), 8 + bytes.len())
                }
                Some(compressor) => unpacked(&raw[offset..], compressor),
            };
            next += n_bytes;
            Array {
                name: attribute(element, "Name").unwrap().to_owned(),
                scalar: attribute(element, "type").unwrap().to_owned(),
                n_components: number(element, "NumberOfComponents").unwrap_or(1),
                bytes,
            }
        };
        let arrays: Vec<Array> = header.split("<DataArray").skip(1).map(array).collect();
        assert_eq!(next, raw.len(), "bytes behind the last array");

        let extent: Option<[i32; 6]> = numbers(header, "WholeExtent");
        let n_points = extent.map(|[x0, x1, y0, y1, z0, z1]| {
            ((x1 - x0 + 1) * (y1 - y0 + 1) * (z1 - z0 + 1)) as usize
        });
        Self {
            kind: attribute(header, "type").unwrap().to_owned(),
            n_points: n_points
                .or_else(|| number(header, "NumberOfPoints"))
                .unwrap(),
            n_cells: number(header, "NumberOfCells").or_else(|| number(header, "NumberOfLines")),
            extent,
            origin: numbers(header, "Origin"),
            spacing: numbers(header, "Spacing"),
            normals: attribute(header, "Normals").map(str::to_owned),
            texts: header.split("<Array").skip(1).map(texts).collect(),
            time: arrays
                .iter()
                .find(|array| array.name == "TimeValue")
                .map(|array| array.f64s()[0]),
            arrays,
        }
    }

    /// Reads a file with VTK.
    pub fn read_with_vtk(path: &Path) -> Self {
        let python = std::env::var("RAYCOST_PYTHON").expect("run tests/with-paraview");
        let script = in_repository("tests/vtk/read_back.py");
        let output = Command::new(python).arg(script).arg(path).output().unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && errors.is_empty(), "{errors}");

        let end = output
            .stdout
            .iter()
            .position(|&byte| byte == b'\n')
            .unwrap();
        let (header, mut raw) = output.stdout.split_at(end + 1);
        let mut data_set: Self = serde_json::from_slice(header).unwrap();
        for array in &mut data_set.arrays {
            array.bytes = block(raw).to_vec();
            raw = &raw[8 + array.bytes.len()..];
            // VTK does not keep the integer type of zero cells.
            if array.bytes.is_empty() && array.scalar == "Int64" {
                array.scalar = "Int32".to_owned();
            }
        }
        data_set
    }

    /// The array with this name.
    pub fn array(&self, name: &str) -> &Array {
        let array = self.arrays.iter().find(|array| array.name == name);
        array.unwrap_or_else(|| panic!("no array {name}"))
    }

    /// The texts of field data with this name.
    pub fn texts(&self, name: &str) -> &[String] {
        let field = self.texts.iter().find(|(found, _)| found == name);
        &field.unwrap_or_else(|| panic!("no texts {name}")).1
    }
}

impl Array {
    /// Its numbers, which are `UInt32`.
    pub fn u32s(&self) -> impl Iterator<Item = u32> + '_ {
        self.numbers("UInt32").map(u32::from_ne_bytes)
    }

    /// Its numbers, which are `Int32`.
    pub fn i32s(&self) -> impl Iterator<Item = i32> + '_ {
        self.numbers("Int32").map(i32::from_ne_bytes)
    }

    /// Its numbers, which are `Float32`.
    pub fn f32s(&self) -> impl Iterator<Item = f32> + '_ {
        self.numbers("Float32").map(f32::from_ne_bytes)
    }

    /// Its numbers, which are `Float64`.
    pub fn f64s(&self) -> Vec<f64> {
        assert_eq!(self.scalar, "Float64", "{}", self.name);
        let numbers = self.bytes.chunks_exact(8);
        let number = |bytes: &[u8]| f64::from_ne_bytes(bytes.try_into().unwrap());
        numbers.map(number).collect()
    }

    /// Its triples of `Float32`.
    pub fn triples(&self) -> impl Iterator<Item = [f32; 3]> {
        assert_eq!(self.n_components, 3, "{}", self.name);
        let numbers: Vec<f32> = self.f32s().collect();
        let triples: Vec<[f32; 3]> = numbers
            .chunks_exact(3)
            .map(|c| [c[0], c[1], c[2]])
            .collect();
        triples.into_iter()
    }

    fn numbers(&self, scalar: &str) -> impl Iterator<Item = [u8; 4]> + '_ {
        assert_eq!(self.scalar, scalar, "{}", self.name);
        let bytes = self.bytes.chunks_exact(4);
        bytes.map(|bytes| bytes.try_into().unwrap())
    }
}

/// Fails at the first array that differs, and shows the position.
pub fn assert_same(mut found: DataSet, mut expected: DataSet) {
    for (found, expected) in found.arrays.iter_mut().zip(&mut expected.arrays) {
        let [found, expected_bytes] =
            [found, expected].map(|array| std::mem::take(&mut array.bytes));
        let differ = found.iter().zip(&expected_bytes).position(|(a, b)| a != b);
        let lengths = [found.len(), expected_bytes.len()];
        assert!(
            found == expected_bytes,
            "{}: from byte {differ:?} on; lengths {lengths:?}",
            expected.name
        );
    }
    assert_eq!(found, expected);
}

/// The field data of a file without a run: the units of its arrays.
pub fn units(arrays: &[Array], unit: fn(&str) -> Option<String>) -> Vec<(String, Vec<String>)> {
    let line = |array: &Array| Some(format!("{}: {}", array.name, unit(&array.name)?));
    let units: Vec<String> = arrays.iter().filter_map(line).collect();
    let units = (!units.is_empty()).then(|| ("units".to_owned(), units));
    units.into_iter().collect()
}

/// An array of `Int32`.
pub fn integers(name: &str, numbers: impl Iterator<Item = i32>) -> Array {
    Array {
        name: name.to_owned(),
        scalar: "Int32".to_owned(),
        n_components: 1,
        bytes: numbers.flat_map(i32::to_ne_bytes).collect(),
    }
}

/// Returns the name and the texts of an element `Array`: bytes in decimal, each text with
/// a 0 behind it.
fn texts(element: &str) -> (String, Vec<String>) {
    let name = attribute(element, "Name").unwrap().to_owned();
    let (_, content) = element.split_once('>').unwrap();
    let (numbers, _) = content.split_once('<').unwrap();
    let bytes: Result<Vec<u8>, _> = numbers.split(' ').map(str::parse).collect();
    let bytes = bytes.unwrap();
    let texts = bytes.strip_suffix(&[0]).unwrap().split(|&byte| byte == 0);
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    let texts: Vec<String> = texts.map(text).collect();
    assert_eq!(number(element, "NumberOfTuples"), Some(texts.len()));
    (name, texts)
}

/// Returns the bytes at the start of `raw`, which follow their length in 64 bits.
fn block(raw: &[u8]) -> &[u8] {
    let (length, rest) = raw.split_first_chunk().unwrap();
    &rest[..u64::from_ne_bytes(*length) as usize]
}

/// Decompresses the blocks at the start of `raw`; returns their bytes and the
/// compressed size with the block table: the number of blocks, the length of a
/// block, that of the last one if it is shorter, and the compressed lengths.
fn unpacked(raw: &[u8], compressor: &str) -> (Vec<u8>, usize) {
    let number = |index: usize| {
        let bytes = raw[8 * index..][..8].try_into().unwrap();
        u64::from_ne_bytes(bytes) as usize
    };
    let (n_blocks, n_bytes, n_bytes_of_last) = (number(0), number(1), number(2));
    let mut begin = 8 * (3 + n_blocks);
    let mut bytes = Vec::new();
    for index in 0..n_blocks {
        let packed = &raw[begin..][..number(3 + index)];
        begin += packed.len();
        let is_short = index == n_blocks - 1 && n_bytes_of_last > 0;
        let n_bytes = if is_short { n_bytes_of_last } else { n_bytes };
        let block = match compressor {
            "vtkLZ4DataCompressor" => lz4_flex::block::decompress(packed, n_bytes).unwrap(),
            "vtkZLibDataCompressor" => {
                let mut block = Vec::new();
                let mut zlib = flate2::read::ZlibDecoder::new(packed);
                zlib.read_to_end(&mut block).unwrap();
                block
            }
            _ => panic!("{compressor}"),
        };
        assert_eq!(block.len(), n_bytes);
        bytes.extend(block);
    }
    (bytes, begin)
}

/// The value of the first attribute with this name.
fn attribute<'a>(xml: &'a str, name: &str) -> Option<&'a str> {
    let (_, value) = xml.split_once(&format!(" {name}=\""))?;
    Some(value.split_once('"')?.0)
}

fn number(xml: &str, name: &str) -> Option<usize> {
    attribute(xml, name)?.parse().ok()
}

fn numbers<T: std::str::FromStr, const N: usize>(xml: &str, name: &str) -> Option<[T; N]> {
    let values = attribute(xml, name)?.split(' ');
    let numbers: Option<Vec<T>> = values.map(|value| value.parse().ok()).collect();
    numbers?.try_into().ok()
}
