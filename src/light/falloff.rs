//! The falloff of light with the distance.

use serde::Deserialize;

/// The falloff of a light with the distance `d` from it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
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
    /// 1 / d²: that of a point light in nature.
    InverseSquare,
}

impl Falloff {
    /// The factor at `distance` world units, greater than 0.
    pub fn factor(self, distance: f32) -> f32 {
        match self {
            Self::None => 1.0,
            Self::Inverse => distance.max(f32::MIN_POSITIVE).recip(),
            Self::InverseSquare => (distance * distance).max(f32::MIN_POSITIVE).recip(),
        }
    }
}
