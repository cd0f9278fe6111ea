//! The arrays of a VTK XML file.

use super::super::budget::Budget;
use super::super::document::Element;
use super::super::encoded::{ArrayEncoding, Base64, Encoded};
use super::super::numbers::{ByteOrder, NumberType, Numbers};
use crate::fault::cut;
use crate::{FileFault, Result};
use vtk::Compressor;

/// Reads the arrays of a file.
pub(super) struct XmlArrays<'a> {
    storage: ArrayEncoding,
    appended: Appended<'a>,
}

impl<'a> XmlArrays<'a> {
    /// Creates the arrays of a file with this root element and these appended bytes.
    ///
    /// # Errors
    /// The compressor is unknown.
    pub(super) fn new(root: &Element, appended: &'a [u8]) -> Result<Self> {
        Ok(Self {
            storage: storage(root)?,
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
        let mut arrays = element.children.iter();
        let array = arrays.find(|array| array.attribute("Name") == Some(name));
        let missing = || {
            let problem = format!("its element `{}` has no array `{name}`", element.name);
            FileFault::new(problem, "a VTK file as VTK writes it")
        };
        self.numbers(name, array.ok_or_else(missing)?, budget)
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
        let n_components = array.attribute("NumberOfComponents");
        let n_components = match n_components {
            Some(_) => array.number("NumberOfComponents")?,
            None => 1,
        };
        let is_whole = is_of_bits(array) || decoded.len().is_multiple_of(n_components.max(1));
        if n_components == 0 || !is_whole {
            let problem = format!("the array `{}` has {} numbers", cut(name), decoded.len());
            let expected = format!("a multiple of its {n_components} components");
            return Err(FileFault::new(problem, expected));
        }
        Ok(decoded.in_tuples_of(n_components))
    }

    fn decode(&self, array: &Element, budget: &mut Budget) -> Result<Numbers> {
        let kind = array.required("type")?;
        let has_bits = is_of_bits(array);
        let named = if has_bits { "UInt8" } else { kind };
        let kind = NumberType::named(named).ok_or_else(|| {
            let problem = format!("it has values of the type `{}`", cut(kind));
            FileFault::new(problem, "numbers of 8 to 64 bits")
        })?;
        let bytes = match array.attribute("format").unwrap_or("ascii") {
            "ascii" => return ascii(array.text, budget),
            "binary" => {
                let text = Encoded::Base64(Base64::new(array.text));
                self.storage.decode(text, budget)?
            }
            "appended" => {
                let [offset] = array.numbers("offset")?;
                self.storage.decode(self.appended.at(offset)?, budget)?
            }
            other => {
                let problem = format!("its format is `{}`", cut(other));
                return Err(FileFault::new(problem, "ascii, binary or appended"));
            }
        };
        if has_bits {
            budget.take_of::<[u8; 8]>(bytes.len())?;
            let bits = bytes
                .iter()
                .flat_map(|byte| (0..8).rev().map(move |bit| byte >> bit & 1));
            return Ok(Numbers::new(kind, self.storage.order, bits.collect()));
        }
        if !bytes.len().is_multiple_of(kind.n_bytes()) {
            let problem = format!("it has {} bytes", bytes.len());
            let expected = format!("a multiple of {}", kind.n_bytes());
            return Err(FileFault::new(problem, expected));
        }
        Ok(Numbers::new(kind, self.storage.order, bytes))
    }
}

/// Returns true if eight values of an array share a byte, the first one in the highest bit.
fn is_of_bits(array: &Element) -> bool {
    array.attribute("type") == Some("Bit")
}

fn storage(root: &Element) -> Result<ArrayEncoding> {
    let order = match root.attribute("byte_order") {
        Some("BigEndian") => ByteOrder::Big,
        _ => ByteOrder::Little,
    };
    let length_bytes = match root.attribute("header_type") {
        Some("UInt64") => 8,
        _ => 4,
    };
    let compressor = root.attribute("compressor").map(|name| {
        <dyn Compressor>::of_vtk_class(name).ok_or_else(|| {
            let problem = format!("its arrays are compressed by `{}`", cut(name));
            FileFault::new(
                problem,
                "vtkZLibDataCompressor, vtkLZ4DataCompressor or none",
            )
        })
    });
    Ok(ArrayEncoding {
        order,
        length_bytes,
        compressor: compressor.transpose()?,
    })
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
    fn at(self, offset: usize) -> Result<Encoded<'a>> {
        let bytes = self.bytes.get(offset..).ok_or_else(|| {
            let problem = format!(
                "it begins at byte {offset} of {} appended ones",
                self.bytes.len()
            );
            FileFault::new(problem, "a whole file")
        })?;
        Ok(if self.is_base64 {
            Encoded::Base64(Base64::new(bytes))
        } else {
            Encoded::Raw(bytes)
        })
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
    Ok(Numbers::of_text(&numbers.collect::<Result<Vec<f64>>>()?))
}
