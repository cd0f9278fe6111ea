//! The colors of the vertices of a mesh.

use glam::Vec3;
use serde::{Deserialize, Deserializer};

use super::image::ImageTexture;
use super::texture_point::TexturePoint;
use crate::simd::{Real, Vector};

/// The colors of the vertices of a mesh, interpolated over its triangles: those that a
/// scanner saw, or that someone painted.
///
/// ```
/// # use raycost::material::Texture;
/// let scanned: Texture = raycost::yaml::from_str("vertex_colors").unwrap();
/// # assert!(scanned.is_of_vertices());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct VertexColors {
    /// A color by which they are multiplied.
    pub tint: Vec3,
    /// A picture by which they are multiplied.
    pub image: Option<Box<ImageTexture>>,
}

impl VertexColors {
    #[inline(always)]
    pub(super) fn color_at<R: Real>(&self, point: &TexturePoint<R>) -> Vector<R> {
        let color = point.color.times(Vector::splat(point.color.x, self.tint));
        match &self.image {
            None => color,
            Some(image) => color.times(image.color_at(point)),
        }
    }
}

/// A word without keys.
impl<'de> Deserialize<'de> for VertexColors {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        <()>::deserialize(d).map(|()| Self {
            tint: Vec3::ONE,
            image: None,
        })
    }
}
