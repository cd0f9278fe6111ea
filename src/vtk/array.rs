//! Arrays to be written to a file.

use std::io::{self, Write};
use std::ops::Range;

use bytemuck::NoUninit;
use vtkio::model::{CellType, ScalarType};

/// Number of entries that are generated at a time.
const CHUNK: usize = 1 << 14;

/// A function that writes the bytes of an array.
pub(crate) type WriteBytes<'a> = Box<dyn Fn(&mut dyn Write) -> io::Result<()> + Sync + 'a>;

/// An array whose bytes are generated while the file is written.
pub struct Array<'a> {
    /// The name in the file.
    pub name: &'a str,
    /// The type of the numbers.
    pub scalar: ScalarType,
    /// Numbers per entry.
    pub n_components: usize,
    /// Bytes of all entries, uncompressed.
    pub n_bytes: u64,
    /// The unit of the numbers; `None` for colors, ids and flags.
    pub unit: Option<&'static str>,
    /// Writes exactly `n_bytes`, in native byte order.
    pub write: WriteBytes<'a>,
}

/// The type of an array's entries: a number, or several components.
pub trait Entry: NoUninit {
    /// The type of the components.
    const SCALAR: ScalarType;
    /// The number of components.
    const N_COMPONENTS: usize = 1;
}

macro_rules! entries {
    ($($number:ty: $scalar:ident),*) => {$(
        impl Entry for $number {
            const SCALAR: ScalarType = ScalarType::$scalar;
        }
    )*};
}

entries!(u8: U8, u16: U16, i32: I32, i64: I64, u32: U32, u64: U64, f32: F32, f64: F64);

impl<E: Entry, const N: usize> Entry for [E; N]
where
    Self: NoUninit,
{
    const SCALAR: ScalarType = E::SCALAR;
    const N_COMPONENTS: usize = N * E::N_COMPONENTS;
}

impl<'a> Array<'a> {
    /// Creates an array of `n` entries; `entries` is called each time the array is written.
    pub fn new<E: Entry, I: Iterator<Item = E>>(
        name: &'a str,
        n: usize,
        entries: impl Fn() -> I + Sync + 'a,
    ) -> Self {
        Self {
            name,
            scalar: E::SCALAR,
            n_components: E::N_COMPONENTS,
            n_bytes: (n * size_of::<E>()) as u64,
            unit: None,
            write: Box::new(move |out| {
                let mut entries = entries();
                let mut chunk = Vec::with_capacity(CHUNK.min(n));
                loop {
                    chunk.clear();
                    chunk.extend(entries.by_ref().take(CHUNK));
                    if chunk.is_empty() {
                        return Ok(());
                    }
                    out.write_all(bytemuck::cast_slice(&chunk))?;
                }
            }),
        }
    }

    /// Returns the number of entries.
    pub fn n_tuples(&self) -> u64 {
        self.n_bytes / (self.scalar.size() * self.n_components) as u64
    }

    /// Sets the unit of the numbers.
    pub fn in_unit(self, unit: &'static str) -> Self {
        let unit = Some(unit);
        Self { unit, ..self }
    }
}

/// The narrowest integer type of an array: ParaView loads 32-bit cells a third faster
/// than 64-bit ones.
#[derive(Clone, Copy)]
pub enum Integers {
    /// 32 bits, signed.
    I32,
    /// 64 bits, signed.
    I64,
}

impl Integers {
    /// Returns the type for numbers from -1 to `largest`.
    pub fn up_to(largest: usize) -> Self {
        match i32::try_from(largest) {
            Ok(_) => Self::I32,
            Err(_) => Self::I64,
        }
    }

    /// Creates an array of `n` integers, which `write` writes.
    pub fn array<'a>(
        self,
        name: &'static str,
        n: usize,
        write: impl Fn(&mut dyn Write) -> io::Result<()> + Sync + 'a,
    ) -> Array<'a> {
        let (scalar, n_bytes) = match self {
            Self::I32 => (ScalarType::I32, 4 * n as u64),
            Self::I64 => (ScalarType::I64, 8 * n as u64),
        };
        Array {
            name,
            scalar,
            n_components: 1,
            n_bytes,
            unit: None,
            write: Box::new(write),
        }
    }

    /// Writes `factor` times each number.
    pub fn write_multiples(
        self,
        factor: usize,
        numbers: Range<usize>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        for first in numbers.clone().step_by(CHUNK) {
            let chunk = first..numbers.end.min(first + CHUNK);
            match self {
                Self::I32 => {
                    let chunk: Vec<i32> = chunk.map(|n| (factor * n) as i32).collect();
                    out.write_all(bytemuck::cast_slice(&chunk))?;
                }
                Self::I64 => {
                    let chunk: Vec<i64> = chunk.map(|n| (factor * n) as i64).collect();
                    out.write_all(bytemuck::cast_slice(&chunk))?;
                }
            }
        }
        Ok(())
    }
}

