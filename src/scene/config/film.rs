//! The `film` section.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use world::color::{Development, ToneCurve, Transfer};
use world::kinds;
use world::shading::ShadingModel;
use world::values::{self, Number};

/// The conversion of a pixel's light to the numbers of the picture.
///
/// ```
/// # use raycost_scene::config::FilmSettings;
/// # use world::color::ToneCurve;
/// let film: FilmSettings = raycost_scene::yaml::from_str("
/// { exposure: 1.5, tone_curve: agx, bits: 16 }
/// ").unwrap();
/// # assert_eq!((film.exposure, film.tone_curve, film.bits), (1.5, ToneCurve::Agx, 16));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(
    deny_unknown_fields,
    default,
    expecting = "a film such as { exposure: 1, tone_curve: agx }"
)]
pub struct FilmSettings {
    /// Stops, each of which doubles the light; 0 if not given.
    #[serde(with = "Stops")]
    pub exposure: f32,
    /// The tone curve; none if not given.
    pub tone_curve: ToneCurve,
    /// The transfer function; `srgb`, and `linear` for the shading model `seed`, by default.
    pub transfer: Option<Transfer>,
    /// Bits per channel of `image.png`, 8 or 16; 8 if not given.
    #[serde(with = "Bits")]
    pub bits: u8,
    /// The greatest value of a channel of a sample, greater than 0, which removes single bright
    /// pixels and some light; none, and 1 for the shading model `seed`, by default.
    #[serde(with = "values::Positive")]
    pub sample_limit: Option<f32>,
}

impl FilmSettings {
    /// The permitted exposures in stops.
    pub const STOPS: [f64; 2] = [-32.0, 32.0];

    /// Returns the conversion of light to numbers with this shading model.
    pub fn development(&self, model: ShadingModel) -> Development {
        Development::new(self.exposure, self.tone_curve, self.transfer(model))
    }

    /// Returns the greatest value of a channel of a sample with this shading model.
    pub fn sample_limit(&self, model: ShadingModel) -> f32 {
        self.sample_limit.unwrap_or(model.sample_limit())
    }

    /// Returns the transfer function with this shading model.
    pub fn transfer(&self, model: ShadingModel) -> Transfer {
        self.transfer.unwrap_or(model.transfer())
    }
}

kinds! {
    Stops: f32 = Number { expected: "a number of stops from -32 to 32", ranges: &[FilmSettings::STOPS] };
    Bits: u8 = Number { expected: "8 or 16", ranges: &[[8.0, 8.0], [16.0, 16.0]] } => |bits| bits as u8;
}

impl Default for FilmSettings {
    fn default() -> Self {
        Self {
            exposure: 0.0,
            tone_curve: ToneCurve::default(),
            transfer: None,
            bits: 8,
            sample_limit: None,
        }
    }
}
