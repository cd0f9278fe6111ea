//! The scale of instances at points.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::same_or_array::{NumberArray, SameOrArray};
use world::material::ArrayChoice;
use world::values;

/// The scale of instances: one number, or an array of a VTK file.
pub type PlaceScale = SameOrArray<ScaleArray>;

/// An array of scales.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(
    deny_unknown_fields,
    expecting = "an array such as { array: diameter, factor: 0.5 }"
)]
pub struct ScaleArray {
    /// The name of the array of points.
    #[serde(with = "values::Name")]
    array: String,
    /// The component of a vector array, counted from 0; the magnitude by default.
    #[serde(default, with = "values::Between::<0, 255>")]
    component: Option<u32>,
    /// The factor from its numbers to scales, greater than 0; 1 by default.
    #[serde(default = "values::one", with = "values::Positive")]
    factor: f32,
}

impl NumberArray for ScaleArray {
    const EXPECTED: &str = "a scale greater than 0, or { array: … }";
}

impl Default for PlaceScale {
    fn default() -> Self {
        Self::Same(1.0)
    }
}

impl PlaceScale {
    /// Returns the array if there is one.
    pub(super) fn array(&self) -> Option<ArrayChoice> {
        match self {
            Self::Same(_) => None,
            Self::Array(ScaleArray {
                array, component, ..
            }) => Some(ArrayChoice::point_array(
                array,
                component.map(|component| component as usize),
            )),
        }
    }

    /// Returns the factor of all instances.
    pub(super) fn factor(&self) -> f32 {
        match self {
            Self::Same(factor) => *factor,
            Self::Array(array) => array.factor,
        }
    }
}