/// Returns the arrays `connectivity` (0, 1, …) and `offsets` (the ends of the cells) of `n` cells
/// with `n_corners` points each, not shared, in the order of the cells.
pub fn separate_cells(n_corners: usize, n: usize) -> [Array<'static>; 2] {
    let n_points = n_corners * n;
    let ids = Integers::up_to(n_points);
    [
        ids.array("connectivity", n_points, move |out| {
            ids.write_multiples(1, 0..n_points, out)
        }),
        ids.array("offsets", n, move |out| {
            ids.write_multiples(n_corners, 1..n + 1, out)
        }),
    ]
}

/// Returns the array `types` of `n` cells of one type.
pub fn types_of(cell: CellType, n: usize) -> Array<'static> {
    Array::new("types", n, move || std::iter::repeat_n(cell as u8, n))
}

impl Array<'_> {
    /// Writes the array's bytes.
    ///
    /// # Errors
    /// The number of bytes is not `n_bytes`, or `out` fails.
    pub(super) fn write_to(&self, out: &mut impl Write) -> io::Result<()> {
        let mut counted = Counted { out, n_bytes: 0 };
        (self.write)(&mut counted)?;
        if counted.n_bytes == self.n_bytes {
            Ok(())
        } else {
            let (found, name) = (counted.n_bytes, self.name);
            let message = format!("{name}: {found} bytes instead of {}", self.n_bytes);
            Err(io::Error::other(message))
        }
    }
}

/// A writer that counts bytes: a wrong length would shift the arrays that follow.
struct Counted<'a, W> {
    out: &'a mut W,
    n_bytes: u64,
}

impl<W: Write> Write for Counted<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.out.write(bytes)?;
        self.n_bytes += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(array: &Array) -> Vec<u8> {
        let mut out = Vec::new();
        (array.write)(&mut out).unwrap();
        assert_eq!(out.len() as u64, array.n_bytes);
        out
    }

    #[test]
    fn entries_are_written_as_they_come() {
        let n = 2 * CHUNK + 1;
        let pairs = Array::new("pairs", n, || (0..n as u32).map(|i| [i, i * i]));
        assert_eq!(pairs.n_components, 2);
        let expected: Vec<u32> = (0..n as u32).flat_map(|i| [i, i * i]).collect();
        assert_eq!(bytes(&pairs), bytemuck::cast_slice::<u32, u8>(&expected));
        let none = Array::new("none", 0, std::iter::empty::<f32>);
        assert!(bytes(&none).is_empty());
    }

    #[test]
    fn integers_beyond_32_bits_are_64_bits_wide() {
        let bytes_of = |largest, numbers: Range<usize>| {
            let integers = Integers::up_to(largest);
            bytes(&integers.array("pixel", 2, |out| {
                integers.write_multiples(1, numbers.clone(), out)
            }))
        };
        assert_eq!(bytes_of(i32::MAX as usize, 7..9).len(), 8);
        let wide = bytes_of(1 << 31, (1 << 31)..(1 << 31) + 2);
        assert_eq!(wide[..8], (1_i64 << 31).to_ne_bytes());
    }

    #[test]
    fn cells_end_where_the_next_begins() {
        let [connectivity, offsets] = separate_cells(2, 3);
        let of = |numbers: &[i32]| bytemuck::cast_slice::<i32, u8>(numbers).to_vec();
        assert_eq!(bytes(&connectivity), of(&[0, 1, 2, 3, 4, 5]));
        assert_eq!(bytes(&offsets), of(&[2, 4, 6]));
        assert!(
            separate_cells(2, 0)
                .iter()
                .all(|array| bytes(array).is_empty())
        );
    }
}
