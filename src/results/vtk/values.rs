//! The numbers of an array.

use std::collections::TryReserveError;
use std::io::{self, Read};

/// A number that arrays are made of.
pub trait Number: bytemuck::Pod {
    /// The numbers, where they are of this type.
    fn of(values: &Values) -> Option<&[Self]>;
}

/// Makes [`Values`] of the types that raycost writes.
macro_rules! values {
    ($($kind:ident($number:ty) is $vtk:literal,)*) => {
        /// Numbers of one type, named as in Rust.
        #[derive(Debug, Clone, PartialEq)]
        #[expect(missing_docs, reason = "the name says it")]
        pub enum Values { $($kind(Vec<$number>),)* }

        impl Values {
            /// `n` zeros of the type that VTK calls `vtk`; `None` for a type
            /// that raycost does not write.
            ///
            /// # Errors
            /// Where memory does not suffice.
            pub(super) fn zeros(vtk: &str, n: usize) -> Result<Option<Self>, TryReserveError> {
                Ok(match vtk {
                    $($vtk => Some(Self::$kind(zeros(n)?)),)*
                    _ => None,
                })
            }

            /// How many.
            pub fn len(&self) -> usize {
                match self { $(Self::$kind(numbers) => numbers.len(),)* }
            }

            /// One of them. Those of 64 bits are rounded beyond 2^53.
            ///
            /// # Panics
            /// If there are `index` or fewer.
            pub fn at(&self, index: usize) -> f64 {
                match self { $(Self::$kind(numbers) => numbers[index] as f64,)* }
            }

            /// Their bytes in native order.
            pub fn bytes(&self) -> &[u8] {
                match self { $(Self::$kind(numbers) => bytemuck::cast_slice(numbers),)* }
            }

            fn bytes_mut(&mut self) -> &mut [u8] {
                match self { $(Self::$kind(numbers) => bytemuck::cast_slice_mut(numbers),)* }
            }

            /// What VTK calls their type.
            pub fn vtk_type(&self) -> &'static str {
                match self { $(Self::$kind(_) => $vtk,)* }
            }
        }

        $(impl Number for $number {
            fn of(values: &Values) -> Option<&[Self]> {
                match values {
                    Values::$kind(numbers) => Some(numbers),
                    _ => None,
                }
            }
        })*

        /// Bytes of a number of the type that VTK calls `vtk`; `None` for a
        /// type that raycost does not write.
        pub(super) fn n_bytes(vtk: &str) -> Option<u64> {
            match vtk {
                $($vtk => Some(size_of::<$number>() as u64),)*
                _ => None,
            }
        }
    };
}

values! {
    U8(u8) is "UInt8",
    I32(i32) is "Int32",
    U32(u32) is "UInt32",
    I64(i64) is "Int64",
    U64(u64) is "UInt64",
    F32(f32) is "Float32",
    F64(f64) is "Float64",
}

impl Values {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All of them, where they are of this type.
    pub fn as_slice<T: Number>(&self) -> Option<&[T]> {
        T::of(self)
    }

    /// All of them as [`Self::at`] gives them.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        (0..self.len()).map(|index| self.at(index))
    }

    /// Fills them from a file that has them in `n_rows` equal rows, the last
    /// one first.
    pub(super) fn read_rows(&mut self, n_rows: usize, from: &mut impl Read) -> io::Result<()> {
        let bytes = self.bytes_mut();
        let row_bytes = (bytes.len() / n_rows.max(1)).max(1);
        let mut rows = bytes.chunks_exact_mut(row_bytes).rev();
        rows.try_for_each(|row| from.read_exact(row))
    }
}

fn zeros<T: Number>(n: usize) -> Result<Vec<T>, TryReserveError> {
    let mut numbers = Vec::new();
    numbers.try_reserve_exact(n)?;
    numbers.resize(n, T::zeroed());
    Ok(numbers)
}
