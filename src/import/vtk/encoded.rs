//! The bytes of arrays in VTK's XML files: raw or as base64, compressed or not.

use std::borrow::Cow;
use std::mem;

use base64::alphabet;
use base64::engine::{Engine, GeneralPurpose, GeneralPurposeConfig};

use super::super::{FileFault, Result};
use super::budget::Budget;
use super::numbers::ByteOrder;
use vtk::Compressor;

/// How a file encodes the bytes of its arrays.
#[derive(Debug, Clone, Copy)]
pub(super) struct ArrayEncoding {
    pub(super) order: ByteOrder,
    /// Bytes of the lengths of arrays and blocks: four or eight.
    pub(super) length_bytes: usize,
    /// The compressor of the arrays, if they are compressed.
    pub(super) compressor: Option<&'static dyn Compressor>,
}

/// Encoded bytes, from the start of an array.
#[derive(Debug, Clone)]
pub(super) enum Encoded<'a> {
    Raw(&'a [u8]),
    Base64(Base64<'a>),
}

impl ArrayEncoding {
    /// Decodes an array, which is preceded by its length.
    ///
    /// # Errors
    /// The bytes end early, cannot be decoded, or are too many for the memory.
    pub(super) fn decode(&self, mut from: Encoded<'_>, budget: &mut Budget) -> Result<Vec<u8>> {
        match self.compressor {
            Some(compressor) => self.decode_blocks(compressor, &mut from, budget),
            None => {
                let n_bytes = self.length(&mut from)?;
                budget.take(n_bytes.min(from.max_bytes()))?;
                Ok(from.bytes(n_bytes)?.into_owned())
            }
        }
    }

    /// Decodes a block table and the blocks. The table has the number of blocks, their uncompressed
    /// length, the length of a shorter last block or 0, and the compressed length of each.
    fn decode_blocks(
        &self,
        compressor: &'static dyn Compressor,
        from: &mut Encoded<'_>,
        budget: &mut Budget,
    ) -> Result<Vec<u8>> {
        let n_blocks = self.length(from)?;
        let (block_bytes, last_bytes) = (self.length(from)?, self.length(from)?);
        // Read one by one, so that a damaged count allocates no more than the file holds.
        let lengths = (0..n_blocks).map(|_| self.length(from));
        let lengths = lengths.collect::<Result<Vec<u64>>>()?;
        let n_full = n_blocks.saturating_sub(u64::from(last_bytes > 0));
        let n_bytes = n_full.saturating_mul(block_bytes);
        let n_bytes = n_bytes.saturating_add(if n_blocks > 0 { last_bytes } else { 0 });
        let n_compressed = lengths.iter().fold(0, |sum: u64, n| sum.saturating_add(*n));
        let can_hold = n_compressed.saturating_mul(compressor.max_ratio());
        if n_compressed > from.max_bytes() || n_bytes > can_hold || last_bytes > block_bytes {
            return Err(damaged());
        }
        budget.take(n_bytes)?;
        let mut bytes = vec![0; n_bytes as usize];
        for (block, length) in bytes.chunks_mut(block_bytes.max(1) as usize).zip(&lengths) {
            let decompressed = compressor.decompress_exact(&from.bytes(*length)?, block);
            decompressed.map_err(|_| damaged())?;
        }
        Ok(bytes)
    }

    fn length(&self, from: &mut Encoded<'_>) -> Result<u64> {
        Ok(self.order.length(&from.bytes(self.length_bytes as u64)?))
    }
}

impl<'a> Encoded<'a> {
    /// Returns the next `n` bytes.
    ///
    /// # Errors
    /// There are fewer bytes.
    fn bytes(&mut self, n: u64) -> Result<Cow<'a, [u8]>> {
        let n = usize::try_from(n).map_err(|_| ends_early())?;
        match self {
            Self::Raw(bytes) => {
                let (first, rest) = bytes.split_at_checked(n).ok_or_else(ends_early)?;
                *bytes = rest;
                Ok(Cow::Borrowed(first))
            }
            Self::Base64(text) => text.bytes(n).map(Cow::Owned),
        }
    }

    /// Returns an upper bound of the bytes left.
    fn max_bytes(&self) -> u64 {
        match self {
            Self::Raw(bytes) => bytes.len() as u64,
            Self::Base64(text) => text.text.len() as u64 + 3,
        }
    }
}

/// Accepts nonzero bits after the last byte.
const ENGINE: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_allow_trailing_bits(true),
);

/// Text in groups of four characters for three bytes or, with padding, fewer, with line breaks
/// between groups. Padding may be anywhere: VTK encodes the length or the block table of an array
/// separately.
#[derive(Debug, Clone)]
pub(super) struct Base64<'a> {
    text: &'a [u8],
    /// At most two decoded bytes that have not been returned yet.
    left: Vec<u8>,
}

impl<'a> Base64<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        let left = Vec::new();
        Self { text, left }
    }

    fn bytes(&mut self, n: usize) -> Result<Vec<u8>> {
        let mut bytes = mem::take(&mut self.left);
        while bytes.len() < n {
            self.text = self.text.trim_ascii_start();
            let n_wanted = (n - bytes.len()).div_ceil(3).saturating_mul(4);
            // Whole groups, up to a line break, or up to and including padding.
            let mut digits = self.text.iter().take(n_wanted);
            let end = digits.position(|c| *c == b'=' || c.is_ascii_whitespace());
            let end = end.unwrap_or(n_wanted.min(self.text.len()));
            let end = end.next_multiple_of(4).max(4);
            let (groups, rest) = self.text.split_at_checked(end).ok_or_else(ends_early)?;
            let decoded = ENGINE.decode_vec(groups, &mut bytes);
            decoded.map_err(|_| damaged())?;
            self.text = rest;
        }
        self.left = bytes.split_off(n);
        Ok(bytes)
    }
}

fn ends_early() -> FileFault {
    FileFault::new("it ends early", "a whole file")
}

fn damaged() -> FileFault {
    FileFault::new("its bytes cannot be decoded", "a file that is not damaged")
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
            let mut from = Base64::new(text.as_bytes());
            prop_assert_eq!(from.bytes(first.len()).unwrap(), first);
            prop_assert_eq!(from.bytes(second.len()).unwrap(), second);
            prop_assert!(from.bytes(1).is_err());
        }
    }

    #[test]
    fn groups_are_on_lines_and_damage_is_found() {
        let bytes = |text: &'static str, n| Base64::new(text.as_bytes()).bytes(n).ok();
        assert_eq!(bytes("  YWJj\n ZGU=\nZg==", 6), Some(b"abcdef".to_vec()));
        // Bits after the last byte.
        assert_eq!(bytes("Zh==", 1), Some(b"f".to_vec()));
        for damaged in ["====", "Z===", "Z=g=", "YW Jj", "YWJ", "Y-Jj", ""] {
            assert_eq!(bytes(damaged, 1), None, "{damaged}");
        }
    }
}
