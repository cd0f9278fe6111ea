//! The choices of what is read from a file.

use super::fault::cut;
use world::material::ArrayChoice;

/// Returns the note on integers of an array that 64-bit floats round.
pub(super) fn rounded_note(choice: &ArrayChoice) -> String {
    let name = cut(&choice.name);
    format!("integers of `{name}` from 2^53 on are rounded: neighbors may be equal")
}

/// The choice of isosurfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct IsosurfaceChoice {
    /// The array of points.
    pub array: ArrayChoice,
    /// The value on each surface.
    pub values: Vec<f64>,
}

/// The radii of spheres, or of tubes at their points.
#[derive(Debug, Clone, PartialEq)]
pub enum RadiusChoice {
    /// The same radius for all.
    Same(f32),
    /// The numbers of a point array, times a factor.
    Array {
        /// The array.
        array: ArrayChoice,
        /// The factor.
        factor: f32,
    },
}
