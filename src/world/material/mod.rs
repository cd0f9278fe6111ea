//! Materials: how surfaces reflect light.

mod color_table;
mod array_choice;
mod array;
mod checker;
mod conductor;
mod dielectric;
mod image;
mod kind;
mod normal_map;
mod opacity;
mod picture_factors;
mod principled;
mod rough_surface;
mod texture_point;
mod vertex_colors;
mod texture;

use std::sync::Arc;

use glam::Vec3;
use serde::{Deserialize, Serialize};

pub use array::{ArrayRange, ArrayScale, ArrayTexture};
pub use array_choice::{ArrayChoice, ArrayOf};
pub use checker::{Axes, Rounding};
pub use color_table::ColorTable;
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use image::{Mapping, Planar, Spherical, Triplanar};
pub use kind::MaterialKind;
pub use normal_map::NormalMap;
pub use opacity::{Cutout, Opacity};
pub use picture_factors::{FactorPictures, PictureFactors};
pub use principled::Principled;
pub use rough_surface::RoughSurface;
pub use texture::*;
pub use texture_point::TexturePoint;

use crate::fog::HenyeyGreenstein;
use crate::geometry::RenderSpace;
use crate::values;
use math::optics::{Ggx, Masking};
use math::simd::{Real, Vector};

/// One of the scene file's `materials`, for the Blinn-Phong model.
///
/// ```
/// # use raycost_world::material::Material;
/// let mirror: Material = scene::yaml::from_str("
/// color: \"#c0c8d0\"   # or [r, g, b], one gray, { checker: … }, { image: … }
/// ambient: 1          # fraction of the ambient light, 0 to 1
/// diffuse: 0.4        # 0 to 1
/// specular: 0.6       # 0 to 1
/// exponent: 80        # size of the highlight: larger is sharper
/// reflection: 0.5     # fraction of the mirrored ray, 0 to 1
/// normal_map: { image: { file: dents.png, mapping: planar } }   # bumps and dents
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(
    try_from = "MaterialKeys",
    into = "MaterialKeys",
    expecting = "a material such as { color: [1, 0, 0] }"
)]
pub struct Material {
    /// The color of the diffuse reflection.
    pub color: Texture,
    /// Fraction of the scene's ambient light, 0 to 1.
    pub ambient: f32,
    /// Fraction of the diffuse light, 0 to 1.
    pub diffuse: f32,
    /// Strength of the highlight, 0 to 1.
    pub specular: f32,
    /// Exponent of the highlight, at least 0.
    pub exponent: f32,
    /// The way in which it scatters light besides.
    pub kind: MaterialKind,
    /// True if light that microscopic facets reflect onto each other counts, in path tracing.
    pub multiple_scattering: bool,
    /// The microscopic facets in path tracing; `None` for a smooth surface, and in a scene file.
    pub rough: Option<Arc<RoughSurface>>,
    /// The radiance that the surface emits, the same in all directions.
    pub emission: Vec3,
    /// True if both sides reflect and emit light, and not only the outer one, on the side of the
    /// shape's own normal.
    pub two_sided: bool,
    /// The bumps and dents of the surface, if there are any.
    pub normal_map: Option<NormalMap>,
    /// The share of light that the surface meets; `None` for all.
    pub opacity: Option<Opacity>,
    /// The pictures of roughness, metallicness and emission from a mesh file.
    pub factors: FactorPictures,
}

impl Material {
    /// Creates the particles of fog with these colors.
    pub fn particles(color: Vec3, phase: HenyeyGreenstein) -> Self {
        Self {
            ambient: 0.0,
            exponent: 0.0,
            multiple_scattering: false,
            kind: MaterialKind::Particles(phase),
            ..Self::matte(Texture::Color(color))
        }
    }

    /// Creates a matte surface: all keys but the color at their defaults.
    pub fn matte(color: Texture) -> Self {
        Self {
            color,
            ambient: 1.0,
            diffuse: 1.0,
            specular: 0.0,
            exponent: 50.0,
            kind: MaterialKind::MATTE,
            multiple_scattering: true,
            rough: None,
            emission: Vec3::ZERO,
            two_sided: true,
            normal_map: None,
            opacity: None,
            factors: FactorPictures::default(),
        }
    }

