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
            pub(crate) fn zeros(vtk: &str, n: usize) -> Result<Option<Self>, TryReserveError> {
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
        pub(crate) fn n_bytes(vtk: &str) -> Option<u64> {
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

/// Some pixels of an image.
pub(crate) struct Pick<'a> {
    /// Columns and rows of the image.
    pub(crate) size: [usize; 2],
    /// How many numbers a pixel.
    pub(crate) n_components: usize,
    /// Which columns of which rows, both ascending.
    pub(crate) columns: &'a [u32],
    pub(crate) rows: &'a [u32],
}

impl Pick<'_> {
    /// How many numbers are picked.
    pub(crate) fn n_numbers(&self) -> u64 {
        self.columns.len() as u64 * self.rows.len() as u64 * self.n_components as u64
    }
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
    pub(crate) fn read_rows(&mut self, n_rows: usize, from: &mut dyn Read) -> io::Result<()> {
        let bytes = self.bytes_mut();
        let row_bytes = (bytes.len() / n_rows.max(1)).max(1);
        let mut rows = bytes.chunks_exact_mut(row_bytes).rev();
        rows.try_for_each(|row| from.read_exact(row))
    }

    /// Fills them with the pixels that are picked, from a file that has all of
    /// them, the last row first; one row is in memory at a time.
    pub(crate) fn read_picked(&mut self, pick: &Pick, from: &mut dyn Read) -> io::Result<()> {
        let [n_columns, n_rows] = pick.size;
        let n_picked = pick.columns.len() * pick.rows.len();
        let bytes = self.bytes_mut();
        let pixel_bytes = bytes.len() / n_picked.max(1);
        let mut row = vec![0; n_columns * pixel_bytes];
        let picked_row_bytes = (pick.columns.len() * pixel_bytes).max(1);
        let picked = bytes.chunks_exact_mut(picked_row_bytes).zip(pick.rows);
        let mut picked = picked.rev().peekable();
        for y in (0..n_rows).rev() {
            from.read_exact(&mut row)?;
            if let Some((into, _)) = picked.next_if(|(_, wanted)| **wanted as usize == y) {
                for (into, &x) in into.chunks_exact_mut(pixel_bytes).zip(pick.columns) {
                    let begin = x as usize * pixel_bytes;
                    into.copy_from_slice(&row[begin..begin + pixel_bytes]);
                }
            }
        }
        Ok(())
    }
}

fn zeros<T: Number>(n: usize) -> Result<Vec<T>, TryReserveError> {
    let mut numbers = Vec::new();
    numbers.try_reserve_exact(n)?;
    numbers.resize(n, T::zeroed());
    Ok(numbers)
}
