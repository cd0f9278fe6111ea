//! Bumps and dents as a picture of normals.

use serde::{Deserialize, Serialize};

use super::image::ImageTexture;
use super::texture_point::TexturePoint;
use crate::color::Transfer;
use crate::values;
use math::simd::{Real, Vector};

/// A picture whose red, green and blue are the coordinates of unit vectors, from -1 at 0 to 1 at
/// the greatest number: to the right in the picture, upward in it (as in OpenGL), and away from the
/// surface. They replace the surface's own normal in shading.
///
/// ```
/// # use raycost_world::material::NormalMap;
/// let planks: NormalMap = scene::yaml::from_str("
/// image: { file: planks_normals.png, mapping: planar }
/// strength: 0.5   # of the bumps; 1 for those of the picture
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(from = "NormalMapKeys")]
pub struct NormalMap {
    /// The picture, linear by default.
    pub image: ImageTexture,
    /// The factor of the bumps' slopes, at least 0.
    pub strength: f32,
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(
    deny_unknown_fields,
    expecting = "a picture of normals such as { image: { file: normals.png } }"
)]
struct NormalMapKeys {
    /// The picture, linear by default.
    image: ImageTexture,
    /// The factor of the bumps' slopes, at least 0.
    #[serde(default = "values::one", with = "values::NonNegative")]
    strength: f32,
}

impl From<NormalMapKeys> for NormalMap {
    fn from(
        NormalMapKeys {
            mut image,
            strength,
        }: NormalMapKeys,
    ) -> Self {
        image.transfer.get_or_insert(Transfer::Linear);
        Self { image, strength }
    }
}

impl NormalMap {
    /// Returns the unit normal at a point; the point's own normal if the picture's would be on the
    /// other side of the geometric one.
    #[inline(always)]
    pub(super) fn normal_at<R: Real>(
        &self,
        point: &TexturePoint<R>,
        geometric_normal: Vector<R>,
    ) -> Vector<R> {
        let own = point.normal;
        let tilted = self.image.tilted(point, self.strength).normalize_or(own);
        let zero = own.x.splat(0.0);
        let is_outside = zero.lt(tilted.dot(geometric_normal));
        Vector::select(is_outside, tilted, own)
    }
}