    /// Converts the material of a scene file to one that rays meet: its lengths to render space, and
    /// its surface to microscopic facets with this masking, for path tracing.
    pub fn in_scene(mut self, space: &RenderSpace, masking: Option<Masking>) -> Self {
        if let Texture::Checker(checker) = &mut self.color {
            checker.in_space(space);
        }
        self.images_mut().for_each(|image| image.in_space(space));
        if let Some(medium) = self.kind.medium_mut() {
            let absorption = medium.absorption.to_array();
            medium.absorption = absorption.map(|per| space.times_length(-1, per)).into();
        }
        self.rough = masking.and_then(|masking| self.rough_surface(masking));
        self
    }

    /// Returns true if it emits light.
    #[inline]
    pub fn emits(&self) -> bool {
        self.emission != Vec3::ZERO
    }

    /// Returns true if light passes a part of the surface.
    pub fn is_veil(&self) -> bool {
        let opacity = self.opacity.as_ref();
        opacity.is_some_and(|opacity| opacity.threshold.is_none())
    }

    /// Returns true if it reflects or refracts anything.
    #[inline]
    pub fn scatters(&self) -> bool {
        self.is_lit() || self.kind.mirrors() || self.kind.medium().is_some()
    }

    /// Returns the microscopic facets; `None` for a smooth surface.
    fn rough_surface(&self, masking: Masking) -> Option<Arc<RoughSurface>> {
        let facets = match &self.kind {
            MaterialKind::Principled { surface, .. } => surface.facets(masking),
            MaterialKind::Dielectric { roughness, .. }
            | MaterialKind::Conductor { roughness, .. } => {
                Ggx::from_roughness(*roughness, masking)?
            }
            MaterialKind::Opaque { .. } | MaterialKind::Particles(_) => {
                // As wide as the highlight: Walter et al., EGSR 2007.
                let alpha = (2.0 / (2.0 + self.exponent)).sqrt();
                (self.specular > 0.0).then_some(Ggx {
                    alpha: alpha.max(Ggx::MIN_ALPHA),
                    masking,
                })?
            }
        };
        let index = self.kind.medium().map(|medium| medium.index);
        Some(Arc::new(
            if self.multiple_scattering && self.factors.facets.is_some() {
                RoughSurface::varying(facets)
            } else if self.multiple_scattering {
                RoughSurface::new(facets, index)
            } else {
                RoughSurface::losing(facets)
            },
        ))
    }

