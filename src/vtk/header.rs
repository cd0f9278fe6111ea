//! The XML header of a file.

use std::io;

use serde::Serialize;
use vtkio::model::{ByteOrder, Version};
use vtkio::xml::{DataSetType, ScalarType, se};

use crate::array::Array;
use crate::codec::Compressor;
use crate::data_set::DataSet;
use crate::elements::{DataElement, FieldDataElement, content};
use crate::encoding::Encoding;
use crate::field::Field;
use host::provenance::RunId;

/// A data set with the field data of its file and the ID of its run.
pub(crate) struct LabeledDataSet<'a> {
    data_set: &'a DataSet<'a>,
    run: Option<RunId>,
    /// Field data of text.
    texts: Vec<&'a Field>,
    /// Field data of numbers.
    numbers: Vec<Array<'a>>,
    units: Option<Field>,
}

/// The offset of each array after the underscore, in the order of the arrays.
pub enum Offsets<'a> {
    /// For raw arrays.
    OfRaw(Vec<u64>),
    /// For compressed arrays, padded so that the header's length does not depend on them.
    OfCompressed(&'a dyn Compressor, Vec<u64>),
}

impl<'a> LabeledDataSet<'a> {
    /// Creates a data set whose field data come from `encoding`, plus the units.
    pub fn new(data_set: &'a DataSet<'a>, encoding: &'a Encoding) -> Self {
        let fields = &encoding.fields;
        let is_text = |field: &&Field| field.array().is_none();
        Self {
            data_set,
            run: encoding.run,
            texts: fields.iter().filter(is_text).collect(),
            numbers: fields.iter().filter_map(Field::array).collect(),
            units: Field::units(data_set),
        }
    }

    /// Returns all arrays of numbers in the order of the file.
    pub fn arrays(&self) -> Vec<&Array<'a>> {
        let numbers = self.numbers.iter();
        numbers.chain(self.data_set.arrays()).collect()
    }

    /// Returns the file's text up to the closing tag of the root.
    ///
    /// # Errors
    /// The elements cannot be serialized.
    pub fn xml(&self, offsets: &Offsets) -> io::Result<String> {
        let (data_set_type, content) = content(self.data_set, self.field_data());
        let file = VtkFile {
            data_set_type,
            version: Version::new_xml(1, 0),
            byte_order: NATIVE_ORDER,
            header_type: ScalarType::UInt64,
            compressor: offsets.compressor().map(Compressor::vtk_class),
            run: self.run,
            content,
        };
        let xml = se::to_string(&file).map_err(io::Error::other)?;
        // vtkio's offsets have 32 bits: replace them with 64-bit offsets.
        let mut parts = xml.split(OFFSET);
        let mut text = parts.next().unwrap_or_default().to_owned();
        for (part, attribute) in parts.zip(offsets.attributes()) {
            text += &attribute;
            text += part;
        }
        Ok(text.trim_end_matches("</VTKFile>").to_owned())
    }

    fn field_data(&self) -> Option<FieldDataElement> {
        let texts = self.texts.iter().copied().chain(&self.units);
        FieldDataElement::new(&self.numbers, texts)
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
            // Not all readers accept blanks within the quotes.
            Self::OfCompressed(_, offsets) => {
                let width = attribute(&u64::MAX).len();
                let padded = |offset| format!("{:width$}", attribute(offset));
                offsets.iter().map(padded).collect()
            }
        }
    }
}

/// The attribute that vtkio writes for each offset.
const OFFSET: &str = "offset=\"0\"";

/// The root element. vtkio's type has private fields and omits `NumberOfPoints="0"`, which VTK
/// requires.
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
    /// VTK and vtkio ignore this attribute.
    #[serde(rename = "@raycost_run", skip_serializing_if = "Option::is_none")]
    run: Option<RunId>,
    #[serde(rename = "$value")]
    content: DataElement,
}

/// This machine's byte order.
pub(crate) const NATIVE_ORDER: ByteOrder = if cfg!(target_endian = "little") {
    ByteOrder::LittleEndian
} else {
    ByteOrder::BigEndian
};

/// Returns this machine's byte order, as VTK names it.
pub(super) fn byte_order() -> &'static str {
    match NATIVE_ORDER {
        ByteOrder::LittleEndian => "LittleEndian",
        ByteOrder::BigEndian => "BigEndian",
    }
}
