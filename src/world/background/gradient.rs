//! Two colors, linear in the height of the direction.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::values;
use math::simd::{Real, Vector};

/// A linear gradient between two colors; see the module's documentation.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(deny_unknown_fields, expecting = "two colors: { bottom: …, top: … }")]
pub struct Gradient {
    /// The color straight down.
    #[serde(with = "values::Radiance")]
    pub bottom: Vec3,
    /// The color straight up.
    #[serde(with = "values::Radiance")]
    pub top: Vec3,
}

impl Gradient {
    /// Returns a gradient with the same color everywhere.
    pub(super) fn uniform(color: Vec3) -> Self {
        Self {
            bottom: color,
            top: color,
        }
    }

    /// Returns the color in a direction, a unit vector: `bottom` straight down (-y), `top` straight
    /// up.
    #[inline(always)]
    pub(super) fn color<R: Real>(&self, direction: Vector<R>) -> Vector<R> {
        let (half, one) = (direction.y.splat(0.5), direction.y.splat(1.0));
        let height = half * (direction.y + one);
        let bottom = Vector::splat(half, self.bottom);
        let top = Vector::splat(half, self.top);
        bottom * (one - height) + top * height
    }
}
