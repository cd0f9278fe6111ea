//! The `background` section.

use glam::Vec3;
use serde::Deserialize;

use crate::simd::{Real, Vector};
use crate::yaml::{self, ColorOr};

/// The color of rays that hit nothing.
///
/// ```
/// # use raycost::config::Background;
/// let sky: Background = raycost::yaml::from_str("
/// gradient: { bottom: [0.9, 0.9, 1], top: [0.3, 0.5, 0.9] }
/// ").unwrap();
/// let gray: Background = raycost::yaml::from_str("0.2").unwrap();
/// # assert_eq!(gray.color(glam::Vec3::Y.into()), glam::Vec3::splat(0.2).into());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(from = "ColorOr<Pattern>")]
pub struct Background {
    bottom: Vec3,
    top: Vec3,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Pattern {
    /// Two colors, linear in the height of the direction.
    Gradient(Gradient),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "two colors: { bottom: …, top: … }")]
struct Gradient {
    /// The color straight down.
    #[serde(deserialize_with = "yaml::color")]
    bottom: Vec3,
    /// The color straight up.
    #[serde(deserialize_with = "yaml::color")]
    top: Vec3,
}

/// Black.
impl Default for Background {
    fn default() -> Self {
        ColorOr::Color(Vec3::ZERO).into()
    }
}

impl From<ColorOr<Pattern>> for Background {
    fn from(found: ColorOr<Pattern>) -> Self {
        let (bottom, top) = match found {
            ColorOr::Color(color) => (color, color),
            ColorOr::Other(Pattern::Gradient(Gradient { bottom, top })) => (bottom, top),
        };
        Self { bottom, top }
    }
}

impl Background {
    /// Returns the color of a ray in `direction`, a unit vector: `bottom`
    /// straight down (-y), `top` straight up, linear in between.
    #[inline(always)]
    pub fn color<R: Real>(&self, direction: Vector<R>) -> Vector<R> {
        let (half, one) = (direction.y.splat(0.5), direction.y.splat(1.0));
        let height = half * (direction.y + one);
        let [bottom, top] = [self.bottom, self.top].map(|color| Vector::splat(half, color));
        bottom * (one - height) + top * height
    }
}
