//! NumPy arrays: `.npy` files.
//!
//! <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>

use super::source::{ForeignNumbers, ForeignSource};
use host::text::Diagnostic;

/// The first bytes of a file; two bytes of a version and the length of the header follow.
pub(super) const SIGNATURE: &[u8] = b"\x93NUMPY";

/// A type of numbers.
struct NpyType {
    /// The name in the header.
    name: &'static str,
    n_bytes: usize,
    /// Converts the bytes of a number.
    value: fn(&[u8]) -> Option<f64>,
}

/// Returns the row of a little-endian type.
macro_rules! npy_type {
    ($name:literal, $number:ty) => {
        NpyType {
            name: $name,
            n_bytes: size_of::<$number>(),
            value: |bytes| Some(<$number>::from_le_bytes(bytes.try_into().ok()?) as f64),
        }
    };
}

const TYPES: [NpyType; 8] = [
    npy_type!("|u1", u8),
    npy_type!("<u2", u16),
    npy_type!("<u4", u32),
    npy_type!("<i4", i32),
    npy_type!("<u8", u64),
    npy_type!("<i8", i64),
    npy_type!("<f4", f32),
    npy_type!("<f8", f64),
];

/// The remedy for an array of another type.
const CONVERT: &str = "save it with `np.save(file, np.ascontiguousarray(array, \"<f4\"))`";

/// Reads an array of shape (height, width) or (height, width, channels), and returns true if its
/// numbers are bytes.
pub(super) fn read(source: &ForeignSource) -> Result<(ForeignNumbers, bool), Diagnostic> {
    let (header, body) = parts(&source.bytes).ok_or_else(|| damaged(source))?;
    let entry = |key: &str| {
        let (_, rest) = header.split_once(&format!("'{key}':"))?;
        Some(rest.trim_start())
    };
    let (Some(name), Some(order), Some(shape)) =
        (entry("descr"), entry("fortran_order"), entry("shape"))
    else {
        return Err(damaged(source));
    };
    let name = name.split('\'').nth(1).unwrap_or(name);
    let Some(kind) = TYPES.iter().find(|kind| kind.name == name) else {
        let names = TYPES.map(|kind| kind.name).join("`, `");
        let problem = format!("its type is `{name}`, not one of `{names}`");
        return Err(source.refuse(problem, CONVERT));
    };
    if !order.starts_with("False") {
        let help = "save it with `np.save(file, np.ascontiguousarray(array))`";
        return Err(source.refuse("its order is Fortran's, column by column", help));
    }
    let n_channels = parse_channels(source, shape)?;
    let n_values = source.n_pixels() * n_channels;
    source.check_length(body.len(), n_values * kind.n_bytes)?;
    let values = body.chunks_exact(kind.n_bytes).filter_map(kind.value);
    let values = values.collect();
    Ok((ForeignNumbers { n_channels, values }, kind.name == "|u1"))
}

/// Returns the number of channels of an array of this shape.
fn parse_channels(source: &ForeignSource, shape: &str) -> Result<usize, Diagnostic> {
    let shape = shape.trim_start_matches('(').split(')').next();
    let shape = shape.unwrap_or_default();
    let lengths = shape.split(',').map(str::trim).filter(|n| !n.is_empty());
    let lengths: Result<Vec<u64>, _> = lengths.map(str::parse).collect();
    let (height, width, n_channels) = match lengths.as_deref() {
        Ok(&[height, width]) => (height, width, 1),
        Ok(&[height, width, n_channels @ (1 | 3)]) => (height, width, n_channels as usize),
        _ => {
            let [width, height] = source.size;
            let help = format!(
                "save a cost map as ({height}, {width}), a picture as ({height}, {width}, 3)"
            );
            return Err(source.refuse(format!("its shape is ({shape})"), help));
        }
    };
    source.check_size([width, height])?;
    Ok(n_channels)
}

/// Returns the header and the bytes of the numbers.
fn parts(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let rest = bytes.strip_prefix(SIGNATURE)?;
    let (&[major, _], rest) = rest.split_first_chunk()?;
    let (n_bytes, rest) = if major == 1 {
        let (length, rest) = rest.split_first_chunk()?;
        (u16::from_le_bytes(*length).into(), rest)
    } else {
        let (length, rest) = rest.split_first_chunk()?;
        (u32::from_le_bytes(*length) as usize, rest)
    };
    let (header, body) = rest.split_at_checked(n_bytes)?;
    Some((std::str::from_utf8(header).ok()?, body))
}

fn damaged(source: &ForeignSource) -> Diagnostic {
    source.refuse("its header is damaged", "save it again with `np.save`")
}
