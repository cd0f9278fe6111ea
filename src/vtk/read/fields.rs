//! Reads the field data of a file.

use super::header::{FieldElements, TextElement};
use super::reader::VtkReader;
use crate::field::{Field, FieldValues};
use crate::read::ArrayValues;
use host::text::Diagnostic;

impl VtkReader {
    /// Reads field data: numbers of 64-bit floats or 32-bit integers, and texts.
    pub fn fields(&self, elements: &FieldElements) -> Result<Vec<Field>, Diagnostic> {
        let mut fields = Vec::new();
        for array in &elements.arrays {
            let place = self.place(array, array.n_tuples.unwrap_or(0))?;
            let values = match self.read(&place)? {
                ArrayValues::F64(numbers) => FieldValues::Floats(numbers),
                ArrayValues::I32(numbers) => FieldValues::Integers(numbers),
                _ => {
                    let name = &array.name;
                    return Err(self.foreign(&format!("its field `{name}` is of another type")));
                }
            };
            fields.push(Field {
                name: array.name.clone(),
                values,
            });
        }
        for element in &elements.texts {
            let Some(texts) = texts(element) else {
                let why = format!("its field `{}` holds no texts", element.name);
                return Err(self.foreign(&why));
            };
            fields.push(Field {
                name: element.name.clone(),
                values: FieldValues::Texts(texts),
            });
        }
        Ok(fields)
    }
}

/// Returns the texts of an element: bytes in decimal, each text terminated by 0.
fn texts(element: &TextElement) -> Option<Vec<String>> {
    let bytes = element.bytes.split_ascii_whitespace().map(str::parse);
    let bytes: Vec<u8> = bytes.collect::<Result<_, _>>().ok()?;
    let texts = bytes.strip_suffix(&[0])?.split(|&byte| byte == 0);
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).ok();
    texts.map(text).collect()
}
