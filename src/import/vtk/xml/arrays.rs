//! The arrays of a VTK XML file.

use std::io;

use super::super::budget::Budget;
use super::super::document::{AS_VTK_WRITES, number_or, numbers, required};
use super::super::numbers::{Numbers, scalar_type};
use crate::fault::cut;
use crate::{FileFault, Result};
use vtk::ArrayValues;
use vtk::read::{ArrayEncoding, Element, EncodedBytes, ScalarType};

/// Reads the arrays of a file.
pub(super) struct XmlArrays<'a> {
    encoding: ArrayEncoding,
    appended: Appended<'a>,
}

impl<'a> XmlArrays<'a> {
    /// Creates the arrays of a file with this root element and these appended bytes.
    ///
    /// # Errors
    /// The compressor is unknown.
    pub(super) fn new(root: &Element, appended: &'a [u8]) -> Result<Self> {
        Ok(Self {
            encoding: ArrayEncoding::new(root).map_err(|name| {
                let problem = format!("its arrays are compressed by `{}`", cut(name));
                let expected = "vtkZLibDataCompressor, vtkLZ4DataCompressor or none";
                FileFault::new(problem, expected)
            })?,
            appended: Appended::new(root, appended),
        })
    }

    /// Returns the array of this name within an element.
    pub(super) fn named(
        &self,
        element: &Element,
        name: &str,
        budget: &mut Budget,
    ) -> Result<Numbers> {
        let missing = || {
            let problem = format!("its element `{}` has no array `{name}`", element.name);
            FileFault::new(problem, AS_VTK_WRITES)
        };
        self.numbers(name, element.array(name).ok_or_else(missing)?, budget)
    }

    /// Returns the array of this many tuples; one of bits ends with unused ones.
    pub(super) fn tuples(
        &self,
        name: &str,
        array: &Element,
        n_tuples: usize,
        budget: &mut Budget,
    ) -> Result<Numbers> {
        let mut numbers = self.numbers(name, array, budget)?;
        let n = n_tuples.saturating_mul(numbers.n_components);
        if is_of_bits(array) && numbers.len() < n.saturating_add(8) {
            numbers.truncate(n);
        }
        Ok(numbers)
    }

    /// Returns the numbers of an array.
    pub(super) fn numbers(
        &self,
        name: &str,
        array: &Element,
        budget: &mut Budget,
    ) -> Result<Numbers> {
        let decoded = self.decode(array, budget).map_err(|fault| {
            let problem = format!("the array `{}`: {}", cut(name), fault.problem);
            FileFault { problem, ..fault }
        })?;
        let n_components = number_or(array, "NumberOfComponents", 1)?;
        let is_whole = is_of_bits(array) || decoded.len().is_multiple_of(n_components.max(1));
        if n_components == 0 || !is_whole {
            let problem = format!("the array `{}` has {} numbers", cut(name), decoded.len());
            let expected = format!("a multiple of its {n_components} components");
            return Err(FileFault::new(problem, expected));
        }
        Ok(decoded.in_tuples_of(n_components))
    }

    fn decode(&self, array: &Element, budget: &mut Budget) -> Result<Numbers> {
        let kind = required(array, "type")?;
        let has_bits = is_of_bits(array);
        let scalar = if has_bits {
            Some(ScalarType::U8)
        } else {
            scalar_type(kind)
        };
        let scalar = scalar.ok_or_else(|| {
            let problem = format!("it has values of the type `{}`", cut(kind));
            FileFault::new(problem, "numbers of 8 to 64 bits")
        })?;
        let bytes = match array.attribute("format").unwrap_or("ascii") {
            "ascii" => return ascii(array.text, budget),
            "binary" => EncodedBytes::new(array.text, true),
            "appended" => {
                let [offset] = numbers(array, "offset")?;
                self.appended.at(offset)?
            }
            other => {
                let problem = format!("its format is `{}`", cut(other));
                return Err(FileFault::new(problem, "ascii, binary or appended"));
            }
        };
        let encoded = self.encoding.open(bytes).map_err(undecodable)?;
        budget.take(encoded.n_bytes)?;
        let (n_bytes, size) = (encoded.n_bytes as usize, scalar.size());
        if !n_bytes.is_multiple_of(size) {
            let problem = format!("it has {n_bytes} bytes");
            return Err(FileFault::new(problem, format!("a multiple of {size}")));
        }
        let fill = |into: &mut [u8]| encoded.decode(into);
        let values = ArrayValues::read(scalar, n_bytes / size, self.encoding.order, fill);
        let values = values.map_err(undecodable)?;
        if !has_bits {
            return Ok(Numbers::new(values));
        }
        budget.take_of::<[u8; 8]>(n_bytes)?;
        let bits = |byte: &u8| [7, 6, 5, 4, 3, 2, 1, 0].map(|bit| byte >> bit & 1);
        let bits = values.bytes().iter().flat_map(bits).collect();
        Ok(Numbers::new(ArrayValues::U8(bits)))
    }
}

/// Returns true if eight values of an array share a byte, the first one in the highest bit.
fn is_of_bits(array: &Element) -> bool {
    array.attribute("type") == Some("Bit")
}

fn undecodable(error: io::Error) -> FileFault {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => FileFault::new("it ends early", "a whole file"),
        io::ErrorKind::InvalidData => {
            FileFault::new("its bytes cannot be decoded", "a file that is not damaged")
        }
        _ => error.into(),
    }
}

/// The data after the elements.
#[derive(Debug, Clone, Copy)]
struct Appended<'a> {
    bytes: &'a [u8],
    is_base64: bool,
}

impl<'a> Appended<'a> {
    fn new(root: &Element, bytes: &'a [u8]) -> Self {
        let element = root.child("AppendedData");
        let encoding = element.and_then(|element| element.attribute("encoding"));
        Self {
            bytes,
            is_base64: encoding == Some("base64"),
        }
    }

    /// Returns the bytes from an offset on.
    fn at(self, offset: usize) -> Result<EncodedBytes<'a>> {
        let bytes = self.bytes.get(offset..).ok_or_else(|| {
            let problem = format!(
                "it begins at byte {offset} of {} appended ones",
                self.bytes.len()
            );
            FileFault::new(problem, "a whole file")
        })?;
        Ok(EncodedBytes::new(bytes, self.is_base64))
    }
}

/// Parses the numbers of a text.
fn ascii(text: &[u8], budget: &mut Budget) -> Result<Numbers> {
    budget.take_of::<[f64; 2]>(text.len() / 2)?;
    let words = text
        .split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty());
    let numbers = words.map(|word| {
        let word = String::from_utf8_lossy(word);
        let no_number = |_| FileFault::new(format!("`{}` is not a number", cut(&word)), "a number");
        word.parse::<f64>().map_err(no_number)
    });
    Ok(Numbers::from_text(numbers.collect::<Result<_>>()?))
}
