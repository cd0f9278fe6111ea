//! Which arrays of a file are read, and what for.

/// Which numbers of a file make colors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArrayChoice {
    /// The name of the array.
    pub name: String,
    /// The component of its tuples, of which the first is 0; `None` for the magnitude.
    pub component: Option<usize>,
    /// Whether it is an array of points or of cells; `None` for the one that there is.
    pub of: Option<ArrayOf>,
    /// Whether its tuples are colors themselves.
    pub is_color: bool,
}

impl ArrayChoice {
    /// The numbers of an array of points: a component of its tuples, or their magnitude.
    pub fn of_points(name: &str, component: Option<usize>) -> Self {
        Self {
            name: name.to_owned(),
            component,
            of: Some(ArrayOf::Points),
            is_color: false,
        }
    }
}

/// What an array has values of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArrayOf {
    /// Of points.
    Points,
    /// Of cells.
    Cells,
}

/// Isosurfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct IsosurfaceChoice {
    /// The array of points.
    pub array: ArrayChoice,
    /// Its value on each surface.
    pub values: Vec<f32>,
}

/// The radii of spheres, or of tubes at their points.
#[derive(Debug, Clone, PartialEq)]
pub enum RadiusChoice {
    /// The same for all.
    Same(f32),
    /// The numbers of an array of points, times a factor.
    Array {
        /// The array.
        array: ArrayChoice,
        /// The factor.
        factor: f32,
    },
}
