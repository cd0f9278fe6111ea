//! The colors of the vertices of a mesh.

use glam::Vec3;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::image::ImageTexture;
use super::texture_point::TexturePoint;
use crate::material::{ArrayChoice, ArrayOf};
use crate::values;
use math::simd::{Real, Vector};

/// The colors of the vertices of a mesh, interpolated over its triangles, such as scanned or
/// painted colors.
///
/// ```
/// # use raycost_world::material::Texture;
/// let scanned: Texture = scene::yaml::from_str("vertex_colors").unwrap();
/// let seen: Texture = scene::yaml::from_str("
/// vertex_colors: { array: RGB, of: cells }   # of a VTK file
/// ").unwrap();
/// # assert!(scanned.is_of_vertices() && seen.is_of_vertices());
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(with = "VertexColorKeys")
)]
pub struct VertexColors {
    /// A color that multiplies the vertices' colors.
    pub tint: Vec3,
    /// A picture that multiplies the vertices' colors.
    pub image: Option<Box<ImageTexture>>,
    /// The array of a VTK file that has the colors.
    pub array: Option<ArrayChoice>,
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

/// The keys for a VTK file.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(
    deny_unknown_fields,
    expecting = "`vertex_colors`, or an array such as { array: RGB }"
)]
struct VertexColorKeys {
    /// The name of the array of colors in a VTK file.
    #[serde(with = "values::Name")]
    array: String,
    /// The kind of the array; by default, whichever the file has.
    #[serde(default)]
    of: Option<ArrayOf>,
}

/// Writes a word without keys, or an array.
impl Serialize for VertexColors {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        let Some(choice) = &self.array else {
            return s.serialize_str("vertex_colors");
        };
        let keys = VertexColorKeys {
            array: choice.name.clone(),
            of: choice.of,
        };
        s.serialize_newtype_variant("Texture", 0, "vertex_colors", &keys)
    }
}

/// Reads a word without keys, or an array.
impl<'de> Deserialize<'de> for VertexColors {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        let keys = Option::<VertexColorKeys>::deserialize(d)?;
        Ok(Self {
            tint: Vec3::ONE,
            image: None,
            array: keys.map(|keys| ArrayChoice {
                name: keys.array,
                component: None,
                of: keys.of,
                is_color: true,
            }),
        })
    }
}
