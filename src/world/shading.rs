//! The `shading` section.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::color::Transfer;
use crate::geometry::RenderSpace;
use crate::values;
use base::keywords;
use math::optics::Masking;

/// The shading model and its parameters.
///
/// ```
/// # use scene::config::Shading;
/// let shading: Shading = scene::yaml::from_str("
/// { model: blinn_phong, ambient: 0.1, max_depth: 4 }
/// ").unwrap();
/// # assert_eq!(shading.max_depth, 4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(try_from = "ShadingKeys", into = "ShadingKeys")]
pub struct Shading {
    /// The shading model.
    pub model: ShadingModel,
    /// The ambient light, a color or a gray; 0.05 if not given, none but in `blinn_phong` and `seed`.
    pub ambient: Vec3,
    /// Maximum number of bounces along a path, 0 to 255; 8 if not given.
    pub max_depth: u8,
    /// The lights that are sampled at each point; `each`, and `power` in path tracing, by default.
    pub light_sampling: LightSampling,
    /// The masking-shadowing function of rough surfaces in path tracing; `height_correlated` if not
    /// given.
    pub masking: Masking,
    /// Length of the rays of ambient occlusion in world units; infinite if not given.
    pub occlusion_distance: f32,
    /// If true, objects cast shadows.
    pub shadows: bool,
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[serde(deny_unknown_fields, expecting = "a mapping with keys such as `model`")]
struct ShadingKeys {
    /// The shading model.
    #[serde(default)]
    model: ShadingModel,
    /// The ambient light of `blinn_phong` and `seed`; 0.05 if not given.
    #[serde(default, with = "values::Radiance")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = Shading::default().ambient.x)))]
    ambient: Option<Vec3>,
    /// Maximum number of bounces along a path, 0 to 255; 8 if not given.
    #[serde(default = "default_depth", with = "values::Byte")]
    max_depth: u8,
    /// The lights that are sampled at each point; `each`, and `power` in path tracing, by default.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(extend("default" = Shading::default().light_sampling)))]
    light_sampling: Option<LightSampling>,
    /// The masking-shadowing function of rough surfaces in path tracing; `height_correlated` if not
    /// given.
    #[serde(default)]
    masking: Option<Masking>,
    /// Length of the rays of ambient occlusion in world units; infinite if not given.
    #[serde(default, with = "values::Positive")]
    occlusion_distance: Option<f32>,
    /// If true, objects cast shadows, in `blinn_phong`.
    #[serde(default)]
    #[cfg_attr(feature = "schema", schemars(extend("default" = Shading::default().shadows)))]
    shadows: Option<bool>,
}

impl TryFrom<ShadingKeys> for Shading {
    type Error = &'static str;

