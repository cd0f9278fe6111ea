//! The numbers of an array.

use std::collections::TryReserveError;
use std::io::{self, Read};

use vtkio::model::{ByteOrder, ScalarType};

use crate::header::NATIVE_ORDER;

/// A reader that can leave out bytes.
pub(super) trait Skip: Read {
    /// Passes over the next `n` bytes, which there are.
    fn skip(&mut self, n: u64) -> io::Result<()>;
}

/// The type of the numbers of an array.
pub trait Scalar: bytemuck::Pod {
    /// Returns the numbers, if they have this type.
    fn slice(values: &ArrayValues) -> Option<&[Self]>;
}

/// Defines [`ArrayValues`] for the number types of VTK.
macro_rules! values {
    ($($kind:ident($number:ty) is $vtk:literal,)*) => {
        /// The numbers of an array; one variant per type, named as in Rust.
        #[derive(Debug, Clone, PartialEq)]
        #[expect(missing_docs, reason = "each variant is named as its type")]
        pub enum ArrayValues { $($kind(Vec<$number>),)* }

        impl ArrayValues {
            /// Allocates `n` zeros of a type; bits are bytes.
            ///
            /// # Errors
            /// There is not enough memory.
            pub(super) fn zeros(scalar: ScalarType, n: usize) -> Result<Self, TryReserveError> {
                Ok(match scalar {
                    $(ScalarType::$kind => Self::$kind(zeros(n)?),)*
                    ScalarType::Bit => Self::U8(zeros(n)?),
                })
            }

            /// Removes all numbers after the first `n`.
            pub fn truncate(&mut self, n: usize) {
                match self { $(Self::$kind(numbers) => numbers.truncate(n),)* }
            }

            /// Appends the numbers of `other`; false if the types differ.
            pub fn append(&mut self, other: &Self) -> bool {
                match (self, other) {
                    $((Self::$kind(numbers), Self::$kind(others)) => {
                        numbers.extend_from_slice(&others);
                        true
                    })*
                    _ => false,
                }
            }

            /// Returns the number of numbers.
            pub fn len(&self) -> usize {
                match self { $(Self::$kind(numbers) => numbers.len(),)* }
            }

            /// Returns the number at `index`; 64-bit integers beyond 2^53 are rounded.
            ///
            /// # Panics
            /// If `index` is out of bounds.
            pub fn at(&self, index: usize) -> f64 {
                match self { $(Self::$kind(numbers) => numbers[index] as f64,)* }
            }

            /// Returns the bytes of the numbers in native order.
            pub fn bytes(&self) -> &[u8] {
                match self { $(Self::$kind(numbers) => bytemuck::cast_slice(numbers),)* }
            }

            fn bytes_mut(&mut self) -> &mut [u8] {
                match self { $(Self::$kind(numbers) => bytemuck::cast_slice_mut(numbers),)* }
            }

            /// Returns the name of the numbers' type in Rust.
            pub fn type_name(&self) -> &'static str {
                match self { $(Self::$kind(_) => stringify!($number),)* }
            }

            /// Returns the bytes of a number.
            pub fn number_bytes(&self) -> usize {
                match self { $(Self::$kind(_) => size_of::<$number>(),)* }
            }
        }

        $(impl Scalar for $number {
            fn slice(values: &ArrayValues) -> Option<&[Self]> {
                match values {
                    ArrayValues::$kind(numbers) => Some(numbers),
                    _ => None,
                }
            }
        })*

        /// Returns the type of numbers that VTK's XML files name so, in any case.
        pub fn scalar_of(vtk: &str) -> Option<ScalarType> {
            let types = [$(($vtk, ScalarType::$kind)),*];
            let mut types = types.into_iter();
            types.find(|(known, _)| known.eq_ignore_ascii_case(vtk)).map(|(_, scalar)| scalar)
        }

        /// Returns VTK's name for a type of numbers; bits are bytes.
        pub(crate) fn vtk_type(scalar: ScalarType) -> &'static str {
            match scalar {
                $(ScalarType::$kind => $vtk,)*
                ScalarType::Bit => "UInt8",
            }
        }
    };
}

