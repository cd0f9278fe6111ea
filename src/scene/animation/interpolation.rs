//! Interpolation between keyframes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The interpolation between two keyframes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", expecting = "`linear` or `smooth`")]
pub enum Interpolation {
    /// By the same amount in each frame.
    #[default]
    Linear,
    /// By a cubic curve that begins and ends at rest and never goes beyond the two values.
    Smooth,
}
