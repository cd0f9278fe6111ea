//! The checkerboard.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::texture_point::TexturePoint;
use crate::geometry::RenderSpace;
use crate::values;
use base::keywords;
use math::simd::{Real, Vector};

/// Cubes of two colors that fill space; squares or stripes if `axes` names fewer axes.
///
/// ```
/// # use raycost_world::material::Texture;
/// let floor: Texture = scene::yaml::from_str("
/// checker: { even: [1, 1, 1], odd: [0, 0, 0], size: 0.5, axes: xz }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Checker {
    /// The color of the cell at the origin of world space.
    #[serde(with = "values::Color")]
    pub even: Vec3,
    /// The other color.
    #[serde(with = "values::Color")]
    pub odd: Vec3,
    /// Side length of a cell in world units.
    #[serde(with = "values::ExactPositive")]
    pub size: f64,
    /// The axes along which the colors alternate; a floor needs `xz`.
    #[serde(default)]
    pub axes: Axes,
    /// The rounding of coordinates to cell indices.
    #[serde(default)]
    pub rounding: Rounding,
    /// A corner of a cell of the first color.
    #[serde(skip)]
    pub origin: Vec3,
}

/// A set of axes of world space.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
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

keywords! {
    /// The rounding of coordinates to cell indices.
    #[derive(Default)]
    pub enum Rounding {
        /// Down: all cells have the same size.
        #[default]
        Floor = "floor",
        /// Toward zero, as in the course's program.
        Truncate = "truncate",
    }
}

impl Checker {
    /// Converts the pattern from world space to render space.
    pub(super) fn in_space(&mut self, space: &RenderSpace) {
        let period = match self.rounding {
            Rounding::Floor => Some(2.0 * self.size),
            Rounding::Truncate => None,
        };
        self.origin = space.world_origin(period);
        self.size /= space.unit();
    }

    #[inline(always)]
    pub(super) fn color_at<R: Real>(&self, point: &TexturePoint<R>) -> Vector<R> {
        let point = point.position - Vector::splat(point.position.x, self.origin);
        let zero = point.x.splat(0.0);
        let [on_x, on_y, on_z] = self.axes.alternating();
        let x = if on_x { self.cell(point.x) } else { zero };
        let y = if on_y { self.cell(point.y) } else { zero };
        let z = if on_z { self.cell(point.z) } else { zero };
        // The parity of a float: exact up to 2^24, above which all floats are even.
        let half = (x + y + z) * zero.splat(0.5);
        let is_even = half.equals(half.trunc());
        let [even, odd] = [self.even, self.odd];
        Vector::select(is_even, Vector::splat(zero, even), Vector::splat(zero, odd))
    }

    /// Returns the index of the cell that contains a coordinate.
    #[inline(always)]
    fn cell<R: Real>(&self, coordinate: R) -> R {
        let cells = coordinate / coordinate.splat(self.size as f32);
        match self.rounding {
            Rounding::Floor => cells.floor(),
            Rounding::Truncate => cells.trunc(),
        }
    }
}

impl Axes {
    /// Returns true if the colors alternate along x, y and z.
    fn alternating(self) -> [bool; 3] {
        match self {
            Self::X => [true, false, false],
            Self::Y => [false, true, false],
            Self::Z => [false, false, true],
            Self::Xy => [true, true, false],
            Self::Xz => [true, false, true],
            Self::Yz => [false, true, true],
            Self::Xyz => [true; 3],
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
            origin: Vec3::ZERO,
        };
        let point = TexturePoint::new(point.into(), Vec3::Y.into());
        checker.color_at(&point) == Vec3::ONE.into()
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
