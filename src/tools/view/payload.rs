//! Encodes numbers as text of a page.

use std::io::{self, Write};

use base64::engine::GeneralPurpose;
use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderStringWriter;
use flate2::Compression;
use flate2::write::ZlibEncoder;

use vtk::ArrayValues;

/// Bytes with an ID, compressed by zlib and encoded in base64.
#[derive(Debug)]
pub(super) struct Payload {
    id: String,
    base64: String,
}

impl Payload {
    /// Encodes numbers as byte planes, the least significant first: the high bytes of counters are
    /// zeros, and runs of zeros compress well.
    pub(super) fn encode_numbers(id: &str, values: &ArrayValues) -> Self {
        Self::encode(id, &planes(values.bytes(), values.number_bytes()))
    }

    /// Encodes bytes.
    fn encode(id: &str, bytes: &[u8]) -> Self {
        let mut encoder = PayloadEncoder::new(id);
        encoder.encode(bytes);
        encoder.finish()
    }

    /// Returns the length of the text in bytes.
    pub(super) fn n_bytes(&self) -> u64 {
        self.base64.len() as u64
    }

    /// Writes the element that holds the text. Neither base64 nor an ID contains `<`.
    pub(super) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let Self { id, base64 } = self;
        writeln!(
            out,
            "<script type=\"text/plain\" id=\"{id}\">{base64}</script>"
        )
    }
}

/// A payload whose bytes come one after the other.
pub(super) struct PayloadEncoder {
    id: String,
    zlib: ZlibEncoder<EncoderStringWriter<'static, GeneralPurpose, String>>,
}

impl PayloadEncoder {
    /// Starts an empty payload.
    pub(super) fn new(id: &str) -> Self {
        Self {
            id: id.to_owned(),
            zlib: ZlibEncoder::new(EncoderStringWriter::new(&STANDARD), Compression::default()),
        }
    }

    /// Encodes more bytes.
    pub(super) fn encode(&mut self, bytes: &[u8]) {
        let written = self.zlib.write_all(bytes);
        written.expect("writing to a String cannot fail");
    }

    /// Returns the payload.
    pub(super) fn finish(self) -> Payload {
        let base64 = self.zlib.finish();
        let base64 = base64.expect("writing to a String cannot fail");
        Payload {
            id: self.id,
            base64: base64.into_inner(),
        }
    }
}

/// Transposes numbers to byte planes: the least significant bytes of all numbers, then the next
/// bytes, and so on.
fn planes(bytes: &[u8], width: usize) -> Vec<u8> {
    let at = |plane| {
        if cfg!(target_endian = "little") {
            plane
        } else {
            width - 1 - plane
        }
    };
    let plane = |plane| bytes.iter().skip(at(plane)).step_by(width).copied();
    (0..width).flat_map(plane).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use base64::Engine;
    use std::io::Read;

    #[test]
    fn bytes_of_equal_significance_are_adjacent() {
        let numbers = ArrayValues::U32(vec![0x0403_0201, 0x1413_1211]);
        let bytes = planes(numbers.bytes(), numbers.number_bytes());
        assert_eq!(bytes, [1, 0x11, 2, 0x12, 3, 0x13, 4, 0x14]);
    }

    #[test]
    fn a_payload_is_zlib_in_base64() {
        let payload = Payload::encode("a", b"all of it");
        let compressed = STANDARD.decode(&payload.base64).unwrap();
        let mut text = String::new();
        let mut zlib = flate2::read::ZlibDecoder::new(&compressed[..]);
        zlib.read_to_string(&mut text).unwrap();
        assert_eq!(text, "all of it");
    }
}
