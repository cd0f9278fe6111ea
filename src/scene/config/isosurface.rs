//! The isosurfaces of data sets.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use import::IsosurfaceChoice;
use world::kinds;
use world::material::{ArrayChoice, ArrayOf};
use world::values::{self, OneOrList, coordinate_or_list};

/// The surfaces within a data set where an array of its points has a value.
///
/// ```
/// # use raycost_scene::config::Isosurface;
/// let flame: Isosurface = raycost_scene::yaml::from_str("
/// { array: temperature, value: 1200 }
/// ").unwrap();
/// let fronts: Isosurface = raycost_scene::yaml::from_str("
/// { array: velocity, component: 2, value: [-0.5, 0.5] }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(
    deny_unknown_fields,
    expecting = "an isosurface such as { array: temperature, value: 1200 }"
)]
pub struct Isosurface {
    /// The name of the array of points.
    #[serde(with = "values::Name")]
    array: String,
    /// The component of a vector array, counted from 0; the magnitude by default.
    #[serde(default, with = "values::Between::<0, 255>")]
    component: Option<u32>,
    /// The value, or a list with one per surface.
    #[serde(with = "Values")]
    value: Vec<f64>,
}

impl Isosurface {
    /// Returns the choice of arrays to read from the file.
    pub fn choice(&self) -> IsosurfaceChoice {
        IsosurfaceChoice {
            array: ArrayChoice {
                name: self.array.clone(),
                component: self.component.map(|component| component as usize),
                is_color: false,
                of: Some(ArrayOf::Points),
            },
            values: self.value.clone(),
        }
    }
}

kinds! {
    Values: Vec<f64> = coordinate_or_list("a value, or a list of values") => |found| match found {
        OneOrList::One(value) => vec![value],
        OneOrList::List(values) => values,
    };
}
