//! Interpolation between keyframes.

use serde::Deserialize;

/// How a value changes from one keyframe to the next.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case", expecting = "`linear` or `smooth`")]
pub enum Interpolation {
    /// By the same amount in each frame.
    #[default]
    Linear,
    /// By a cubic curve that begins and ends at rest and never goes beyond the two values.
    Smooth,
}
