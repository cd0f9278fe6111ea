//! The choice of the arrays that are read from a file.

use super::fault::cut;

/// The array of a file that gives colors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArrayChoice {
    /// The name of the array.
    pub name: String,
    /// The component of the tuples, counted from 0; `None` for the magnitude.
    pub component: Option<usize>,
    /// Points or cells; `None` for whichever the file has.
    pub of: Option<ArrayOf>,
    /// True if its tuples are colors themselves.
    pub is_color: bool,
}

impl ArrayChoice {
    /// Chooses the numbers of a point array: a component of its tuples, or their magnitude.
    pub fn of_points(name: &str, component: Option<usize>) -> Self {
        Self {
            name: name.to_owned(),
            component,
            of: Some(ArrayOf::Points),
            is_color: false,
        }
    }

    /// Returns the note on integers that 64-bit floats round.
    pub(super) fn rounded_note(&self) -> String {
        let name = cut(&self.name);
        format!("integers of `{name}` from 2^53 on are rounded: neighbors may be equal")
    }
}

/// The elements that an array has values for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArrayOf {
    /// Of points.
    Points,
    /// Of cells.
    Cells,
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
