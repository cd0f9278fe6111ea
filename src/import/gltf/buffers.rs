//! The bytes of a glTF file's buffers: in the file, in its JSON as base64, or in other files.

use std::borrow::Cow;
use std::path::Path;

use base64::Engine;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf_json::{Buffer, Index, Root, buffer};

use crate::budget::Budget;
use crate::materials::{of_reference, path_in};
use crate::percent::{percent_decoded, percent_decoded_bytes};
use crate::{FileFault, Result, max_bytes, open, read_whole};

/// The bytes of all buffers; the fault of a buffer matters only where it is used.
pub(super) struct Buffers<'a>(Vec<Result<Cow<'a, [u8]>>>);

impl<'a> Buffers<'a> {
    /// Reads the buffers. `binary` is the first buffer of a binary file, `folder` is the file's.
    pub(super) fn read(
        root: &'a Root,
        binary: Option<&'a [u8]>,
        folder: &Path,
        budget: &mut Budget,
    ) -> Self {
        let read = |(i, buffer): (usize, &Buffer)| {
            let bytes = match (&buffer.uri, binary) {
                (Some(uri), _) => Cow::Owned(bytes_of_uri(uri, folder, budget)?),
                (None, Some(binary)) if i == 0 => Cow::Borrowed(binary),
                (None, _) => {
                    let problem = format!("`buffers[{i}]` has no bytes");
                    return Err(FileFault::new(problem, "its `uri`"));
                }
            };
            if (bytes.len() as u64) < buffer.byte_length.0 {
                let problem = format!("`buffers[{i}]` has {} bytes", bytes.len());
                let expected = format!("the {} of its `byteLength`", buffer.byte_length.0);
                return Err(FileFault::new(problem, expected));
            }
            Ok(bytes)
        };
        Self(root.buffers.iter().enumerate().map(read).collect())
    }

    /// Returns the bytes of a view of a buffer, and the bytes from one element to the next if they
    /// are given.
    ///
    /// # Errors
    /// The view exceeds its buffer, or the buffer was not read.
    pub(super) fn view(
        &self,
        root: &Root,
        index: Index<buffer::View>,
    ) -> Result<(&[u8], Option<usize>)> {
        let outside = || {
            let problem = format!("`bufferViews[{}]` reaches out of its buffer", index.value());
            FileFault::new(problem, "an offset and a length within it")
        };
        let view = root.get(index).ok_or_else(outside)?;
        let from = view.byte_offset.map_or(0, |offset| offset.0);
        let end = from.checked_add(view.byte_length.0).ok_or_else(outside)?;
        let buffer = self.0.get(view.buffer.value()).ok_or_else(outside)?;
        let buffer = buffer.as_ref().map_err(Clone::clone)?;
        let bytes = buffer
            .get(from as usize..end as usize)
            .ok_or_else(outside)?;
        Ok((bytes, view.byte_stride.map(|stride| stride.0)))
    }
}

/// Returns the bytes that a URI refers to.
///
/// # Errors
/// The base64 is damaged, or the file cannot be read.
pub(super) fn bytes_of_uri(uri: &str, folder: &Path, budget: &mut Budget) -> Result<Vec<u8>> {
    if let Some(bytes) = embedded(uri, budget) {
        return bytes;
    }
    let path = path_in(folder, &percent_decoded(uri));
    let read = max_bytes(&path).and_then(|_| read_whole(open(&path)?, budget));
    read.map_err(|fault| of_reference(&path, fault))
}

/// Returns the bytes that a URI contains; `None` if it refers to a file.
pub(super) fn embedded(uri: &str, budget: &mut Budget) -> Option<Result<Vec<u8>>> {
    let (kind, text) = uri.strip_prefix("data:")?.split_once(',')?;
    Some(budget.take(3 * text.len() as u64).and_then(|()| {
        let mut written = percent_decoded_bytes(text);
        if !kind.ends_with(";base64") {
            return Ok(written);
        }
        written.retain(|letter| !letter.is_ascii_whitespace());
        BASE64.decode(written).map_err(|error| {
            let problem = format!("a `uri` has damaged base64: {error}");
            FileFault::new(problem, "letters of base64")
        })
    }))
}

/// Base64 as browsers read it: with or without padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);
