//! The bytes of arrays in VTK XML files: raw or as base64, compressed or not.

use std::io::{self, Read};

use base64::alphabet;
use base64::engine::{Engine, GeneralPurpose, GeneralPurposeConfig};
use vtkio::model::ByteOrder;

use super::document::Element;
use crate::codec::Compressor;
use crate::header::NATIVE_ORDER;

/// The encoding of the arrays of a file.
#[derive(Debug, Clone, Copy)]
pub struct ArrayEncoding {
    /// The order of the bytes of a number.
    pub order: ByteOrder,
    /// Bytes of the lengths of arrays and blocks: four or eight.
    pub(super) length_bytes: usize,
    /// The compressor of the arrays; `None` if they are uncompressed.
    pub(super) compressor: Option<&'static dyn Compressor>,
}

impl ArrayEncoding {
    /// The encoding of uncompressed arrays that raycost writes.
    pub(super) const RAW: Self = Self {
        order: NATIVE_ORDER,
        length_bytes: 8,
        compressor: None,
    };

    /// Returns the encoding that the attributes of the root element declare. Without them, numbers
    /// are little-endian and lengths have four bytes.
    ///
    /// # Errors
    /// The name of an unknown compressor.
    pub fn new<'a>(root: &'a Element) -> Result<Self, &'a str> {
        let compressor = root.attribute("compressor");
        let compressor = compressor.map(|name| <dyn Compressor>::of_vtk_class(name).ok_or(name));
        Ok(Self {
            order: match root.attribute("byte_order") {
                Some("BigEndian") => ByteOrder::BigEndian,
                _ => ByteOrder::LittleEndian,
            },
            length_bytes: match root.attribute("header_type") {
                Some("UInt64") => 8,
                _ => 4,
            },
            compressor: compressor.transpose()?,
        })
    }

    /// Opens an array, which begins with its length or its block table.
    ///
    /// # Errors
    /// `UnexpectedEof` if the bytes end early, `InvalidData` if they cannot be decoded.
    pub fn open<'a>(&self, mut from: EncodedBytes<'a>) -> io::Result<EncodedArray<'a>> {
        let Some(compressor) = self.compressor else {
            let n_bytes = self.length(&mut from)?;
            if n_bytes > from.max_bytes() {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            let blocks = None;
            return Ok(EncodedArray {
                n_bytes,
                from,
                blocks,
            });
        };
        let head = self.table_head(&mut from)?;
        let [n_blocks, block_bytes, last_bytes] = head;
        let lengths = self.table(head, &mut from)?;
        let n_full = n_blocks.saturating_sub(u64::from(last_bytes > 0));
        let n_bytes = n_full.saturating_mul(block_bytes);
        let n_bytes = n_bytes.saturating_add(if n_blocks > 0 { last_bytes } else { 0 });
        let n_compressed = lengths.iter().fold(0, |sum: u64, n| sum.saturating_add(*n));
        let can_hold = n_compressed.saturating_mul(compressor.max_ratio());
        if n_compressed > from.max_bytes() || n_bytes > can_hold || last_bytes > block_bytes {
            return Err(io::ErrorKind::InvalidData.into());
        }
        Ok(EncodedArray {
            n_bytes,
            from,
            blocks: Some(Blocks {
                compressor,
                block_bytes,
                lengths,
            }),
        })
    }

    /// Reads the length of an array or of a block.
    pub(super) fn length(&self, from: &mut impl Read) -> io::Result<u64> {
        let mut bytes = [0; 8];
        let used = &mut bytes[..self.length_bytes];
        from.read_exact(used)?;
        if self.order == ByteOrder::BigEndian {
            used.reverse();
        }
        Ok(u64::from_le_bytes(bytes))
    }

    /// Reads the start of a block table: the number of blocks, their uncompressed length, and the
    /// length of a shorter last block or 0.
    pub(super) fn table_head(&self, from: &mut impl Read) -> io::Result<[u64; 3]> {
        let mut head = [0; 3];
        for number in &mut head {
            *number = self.length(from)?;
        }
        Ok(head)
    }

    /// Reads the rest of the block table with this start: the compressed length of each block. A
    /// damaged number of blocks allocates no more than the file holds.
    pub(super) fn table(
        &self,
        [n_blocks, ..]: [u64; 3],
        from: &mut impl Read,
    ) -> io::Result<Vec<u64>> {
        (0..n_blocks).map(|_| self.length(from)).collect()
    }
}

/// An array of known length that is not decoded yet.
pub struct EncodedArray<'a> {
    /// Bytes of its numbers, decoded: at most as many as the encoded bytes can hold.
    pub n_bytes: u64,
    from: EncodedBytes<'a>,
    blocks: Option<Blocks>,
}

struct Blocks {
    compressor: &'static dyn Compressor,
    /// Uncompressed bytes of a block.
    block_bytes: u64,
    /// Compressed bytes of each block.
    lengths: Vec<u64>,
}