values! {
    I8(i8) is "Int8",
    U8(u8) is "UInt8",
    I16(i16) is "Int16",
    U16(u16) is "UInt16",
    I32(i32) is "Int32",
    U32(u32) is "UInt32",
    I64(i64) is "Int64",
    U64(u64) is "UInt64",
    F32(f32) is "Float32",
    F64(f64) is "Float64",
}

/// A selection of pixels of an image.
pub struct Selection<'a> {
    /// Columns and rows of the image.
    pub size: [usize; 2],
    /// Numbers per pixel.
    pub n_components: usize,
    /// The columns of the selection, ascending.
    pub columns: &'a [u32],
    /// The rows of the selection, ascending.
    pub rows: &'a [u32],
}

impl Selection<'_> {
    /// Returns the number of selected numbers.
    pub fn n_numbers(&self) -> u64 {
        self.columns.len() as u64 * self.rows.len() as u64 * self.n_components as u64
    }
}

impl ArrayValues {
    /// Allocates `n` numbers and calls `fill` with their bytes, which come in this order.
    ///
    /// # Errors
    /// `fill` fails, or there is not enough memory.
    pub fn read(
        scalar: ScalarType,
        n: usize,
        order: ByteOrder,
        fill: impl FnOnce(&mut [u8]) -> io::Result<()>,
    ) -> io::Result<Self> {
        let mut values = Self::zeros(scalar, n)?;
        fill(values.bytes_mut())?;
        if order != NATIVE_ORDER {
            let n_bytes = values.number_bytes();
            let numbers = values.bytes_mut().chunks_exact_mut(n_bytes);
            numbers.for_each(<[u8]>::reverse);
        }
        Ok(values)
    }

    /// Returns true if there are no numbers.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the numbers, if they have type `T`.
    pub fn as_slice<T: Scalar>(&self) -> Option<&[T]> {
        T::slice(self)
    }

    /// Iterates over the numbers as [`Self::at`] converts them.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        (0..self.len()).map(|index| self.at(index))
    }

    /// Reads the numbers from a file that stores rows of `row_bytes`, bottom row first.
    pub(crate) fn read_rows(&mut self, row_bytes: usize, from: &mut dyn Read) -> io::Result<()> {
        let mut rows = self.bytes_mut().chunks_exact_mut(row_bytes.max(1)).rev();
        rows.try_for_each(|row| from.read_exact(row))
    }

    /// Reads the selected pixels from a file that stores all rows of the image, bottom row first;
    /// one row is in memory at a time.
    pub(super) fn read_selected(
        &mut self,
        selection: &Selection,
        from: &mut dyn Skip,
    ) -> io::Result<()> {
        let [n_columns, n_rows] = selection.size;
        let n_selected = selection.columns.len() * selection.rows.len();
        let bytes = self.bytes_mut();
        let pixel_bytes = bytes.len() / n_selected.max(1);
        let mut row = vec![0; n_columns * pixel_bytes];
        let selected_row_bytes = (selection.columns.len() * pixel_bytes).max(1);
        let selected = bytes
            .chunks_exact_mut(selected_row_bytes)
            .zip(selection.rows);
        let mut end = n_rows;
        for (into, &y) in selected.rev() {
            let n_skipped = end - 1 - y as usize;
            from.skip((n_skipped * row.len()) as u64)?;
            from.read_exact(&mut row)?;
            end = y as usize;
            for (into, &x) in into.chunks_exact_mut(pixel_bytes).zip(selection.columns) {
                let begin = x as usize * pixel_bytes;
                into.copy_from_slice(&row[begin..begin + pixel_bytes]);
            }
        }
        Ok(())
    }
}

fn zeros<T: Scalar>(n: usize) -> Result<Vec<T>, TryReserveError> {
    let mut numbers = Vec::new();
    numbers.try_reserve_exact(n)?;
    numbers.resize(n, T::zeroed());
    Ok(numbers)
}
