//! The falloff of light with the distance.

use serde::{Deserialize, Serialize};

use math::simd::Real;

/// The falloff of a light with the distance `d` from it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(
    rename_all = "snake_case",
    expecting = "`none`, `inverse` or `inverse_square`"
)]
pub enum Falloff {
    /// None: independent of the distance.
    #[default]
    None,
    /// 1 / d: weaker than in nature.
    Inverse,
    /// 1 / d², as for a point light in nature.
    InverseSquare,
}

impl Falloff {
    /// Returns the exponent of the length that divides an intensity.
    pub(super) fn power(self) -> i32 {
        match self {
            Self::None => 0,
            Self::Inverse => 1,
            Self::InverseSquare => 2,
        }
    }

    /// Returns the factor at a distance, which must be greater than 0.
    #[inline(always)]
    pub fn factor<R: Real>(self, distance: R) -> R {
        let (one, least) = (distance.splat(1.0), distance.splat(f32::MIN_POSITIVE));
        match self {
            Self::None => one,
            Self::Inverse => one / distance.max(least),
            Self::InverseSquare => one / (distance * distance).max(least),
        }
    }
}
