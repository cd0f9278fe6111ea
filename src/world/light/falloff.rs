//! The falloff of light with the distance.

use base::keywords;
use math::simd::Real;

keywords! {
    /// The falloff of a light with the distance `d` from it.
    #[derive(Default)]
    pub enum Falloff {
        /// Independent of the distance.
        #[default]
        None = "none",
        /// 1 / d: weaker than in nature.
        Inverse = "inverse",
        /// 1 / d², as for a point light in nature.
        InverseSquare = "inverse_square",
    }
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
