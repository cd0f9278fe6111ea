//! The choice of the array of a file that gives surfaces their colors.

use base::keywords;

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

keywords! {
    /// The elements that an array has values for.
    pub enum ArrayOf {
        /// Interpolated between points.
        Points = "points",
        /// Constant on each cell.
        Cells = "cells",
    }
}
