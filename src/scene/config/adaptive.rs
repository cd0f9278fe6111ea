//! The key `adaptive` of the `image` section.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use base::numbers::counted;
use world::kinds;
use world::values::{self, Number};

/// Maximum number of camera rays through a pixel.
pub const MAX_SAMPLES: u32 = 65_536;

/// Adaptive sampling: a pixel gets more samples while it is noisy.
///
/// ```
/// # use raycost_scene::config::Adaptive;
/// let adaptive: Adaptive = raycost_scene::yaml::from_str("
/// { noise: 0.01, min_samples: 16 }
/// ").unwrap();
/// # assert_eq!(adaptive.min_samples, 16);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(deny_unknown_fields, expecting = "a limit such as { noise: 0.01 }")]
pub struct Adaptive {
    /// The standard error of a pixel's channels below which it gets no more samples, as a
    /// share of white in a picture with a gamma of 2, from 0.0001 to 1.
    #[serde(with = "Noise")]
    pub noise: f32,
    /// Samples that each pixel gets, at least 2 and at most the image's samples per pixel;
    /// 16 if not given.
    #[serde(with = "values::Between::<2, MAX_SAMPLES>", default = "sixteen")]
    pub min_samples: u32,
}

impl Adaptive {
    /// The least and the greatest standard error.
    pub const NOISE: [f64; 2] = [1e-4, 1.0];

    /// Formats the number of samples per pixel, at most `most`, for people.
    pub fn samples(this: Option<Self>, most: u32) -> String {
        let text = counted(most.into(), "sample");
        match this {
            Some(Self { min_samples, .. }) if min_samples < most => {
                format!("{min_samples} to {text}")
            }
            _ => text,
        }
    }
}

kinds! {
    Noise: f32 = Number { expected: "a standard error from 0.0001 to 1", ranges: &[Adaptive::NOISE] };
}

pub(super) fn sixteen() -> u32 {
    16
}
