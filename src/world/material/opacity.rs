//! The opacity of surfaces: light that a surface does not meet goes straight on.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, IntoDeserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use super::image::ImageTexture;
use super::texture_point::TexturePoint;
use crate::integers_as_f64;
use crate::values;
use math::simd::Real;

/// The share of light that a surface meets; the rest passes as if nothing were there.
///
/// ```
/// # use raycost_world::material::Opacity;
/// # let veil: Opacity = scene::yaml::from_str("0.3").unwrap();
/// let lace: Opacity = scene::yaml::from_str("
/// image: { file: lace.png }   # its opacity, or its brightness if it is opaque
/// factor: 0.8                 # 1 by default
/// ").unwrap();
/// # assert_eq!((veil.factor, lace.factor), (0.3, 0.8));
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "values::Either<values::Fraction, OpacityKeys>", transform = values::expected::<Self>))]
pub struct Opacity {
    /// The factor of all opacities, 0 to 1.
    pub factor: f32,
    /// The picture, if there is one: its opacity counts, or its largest channel if it is opaque.
    pub image: Option<ImageTexture>,
    /// The least opacity of a surface with holes, which is opaque around them.
    pub threshold: Option<f32>,
}

impl Opacity {
    /// Returns the keys that lead to the picture.
    pub fn keys(&self) -> &'static [&'static str] {
        match self.threshold {
            Some(_) => &["cutout", "image"],
            None => &["opacity", "image"],
        }
    }

    /// Returns the opacity at a point, from 0 to 1; `of_vertices` is that of the vertices.
    pub fn at<R: Real>(&self, point: &TexturePoint<R>, of_vertices: R) -> R {
        let (zero, one) = (of_vertices.splat(0.0), of_vertices.splat(1.0));
        let of_image = self.image.as_ref().map_or(one, |image| {
            let [red, green, blue, opacity] = image.values_at(point);
            if image.picture.is_opaque() {
                red.max(green).max(blue)
            } else {
                opacity
            }
        });
        let opacity = one.splat(self.factor) * of_vertices * of_image;
        let opacity = opacity.max(zero).min(one);
        match self.threshold {
            Some(threshold) => R::select(one.splat(threshold).le(opacity), one, zero),
            None => opacity,
        }
    }
}

impl<'de> Deserialize<'de> for Opacity {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(OpacityVisitor)
    }
}

struct OpacityVisitor;

impl<'de> Visitor<'de> for OpacityVisitor {
    type Value = Opacity;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number from 0 to 1, or a picture such as { image: { file: lace.png } }")
    }

    fn visit_f64<E: Error>(self, found: f64) -> Result<Opacity, E> {
        Ok(Opacity {
            factor: values::Fraction::deserialize(found.into_deserializer())?,
            image: None,
            threshold: None,
        })
    }

    integers_as_f64!();

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Opacity, A::Error> {
        let keys = OpacityKeys::deserialize(MapAccessDeserializer::new(map))?;
        Ok(Opacity {
            factor: keys.factor,
            image: Some(keys.image),
            threshold: None,
        })
    }
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct OpacityKeys {
    /// The picture: its opacity, or its largest channel if it is opaque.
    image: ImageTexture,
    /// The factor of the picture's opacity, 0 to 1; 1 by default.
    #[serde(default = "values::one", with = "values::Fraction")]
    factor: f32,
}

/// A picture that cuts holes into a surface, where its opacity is below a threshold. Rays pass
/// through the holes.
///
/// ```
/// # use raycost_world::material::Cutout;
/// let leaf: Cutout = scene::yaml::from_str("
/// image: { file: leaf.png }   # its opacity, or its brightness if it is opaque
/// threshold: 0.3              # 0.5 by default
/// ").unwrap();
/// ```
#[derive(Debug, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(
    deny_unknown_fields,
    expecting = "a picture with holes such as { image: { file: leaf.png } }"
)]
pub struct Cutout {
    /// The picture: its opacity, or its largest channel if it is opaque.
    pub image: ImageTexture,
    /// The least opacity of the surface, 0 to 1; there are holes below it. 0.5 by default.
    #[serde(default = "values::half", with = "values::Fraction")]
    pub threshold: f32,
}

/// Writes a number, or the keys of a picture.
impl Serialize for Opacity {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        let Self { factor, image, .. } = self.clone();
        match image {
            None => s.serialize_f32(factor),
            Some(image) => OpacityKeys { image, factor }.serialize(s),
        }
    }
}

impl From<Cutout> for Opacity {
    fn from(Cutout { image, threshold }: Cutout) -> Self {
        Self {
            factor: 1.0,
            image: Some(image),
            threshold: Some(threshold),
        }
    }
}
