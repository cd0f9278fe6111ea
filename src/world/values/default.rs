//! Defaults of keys, for `#[serde(default = "…")]`.

use glam::Vec3;

/// Returns white.
pub fn white() -> Vec3 {
    Vec3::ONE
}

/// Returns 1.
pub fn one<T: From<u8>>() -> T {
    T::from(1)
}

/// Returns a half.
pub fn half() -> f32 {
    0.5
}