    /// Returns the pictures, each with the keys that lead to it.
    pub fn images(&self) -> impl Iterator<Item = (&'static [&'static str], &ImageTexture)> {
        let color = self.color.image();
        let normals = self.normal_map.as_ref().map(|map| &map.image);
        let opacity = self
            .opacity
            .as_ref()
            .and_then(|of| Some((of.keys(), of.image.as_ref()?)));
        let color = color.map(|image| (&["color", "image"][..], image));
        let normals = normals.map(|image| (&["normal_map", "image"][..], image));
        let factors = self.factors.images();
        let factors = factors.map(|image| (&["factors"][..], image));
        color
            .into_iter()
            .chain(normals)
            .chain(opacity)
            .chain(factors)
    }

    /// Returns the pictures.
    pub fn images_mut(&mut self) -> impl Iterator<Item = &mut ImageTexture> {
        let normals = self.normal_map.as_mut().map(|map| &mut map.image);
        let opacity = self.opacity.as_mut().and_then(|of| of.image.as_mut());
        let color = self.color.image_mut().into_iter();
        color
            .chain(normals)
            .chain(opacity)
            .chain(self.factors.images_mut())
    }

    /// Returns the shading normal of a point, a unit vector on the side of the geometric normal.
    #[inline(always)]
    pub fn normal_at<R: Real>(
        &self,
        point: &TexturePoint<R>,
        geometric_normal: Vector<R>,
    ) -> Vector<R> {
        match &self.normal_map {
            None => point.normal,
            Some(map) => map.normal_at(point, geometric_normal),
        }
    }

    /// Returns true if it has a picture.
    pub fn has_images(&self) -> bool {
        self.images().next().is_some()
    }

    /// Returns true if it has a picture that is mapped by texture coordinates.
    pub fn needs_uvs(&self) -> bool {
        self.images().any(|(_, image)| image.mapping == Mapping::Uv)
    }

    /// Returns true if it reflects light that arrives directly from a light.
    #[inline]
    pub fn is_lit(&self) -> bool {
        let is_metal = matches!(self.kind, MaterialKind::Conductor { .. });
        let is_special = is_metal || self.kind.medium().is_some() || self.emits();
        !is_special || self.diffuse > 0.0 || self.specular > 0.0
    }
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(
    deny_unknown_fields,
    expecting = "a material such as { color: [1, 0, 0] }"
)]
#[cfg_attr(
    feature = "schema",
    schemars(
        transform = values::one_needed("color dielectric conductor emission"),
        transform = values::at_most_one("reflection dielectric conductor principled"),
        transform = values::at_most_one("opacity cutout dielectric"),
        transform = values::excluded("principled", "diffuse specular"),
    )
)]
struct MaterialKeys {
    /// The color of the diffuse reflection.
    #[serde(default)]
    color: Option<Texture>,
    /// Fraction of the scene's ambient light, 0 to 1; 0 by default for a medium, a metal or a
    /// lamp.
    #[serde(default, with = "values::Fraction")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = 1)))]
    ambient: Option<f32>,
    /// Fraction of the diffuse light, 0 to 1; 0 by default for a medium, a metal or a
    /// lamp.
    #[serde(default, with = "values::Fraction")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = 1)))]
    diffuse: Option<f32>,
    /// Strength of the highlight, 0 to 1; 0 by default.
    #[serde(default, with = "values::Fraction")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = 0)))]
    specular: Option<f32>,
    /// Exponent of the highlight, at least 0; 50 by default.
    #[serde(default, with = "values::NonNegative")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = 50)))]
    exponent: Option<f32>,
    /// Fraction of the mirrored ray's light, 0 to 1, not of a medium or a metal; 0 by default.
    #[serde(default, with = "values::Fraction")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = 0)))]
    reflection: Option<f32>,
    /// The medium inside the surface, if light enters it.
    #[serde(default)]
    dielectric: Option<Dielectric>,
    /// The metal.
    #[serde(default)]
    conductor: Option<Conductor>,
    /// The bumps and dents of the surface, if there are any.
    #[serde(default)]
    normal_map: Option<NormalMap>,
    /// The share of light that the surface meets, 0 to 1: the rest passes. 1 by default.
    #[serde(default)]
    opacity: Option<Opacity>,
    /// Holes, where a picture is transparent.
    #[serde(default)]
    cutout: Option<Cutout>,
    /// The roughness of a medium's or a metal's surface, 0 to 1; 0 by default.
    #[serde(default, with = "values::Fraction")]
    roughness: Option<f32>,
    /// Plastic, metal or glass by a few numbers, in path tracing.
    #[serde(default)]
    principled: Option<Principled>,
    /// If true, light that microscopic facets reflect onto each other counts, in path tracing; true
    /// by default.
    #[serde(default = "by_default")]
    multiple_scattering: bool,
    /// The radiance that the surface emits, the same in all directions; none by default.
    #[serde(default, with = "values::Radiance")]
    emission: Vec3,
    /// If true, both sides reflect and emit light; otherwise only the outer one, on the side of the
    /// shape's own normal. True by default.
    #[serde(default = "by_default")]
    two_sided: bool,
}

fn by_default() -> bool {
    true
}

impl TryFrom<MaterialKeys> for Material {
    type Error = &'static str;

