//! The choice of the array of a file that gives surfaces their colors.

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
    pub fn point_array(name: &str, component: Option<usize>) -> Self {
        Self {
            name: name.to_owned(),
            component,
            of: Some(ArrayOf::Points),
            is_color: false,
        }
    }
}

/// The elements that an array has values for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArrayOf {
    /// Points: interpolated between them.
    Points,
    /// Cells: constant on each cell.
    Cells,
}
