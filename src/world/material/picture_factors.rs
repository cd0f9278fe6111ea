//! Properties of a surface that vary over it as textures do.

use glam::Vec3;

use super::image::ImageTexture;
use super::texture::Texture;
use super::texture_point::TexturePoint;
use math::simd::{Real, Vector};

/// The textures of a material's properties, each multiplied by the material's number.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FactorPictures {
    /// The factor of the emitted light.
    pub emission: Option<Texture>,
    /// The factors of the roughness, in green, and of the metallicness, in blue, as in glTF.
    pub facets: Option<ImageTexture>,
}

/// The factors of a material's properties that pictures give at one point, or one per lane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureFactors<R> {
    /// The factor of the emitted light.
    pub emission: Vector<R>,
    /// The factor of the roughness, 0 to 1.
    pub roughness: R,
    /// The factor of the metallicness, 0 to 1.
    pub metallic: R,
}

impl FactorPictures {
    /// Returns the pictures.
    pub(super) fn images(&self) -> impl Iterator<Item = &ImageTexture> {
        let emission = self.emission.as_ref().and_then(Texture::image);
        emission.into_iter().chain(&self.facets)
    }

    /// Returns the pictures.
    pub(super) fn images_mut(&mut self) -> impl Iterator<Item = &mut ImageTexture> {
        let emission = self.emission.as_mut().and_then(Texture::image_mut);
        emission.into_iter().chain(&mut self.facets)
    }

    /// Returns the factors at a point.
    #[inline(always)]
    pub fn at<R: Real>(&self, point: &TexturePoint<R>) -> PictureFactors<R> {
        let mut found = PictureFactors::ones(point.width);
        if let Some(texture) = &self.emission {
            found.emission = texture.color_at(point);
        }
        if let Some(image) = &self.facets {
            [_, found.roughness, found.metallic, _] = image.values_at(point);
        }
        found
    }
}

impl<R: Real> PictureFactors<R> {
    /// Returns the factors of a material without pictures.
    #[inline(always)]
    pub fn ones(like: R) -> Self {
        let one = like.splat(1.0);
        Self {
            emission: Vector::splat(one, Vec3::ONE),
            roughness: one,
            metallic: one,
        }
    }
}
