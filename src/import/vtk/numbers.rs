//! The numbers of arrays, as their files store them.

use super::super::{FileFault, Result};
use vtk::ArrayValues;
use vtk::read::{ScalarType, scalar_of};

/// The least integer whose successor a 64-bit float rounds: 2^53.
const LEAST_ROUNDED: f64 = (1_u64 << f64::MANTISSA_DIGITS) as f64;

/// The names of types in VTK's legacy files.
const LEGACY_NAMES: [(&str, ScalarType); 13] = [
    ("char", ScalarType::I8),
    ("signed_char", ScalarType::I8),
    ("unsigned_char", ScalarType::U8),
    ("short", ScalarType::I16),
    ("unsigned_short", ScalarType::U16),
    ("int", ScalarType::I32),
    // VTK converts its ids to this type in legacy files.
    ("vtkidtype", ScalarType::I32),
    ("unsigned_int", ScalarType::U32),
    ("long", ScalarType::I64),
    ("vtktypeint64", ScalarType::I64),
    ("unsigned_long", ScalarType::U64),
    ("float", ScalarType::F32),
    ("double", ScalarType::F64),
];

/// Returns the type of numbers of this name in XML or legacy files.
pub(super) fn scalar_type(name: &str) -> Option<ScalarType> {
    let mut legacy = LEGACY_NAMES.iter();
    let legacy = legacy.find(|(known, _)| known.eq_ignore_ascii_case(name));
    scalar_of(name).or(legacy.map(|(_, scalar)| *scalar))
}

/// The numbers of an array: tuples of `n_components`.
#[derive(Debug, Clone)]
pub(super) struct Numbers {
    pub(super) n_components: usize,
    values: ArrayValues,
}

impl Numbers {
    /// Creates tuples of one number.
    pub(super) fn new(values: ArrayValues) -> Self {
        let n_components = 1;
        Self {
            n_components,
            values,
        }
    }

    /// Creates numbers that were written as text.
    pub(super) fn from_text(numbers: Vec<f64>) -> Self {
        Self::new(ArrayValues::F64(numbers))
    }

    /// Returns true if the numbers have a type of whole numbers.
    pub(super) fn are_whole(&self) -> bool {
        !matches!(self.values, ArrayValues::F32(_) | ArrayValues::F64(_))
    }

    /// Returns true if some are integers that 64-bit floats may round.
    pub(super) fn are_rounded(&self) -> bool {
        let is_long = matches!(self.values, ArrayValues::I64(_) | ArrayValues::U64(_));
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
        self.values.truncate(n);
    }

    /// Returns the number of numbers.
    pub(super) fn len(&self) -> usize {
        self.values.len()
    }

    /// Returns number `i`; integers beyond 2^53 are rounded.
    pub(super) fn at(&self, i: usize) -> f64 {
        self.values.at(i)
    }

    /// Returns the numbers in order.
    pub(super) fn iter(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.values.iter()
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
