//! The numbers of arrays, as their files store them.

use super::super::{FileFault, Result};

/// The least integer whose successor a 64-bit float rounds: 2^53.
const LEAST_ROUNDED: f64 = (1_u64 << f64::MANTISSA_DIGITS) as f64;

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NumberType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl NumberType {
    /// The names of types in VTK's XML files and, after them, in legacy files.
    const NAMES: [(&str, Self); 23] = [
        ("Int8", Self::I8),
        ("UInt8", Self::U8),
        ("Int16", Self::I16),
        ("UInt16", Self::U16),
        ("Int32", Self::I32),
        ("UInt32", Self::U32),
        ("Int64", Self::I64),
        ("UInt64", Self::U64),
        ("Float32", Self::F32),
        ("Float64", Self::F64),
        ("char", Self::I8),
        ("signed_char", Self::I8),
        ("unsigned_char", Self::U8),
        ("short", Self::I16),
        ("unsigned_short", Self::U16),
        ("int", Self::I32),
        // VTK converts its ids to this type in legacy files.
        ("vtkidtype", Self::I32),
        ("unsigned_int", Self::U32),
        ("long", Self::I64),
        ("vtktypeint64", Self::I64),
        ("unsigned_long", Self::U64),
        ("float", Self::F32),
        ("double", Self::F64),
    ];

    /// Returns the type with this name.
    pub(super) fn named(name: &str) -> Option<Self> {
        let is_it = |(known, _): &&(&str, Self)| known.eq_ignore_ascii_case(name);
        Self::NAMES.iter().find(is_it).map(|(_, kind)| *kind)
    }

    /// Returns the number of bytes of a number.
    pub(super) fn n_bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// The order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

impl ByteOrder {
    /// Returns the bytes of a number, least significant first.
    fn little<const N: usize>(self, mut bytes: [u8; N]) -> [u8; N] {
        if self == Self::Big {
            bytes.reverse();
        }
        bytes
    }

    /// Returns the unsigned number in four or eight bytes.
    pub(super) fn length(self, bytes: &[u8]) -> u64 {
        let mut wide = [0; 8];
        wide[..bytes.len()].copy_from_slice(bytes);
        if self == Self::Big {
            wide[..bytes.len()].reverse();
        }
        u64::from_le_bytes(wide)
    }
}

/// The numbers of an array: tuples of `n_components`.
#[derive(Debug, Clone)]
pub(super) struct Numbers {
    pub(super) n_components: usize,
    kind: NumberType,
    order: ByteOrder,
    bytes: Vec<u8>,
}

impl Numbers {
    /// Creates numbers from these bytes, whose length is a multiple of a number's.
    pub(super) fn new(kind: NumberType, order: ByteOrder, bytes: Vec<u8>) -> Self {
        Self {
            n_components: 1,
            kind,
            order,
            bytes,
        }
    }

    /// Creates numbers that were written as text.
    pub(super) fn of_text(numbers: &[f64]) -> Self {
        let bytes = numbers.iter().flat_map(|number| number.to_le_bytes());
        Self::new(NumberType::F64, ByteOrder::Little, bytes.collect())
    }

    /// Returns true if the numbers have a type of whole numbers.
    pub(super) fn are_whole(&self) -> bool {
        !matches!(self.kind, NumberType::F32 | NumberType::F64)
    }

    /// Returns true if some are integers that 64-bit floats may round.
    pub(super) fn are_rounded(&self) -> bool {
        let is_long = matches!(self.kind, NumberType::I64 | NumberType::U64);
        is_long && self.iter().any(|number| number.abs() >= LEAST_ROUNDED)
    }

    /// Groups the numbers into tuples.
    pub(super) fn in_tuples_of(self, n_components: usize) -> Self {
        Self {
            n_components,
            ..self
        }
    }

    /// Removes all numbers after the first `n`.
    pub(super) fn truncate(&mut self, n: usize) {
        self.bytes.truncate(n.saturating_mul(self.kind.n_bytes()));
    }

    /// Returns the number of numbers.
    pub(super) fn len(&self) -> usize {
        self.bytes.len() / self.kind.n_bytes()
    }

    /// Returns number `i`; integers beyond 2^53 are rounded.
    pub(super) fn at(&self, i: usize) -> f64 {
        let order = self.order;
        macro_rules! number {
            ($type:ty) => {{
                let (numbers, _) = self.bytes.as_chunks();
                <$type>::from_le_bytes(order.little(numbers[i])) as f64
            }};
        }
        match self.kind {
            NumberType::I8 => number!(i8),
            NumberType::U8 => number!(u8),
            NumberType::I16 => number!(i16),
            NumberType::U16 => number!(u16),
            NumberType::I32 => number!(i32),
            NumberType::U32 => number!(u32),
            NumberType::I64 => number!(i64),
            NumberType::U64 => number!(u64),
            NumberType::F32 => number!(f32),
            NumberType::F64 => number!(f64),
        }
    }

    /// Returns the numbers in order.
    pub(super) fn iter(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        (0..self.len()).map(|i| self.at(i))
    }

    /// Returns tuple `i` of three numbers.
    pub(super) fn triple(&self, i: usize) -> [f64; 3] {
        [0, 1, 2].map(|k| self.at(3 * i + k))
    }

    /// Checks that there are `n_tuples` tuples.
    ///
    /// # Errors
    /// There are more or fewer numbers, or tuples are empty.
    pub(super) fn check(&self, name: &str, n_tuples: usize) -> Result<()> {
        let Self { n_components, .. } = *self;
        if n_components > 0 && n_tuples.checked_mul(n_components) == Some(self.len()) {
            return Ok(());
        }
        let problem = format!("the array `{name}` has {} numbers", self.len());
        let expected = format!("{n_tuples} times {n_components}");
        Err(FileFault::new(problem, expected))
    }
}
