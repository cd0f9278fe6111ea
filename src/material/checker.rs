//! The checkerboard.

use glam::{BVec3, Vec3};
use serde::Deserialize;

use crate::yaml;

/// Cubes of two colors that fill space; squares or stripes where `axes` names
/// fewer axes.
///
/// ```
/// # use raycost::material::Texture;
/// let floor: Texture = raycost::yaml::from_str("
/// checker: { even: [1, 1, 1], odd: [0, 0, 0], size: 0.5, axes: xz }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Checker {
    /// The color of the cell at the origin of world space.
    #[serde(deserialize_with = "yaml::color")]
    pub even: Vec3,
    /// The other color.
    #[serde(deserialize_with = "yaml::color")]
    pub odd: Vec3,
    /// Side length of a cell in world units.
    #[serde(deserialize_with = "yaml::positive")]
    pub size: f32,
    /// The axes along which the colors alternate; all by default. A floor at the
    /// boundary of two cells in y needs `xz`: rounding would mix their colors.
    #[serde(default)]
    pub axes: Axes,
    /// How coordinates are rounded to the indices of cells.
    #[serde(default)]
    pub rounding: Rounding,
}

/// A set of axes of world space.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase", expecting = "axes such as `x` or `xz`")]
#[expect(missing_docs, reason = "each variant names its axes")]
pub enum Axes {
    X,
    Y,
    Z,
    Xy,
    Xz,
    Yz,
    #[default]
    Xyz,
}

/// How coordinates are rounded to the indices of cells.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case", expecting = "`floor` or `truncate`")]
pub enum Rounding {
    /// Toward negative infinity: all cells have the same size.
    #[default]
    Floor,
    /// Toward zero, as in the course's NumPy model: the cells at zero are twice as
    /// wide.
    Truncate,
}

impl Checker {
    pub(super) fn color_at(&self, point: Vec3) -> Vec3 {
        let cell = match self.rounding {
            Rounding::Floor => (point / self.size).floor(),
            Rounding::Truncate => (point / self.size).trunc(),
        };
        let indices = Vec3::select(self.axes.mask(), cell, Vec3::ZERO);
        let sum = indices.element_sum();
        // The parity of a float: exact up to 2^24, where all floats are even.
        if (sum * 0.5).fract() == 0.0 {
            self.even
        } else {
            self.odd
        }
    }
}

impl Axes {
    fn mask(self) -> BVec3 {
        match self {
            Self::X => BVec3::new(true, false, false),
            Self::Y => BVec3::new(false, true, false),
            Self::Z => BVec3::new(false, false, true),
            Self::Xy => BVec3::new(true, true, false),
            Self::Xz => BVec3::new(true, false, true),
            Self::Yz => BVec3::new(false, true, true),
            Self::Xyz => BVec3::TRUE,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_even(rounding: Rounding, axes: Axes, point: Vec3) -> bool {
        let checker = Checker {
            even: Vec3::ONE,
            odd: Vec3::ZERO,
            size: 0.5,
            axes,
            rounding,
        };
        checker.color_at(point) == Vec3::ONE
    }

    #[test]
    fn neighboring_cells_differ() {
        let even = |x: f32, z: f32| is_even(Rounding::Floor, Axes::Xz, Vec3::new(x, 9.7, z));
        assert!(even(0.1, 0.1) && !even(0.6, 0.1) && even(0.6, 0.6));
        assert!(!even(-0.1, 0.1) && even(-0.1, -0.1));
    }

    #[test]
    fn truncation_doubles_the_cells_at_zero() {
        let even = |x: f32| is_even(Rounding::Truncate, Axes::X, Vec3::new(x, 0.0, 0.0));
        assert!(even(-0.4) && even(0.4));
        assert!(!even(0.6) && !even(-0.6));
    }
}
