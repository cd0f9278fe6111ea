//! How a light weakens with the distance.

use serde::Deserialize;

/// A light's weakening with the distance `d` from it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(
    rename_all = "snake_case",
    expecting = "`none`, `inverse` or `inverse_square`"
)]
pub enum Falloff {
    /// None: as bright far away as near.
    #[default]
    None,
    /// As 1 / d: softer than nature.
    Inverse,
    /// As 1 / d²: a small light in nature.
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