impl EncodedArray<'_> {
    /// Decodes the array into its `n_bytes`.
    ///
    /// # Errors
    /// As [`ArrayEncoding::open`].
    pub fn decode(mut self, bytes: &mut [u8]) -> io::Result<()> {
        let Some(blocks) = self.blocks else {
            return self.from.read_exact(bytes);
        };
        let (mut compressed, from) = (Vec::new(), &mut self.from);
        let chunks = bytes.chunks_mut(blocks.block_bytes.max(1) as usize);
        for (block, length) in chunks.zip(blocks.lengths) {
            let compressor = blocks.compressor;
            compressor.decompress_from(from, length, &mut compressed, block)?;
        }
        Ok(())
    }
}

/// Accepts nonzero bits after the last byte.
const ENGINE: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_allow_trailing_bits(true),
);
/// Maximum number of groups that are decoded at a time.
const MAX_GROUPS: usize = 1 << 12;

/// Encoded bytes, from the start of an array.
///
/// Base64 is text in groups of four characters for three bytes or, with padding, fewer, with line
/// breaks between groups. Padding may be anywhere: VTK encodes the length or the block table of an
/// array separately.
#[derive(Debug, Clone)]
pub struct EncodedBytes<'a> {
    bytes: &'a [u8],
    is_base64: bool,
    /// Bytes that some groups of base64 encode.
    decoded: Vec<u8>,
    /// Bytes of `decoded` already returned.
    n_read: usize,
}

impl<'a> EncodedBytes<'a> {
    /// Creates the bytes of a text in base64 or, if it is not, the bytes themselves.
    pub fn new(bytes: &'a [u8], is_base64: bool) -> Self {
        Self {
            bytes,
            is_base64,
            decoded: Vec::new(),
            n_read: 0,
        }
    }

    /// Returns an upper bound of the bytes left.
    fn max_bytes(&self) -> u64 {
        (self.bytes.len() + self.decoded.len() - self.n_read) as u64
    }

    /// Decodes the groups that hold the next `n` bytes, or fewer.
    fn advance(&mut self, n: usize) -> io::Result<()> {
        self.decoded.clear();
        self.n_read = 0;
        self.bytes = self.bytes.trim_ascii_start();
        let n_wanted = 4 * n.div_ceil(3).min(MAX_GROUPS);
        // Whole groups, up to a line break, or up to and including padding.
        let mut digits = self.bytes.iter().take(n_wanted);
        let end = digits.position(|c| *c == b'=' || c.is_ascii_whitespace());
        let end = end.unwrap_or(n_wanted.min(self.bytes.len()));
        let end = end.next_multiple_of(4).max(4);
        let groups = self.bytes.split_at_checked(end);
        let (groups, rest) = groups.ok_or(io::ErrorKind::UnexpectedEof)?;
        let decoded = ENGINE.decode_vec(groups, &mut self.decoded);
        decoded.map_err(|_| io::ErrorKind::InvalidData)?;
        self.bytes = rest;
        Ok(())
    }
}

/// Reads of damaged base64 fail with `InvalidData`, reads past its end with `UnexpectedEof`.
impl Read for EncodedBytes<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        if !self.is_base64 {
            return self.bytes.read(into);
        }
        while self.n_read == self.decoded.len() && !into.is_empty() {
            self.advance(into.len())?;
        }
        let n = (&self.decoded[self.n_read..]).read(into)?;
        self.n_read += n;
        Ok(n)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn base64_is_decoded_across_padding(
            parts in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..9), 0..5),
            n_first in 0..20_usize,
        ) {
            let text: String = parts.iter().map(|part| ENGINE.encode(part)).collect();
            let bytes = parts.concat();
            let (first, second) = bytes.split_at(n_first.min(bytes.len()));
            let mut from = EncodedBytes::new(text.as_bytes(), true);
            for part in [first, second] {
                let mut found = vec![0; part.len()];
                from.read_exact(&mut found).unwrap();
                prop_assert_eq!(found, part);
            }
            prop_assert!(from.read_exact(&mut [0]).is_err());
        }
    }

    #[test]
    fn groups_are_on_lines_and_damage_is_found() {
        let bytes = |text: &'static str, n| {
            let mut bytes = vec![0; n];
            let read = EncodedBytes::new(text.as_bytes(), true).read_exact(&mut bytes);
            read.ok().map(|()| bytes)
        };
        assert_eq!(bytes("  YWJj\n ZGU=\nZg==", 6), Some(b"abcdef".to_vec()));
        // Bits after the last byte.
        assert_eq!(bytes("Zh==", 1), Some(b"f".to_vec()));
        for damaged in ["====", "Z===", "Z=g=", "YW Jj", "YWJ", "Y-Jj", ""] {
            assert_eq!(bytes(damaged, 1), None, "{damaged}");
        }
    }
}
