//! Numbers as text of a page.

use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::vtk::Values;

/// Bytes in a page: zlib in base64, under an id.
#[derive(Debug)]
pub(super) struct Payload {
    id: String,
    base64: String,
}

impl Payload {
    /// Numbers, sorted by the weight of their bytes, the lightest first: the
    /// upper bytes of counters are zeros, and zeros in a row take no room.
    pub(super) fn of_numbers(id: &str, values: &Values) -> Self {
        Self::of_bytes(id, &planes(values.bytes(), width(values)))
    }

    /// Any bytes.
    pub(super) fn of_bytes(id: &str, bytes: &[u8]) -> Self {
        let mut zlib = ZlibEncoder::new(Vec::new(), Compression::default());
        let packed = zlib.write_all(bytes).and_then(|()| zlib.finish());
        let packed = packed.expect("a Vec takes all that is written to it");
        Self {
            id: id.to_owned(),
            base64: STANDARD.encode(packed),
        }
    }

    /// Bytes of its text.
    pub(super) fn n_bytes(&self) -> u64 {
        self.base64.len() as u64
    }

    /// Writes an element that holds them. Neither base64 nor an id has a `<`.
    pub(super) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let Self { id, base64 } = self;
        writeln!(
            out,
            "<script type=\"text/plain\" id=\"{id}\">{base64}</script>"
        )
    }
}

/// What the page's script calls the type.
pub(super) fn type_name(values: &Values) -> &'static str {
    match values {
        Values::U8(_) => "u8",
        Values::I32(_) => "i32",
        Values::U32(_) => "u32",
        Values::I64(_) => "i64",
        Values::U64(_) => "u64",
        Values::F32(_) => "f32",
        Values::F64(_) => "f64",
    }
}

/// Bytes a number.
fn width(values: &Values) -> usize {
    match values.len() {
        0 => 1,
        n => values.bytes().len() / n,
    }
}

/// All numbers' first bytes, then all their second ones, …, from the lightest.
fn planes(bytes: &[u8], width: usize) -> Vec<u8> {
    let at = |plane| match cfg!(target_endian = "little") {
        true => plane,
        false => width - 1 - plane,
    };
    let plane = |plane| bytes.iter().skip(at(plane)).step_by(width).copied();
    (0..width).flat_map(plane).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    #[test]
    fn bytes_of_equal_weight_stand_together() {
        let numbers = Values::U32(vec![0x0403_0201, 0x1413_1211]);
        let bytes = planes(numbers.bytes(), width(&numbers));
        assert_eq!(bytes, [1, 0x11, 2, 0x12, 3, 0x13, 4, 0x14]);
    }

    #[test]
    fn a_payload_is_zlib_in_base64() {
        let payload = Payload::of_bytes("a", b"all of it");
        let packed = STANDARD.decode(&payload.base64).unwrap();
        let mut text = String::new();
        let mut zlib = flate2::read::ZlibDecoder::new(&packed[..]);
        zlib.read_to_string(&mut text).unwrap();
        assert_eq!(text, "all of it");
    }
}
