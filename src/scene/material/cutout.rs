//! Holes in surfaces by a picture: leaves, nets, fences.

use serde::Deserialize;

use super::image::ImageTexture;
use super::texture_point::TexturePoint;
use crate::yaml;

/// A picture that cuts holes into a surface, where its opacity is below a threshold. Rays pass
/// through the holes.
///
/// ```
/// # use scene::material::Cutout;
/// let leaf: Cutout = scene::yaml::from_str("
/// image: { file: leaf.png }   # its opacity, or its brightness if it is opaque
/// threshold: 0.3              # 0.5 by default
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a picture with holes such as { image: { file: leaf.png } }"
)]
pub struct Cutout {
    /// The picture: its opacity counts, or its largest channel if it is opaque.
    pub image: ImageTexture,
    /// The least opacity of the surface, 0 to 1; there are holes below it. 0.5 by default.
    #[serde(default = "yaml::half", deserialize_with = "yaml::fraction")]
    pub threshold: f32,
}

impl Cutout {
    /// Returns true if there is a hole at a point.
    pub fn is_hole(&self, point: &TexturePoint<f32>) -> bool {
        let [red, green, blue, opacity] = self.image.values_at(point);
        let opacity = if self.image.picture.is_opaque() {
            red.max(green).max(blue)
        } else {
            opacity
        };
        opacity < self.threshold
    }
}
