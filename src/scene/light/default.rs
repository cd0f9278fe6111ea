//! The defaults of YAML keys that all lights have.

use glam::Vec3;

/// Returns the default of a light's `color`.
pub(super) fn white() -> Vec3 {
    Vec3::ONE
}

/// Returns the default of a light's `intensity`.
pub(super) fn one() -> f32 {
    1.0
}