    fn try_from(keys: MaterialKeys) -> Result<Self, Self::Error> {
        let ways = [
            keys.reflection.is_some(),
            keys.dielectric.is_some(),
            keys.conductor.is_some(),
            keys.principled.is_some(),
        ];
        if ways.into_iter().filter(|is_given| *is_given).count() > 1 {
            return Err("cannot reflect in two ways, \
                 expected exactly one of `reflection`, `dielectric`, `conductor` and `principled`");
        }
        let has_lobes = keys.diffuse.is_some() || keys.specular.is_some();
        if keys.principled.is_some() && has_lobes {
            return Err("cannot be `principled` and `diffuse` or `specular`, \
                 expected `principled` without them");
        }
        let is_fresnel = keys.dielectric.is_some() || keys.conductor.is_some();
        if keys.roughness.is_some() && !is_fresnel {
            return Err("cannot have a `roughness` of its own, \
                 expected it beside `dielectric` or `conductor` (or `specular` and `exponent`)");
        }
        let roughness = keys.roughness.unwrap_or(0.0);
        let kind = match (keys.dielectric, keys.conductor, keys.principled) {
            (Some(medium), ..) => MaterialKind::Dielectric { medium, roughness },
            (_, Some(metal), _) => MaterialKind::Conductor { metal, roughness },
            (.., Some(principled)) => principled.into(),
            _ => MaterialKind::Opaque {
                reflection: keys.reflection.unwrap_or(0.0),
            },
        };
        let opacity = match (keys.opacity, keys.cutout) {
            (Some(_), Some(_)) => {
                return Err("cannot have two opacities, expected an `opacity` or a `cutout`");
            }
            (opacity, cutout) => opacity.or(cutout.map(Opacity::from)),
        };
        if opacity.is_some() && kind.medium().is_some() {
            return Err("cannot be partly open, \
                 expected an `opacity` or a `cutout` without a medium");
        }
        let is_lamp = keys.emission != Vec3::ZERO && keys.color.is_none();
        let is_special = is_fresnel || is_lamp;
        let white = is_special.then_some(Texture::Color(Vec3::ONE));
        let by_default = if is_special { 0.0 } else { 1.0 };
        Ok(Self {
            color: keys.color.or(white).ok_or("missing field `color`")?,
            ambient: keys.ambient.unwrap_or(by_default),
            diffuse: keys.diffuse.unwrap_or(by_default),
            specular: keys.specular.unwrap_or(0.0),
            exponent: keys.exponent.unwrap_or(50.0),
            kind,
            multiple_scattering: keys.multiple_scattering,
            rough: None,
            emission: keys.emission,
            two_sided: keys.two_sided,
            normal_map: keys.normal_map,
            opacity,
            factors: FactorPictures::default(),
        })
    }
}

/// Gives all keys that the kind allows, as far as a scene file has them.
impl From<Material> for MaterialKeys {
    fn from(material: Material) -> Self {
        let (reflection, dielectric, conductor, principled) = match material.kind {
            MaterialKind::Opaque { reflection } => (Some(reflection), None, None, None),
            MaterialKind::Dielectric { medium, .. } => (None, Some(medium), None, None),
            MaterialKind::Conductor { metal, .. } => (None, None, Some(metal), None),
            MaterialKind::Principled { surface, .. } => (None, None, None, Some(surface)),
            MaterialKind::Particles(_) => (None, None, None, None),
        };
        let is_fresnel = dielectric.is_some() || conductor.is_some();
        let (opacity, cutout) = match material.opacity {
            Some(Opacity {
                image: Some(image),
                threshold: Some(threshold),
                ..
            }) => (None, Some(Cutout { image, threshold })),
            opacity => (opacity, None),
        };
        // A principled lamp without a color has no lobes, which no key could say.
        let is_plain_lamp = principled.is_some() && material.diffuse == 0.0;
        let of_lobes = |share: f32| principled.is_none().then_some(share);
        Self {
            color: (!is_plain_lamp).then_some(material.color),
            ambient: Some(material.ambient),
            diffuse: of_lobes(material.diffuse),
            specular: of_lobes(material.specular),
            exponent: Some(material.exponent),
            reflection,
            dielectric,
            conductor,
            normal_map: material.normal_map,
            opacity,
            cutout,
            roughness: is_fresnel.then(|| material.kind.roughness()),
            principled,
            multiple_scattering: material.multiple_scattering,
            emission: material.emission,
            two_sided: material.two_sided,
        }
    }
}
