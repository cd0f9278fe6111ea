//! Field data: values that apply to the whole file.

use crate::array::Array;
use crate::data_set::DataSet;

/// The field array that lists the units of the other arrays.
const UNITS: &str = "units";

/// An array of field data: one value per tuple.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Name.
    pub name: String,
    /// Values.
    pub values: FieldValues,
}

/// The values of a [`Field`].
#[derive(Debug, Clone, PartialEq)]
pub enum FieldValues {
    /// 64-bit numbers.
    Floats(Vec<f64>),
    /// 32-bit numbers.
    Integers(Vec<i32>),
    /// Texts.
    Texts(Vec<String>),
}

impl Field {
    /// Creates a field of numbers.
    pub fn floats<F: Into<f64>>(
        name: impl Into<String>,
        numbers: impl IntoIterator<Item = F>,
    ) -> Self {
        let numbers = numbers.into_iter().map(F::into).collect();
        Self::new(name, FieldValues::Floats(numbers))
    }

    /// Creates a field of whole numbers.
    pub fn integers(name: impl Into<String>, numbers: impl Into<Vec<i32>>) -> Self {
        Self::new(name, FieldValues::Integers(numbers.into()))
    }

    /// Creates a field of texts.
    pub fn texts<T: Into<String>>(
        name: impl Into<String>,
        texts: impl IntoIterator<Item = T>,
    ) -> Self {
        let texts = texts.into_iter().map(T::into).collect();
        Self::new(name, FieldValues::Texts(texts))
    }

    fn new(name: impl Into<String>, values: FieldValues) -> Self {
        let name = name.into();
        Self { name, values }
    }

    /// Returns the units of a data set's arrays, each as `name: unit`; `None` if no array has one.
    pub(super) fn units(data_set: &DataSet) -> Option<Self> {
        let arrays = data_set.arrays().into_iter();
        let units = arrays.filter_map(|array| Some(format!("{}: {}", array.name, array.unit?)));
        let units: Vec<String> = units.collect();
        (!units.is_empty()).then(|| Self::new(UNITS, FieldValues::Texts(units)))
    }

    /// Returns the numbers as an array; `None` for texts.
    pub(super) fn array(&self) -> Option<Array<'_>> {
        match &self.values {
            FieldValues::Floats(numbers) => {
                let n = numbers.len();
                Some(Array::new(&self.name, n, || numbers.iter().copied()))
            }
            FieldValues::Integers(numbers) => {
                let n = numbers.len();
                Some(Array::new(&self.name, n, || numbers.iter().copied()))
            }
            FieldValues::Texts(_) => None,
        }
    }
}