    fn try_from(keys: ShadingKeys) -> Result<Self, Self::Error> {
        let light_sampling = keys.light_sampling.unwrap_or(keys.model.light_sampling());
        let is = |model| keys.model == model;
        if !keys.model.has_ambient() && keys.ambient.is_some() {
            return Err(
                "cannot have ambient light in this model, expected no `ambient`; \
                 in path tracing a `background` lights surfaces",
            );
        }
        if !keys.model.chooses_lights() && keys.light_sampling.is_some() {
            return Err("cannot choose lights in this model, expected no `light_sampling`");
        }
        if !is(ShadingModel::Path) && keys.masking.is_some() {
            return Err("cannot choose the `masking` of facets in this model, \
                 expected `model: path` beside it");
        }
        if !is(ShadingModel::AmbientOcclusion) && keys.occlusion_distance.is_some() {
            return Err("cannot have an `occlusion_distance` in this model, \
                 expected `model: ambient_occlusion` beside it");
        }
        if !is(ShadingModel::BlinnPhong) && keys.shadows.is_some() {
            return Err("cannot choose whether there are `shadows` in this model, \
                 expected `model: blinn_phong` beside it");
        }
        Ok(Self {
            model: keys.model,
            ambient: keys.ambient.unwrap_or(keys.model.ambient()),
            max_depth: keys.max_depth,
            light_sampling,
            masking: keys.masking.unwrap_or_default(),
            occlusion_distance: keys.occlusion_distance.unwrap_or(f32::INFINITY),
            shadows: keys.shadows.unwrap_or(true),
        })
    }
}

/// Gives all keys that the model allows.
impl From<Shading> for ShadingKeys {
    fn from(shading: Shading) -> Self {
        let model = shading.model;
        let is = |other| model == other;
        let distance = Some(shading.occlusion_distance).filter(|length| length.is_finite());
        Self {
            model,
            ambient: model.has_ambient().then_some(shading.ambient),
            max_depth: shading.max_depth,
            light_sampling: model.chooses_lights().then_some(shading.light_sampling),
            masking: is(ShadingModel::Path).then_some(shading.masking),
            occlusion_distance: distance,
            shadows: is(ShadingModel::BlinnPhong).then_some(shading.shadows),
        }
    }
}

keywords! {
    /// The lights toward which shadow rays are traced from a point.
    pub enum LightSampling {
        /// Every light, with one ray each.
        Each = "each",
        /// One light, by the light that would arrive unblocked; of more than 16 lights, by power.
        Power = "power",
    }
}

keywords! {
    /// A shading model.
    #[derive(Default)]
    pub enum ShadingModel {
        /// Shadows and Whitted's recursive reflection.
        #[default]
        BlinnPhong = "blinn_phong",
        /// The course's program.
        Seed = "seed",
        /// The unoccluded fraction of the space around each point.
        AmbientOcclusion = "ambient_occlusion",
        /// All light that surfaces scatter to each other.
        Path = "path",
    }
}

impl ShadingModel {
    /// Returns true if the scene may choose the ambient light.
    fn has_ambient(self) -> bool {
        matches!(self, Self::BlinnPhong | Self::Seed)
    }

    /// Returns true if the scene may choose the lights that are sampled.
    fn chooses_lights(self) -> bool {
        matches!(self, Self::BlinnPhong | Self::Path)
    }

    /// Returns the default ambient light.
    fn ambient(self) -> Vec3 {
        match self {
            Self::BlinnPhong | Self::Seed => Vec3::splat(0.05),
            Self::AmbientOcclusion | Self::Path => Vec3::ZERO,
        }
    }

    /// Returns the default light sampling.
    fn light_sampling(self) -> LightSampling {
        match self {
            Self::BlinnPhong | Self::Seed | Self::AmbientOcclusion => LightSampling::Each,
            Self::Path => LightSampling::Power,
        }
    }

    /// Returns the default transfer function of pictures: linear for `seed`, as in its pictures.
    pub fn transfer(self) -> Transfer {
        match self {
            Self::BlinnPhong | Self::AmbientOcclusion | Self::Path => Transfer::Srgb,
            Self::Seed => Transfer::Linear,
        }
    }

    /// Returns the default limit of a sample's channels, applied before the mean is taken: 1e30, so
    /// that sums of samples stay finite, but 1 for `seed`.
    pub fn sample_limit(self) -> f32 {
        match self {
            Self::BlinnPhong | Self::AmbientOcclusion | Self::Path => 1e30,
            Self::Seed => 1.0,
        }
    }
}

fn default_depth() -> u8 {
    8
}

impl Shading {
    /// Converts the settings' lengths from world space to render space.
    pub fn in_space(self, space: &RenderSpace) -> Self {
        Self {
            occlusion_distance: space.length(self.occlusion_distance),
            ..self
        }
    }
}

impl Default for Shading {
    fn default() -> Self {
        let model = ShadingModel::default();
        Self {
            model,
            ambient: model.ambient(),
            max_depth: default_depth(),
            light_sampling: model.light_sampling(),
            masking: Masking::default(),
            occlusion_distance: f32::INFINITY,
            shadows: true,
        }
    }
}
