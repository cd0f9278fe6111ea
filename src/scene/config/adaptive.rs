//! The key `adaptive` of the `image` section.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::yaml::{Fault, FieldPath};
use base::keywords;
use base::numbers::counted;
use world::kinds;
use world::values::{self, Number};

/// Maximum number of camera rays through a pixel.
pub const MAX_SAMPLES: u32 = 65_536;

keywords! {
    /// A rule that gives pixels their numbers of samples.
    #[derive(Default)]
    pub enum SampleRule {
        /// While the standard error is above `noise`
        #[default]
        Noise = "noise",
        /// By the root of variance over cost of the pixel's neighbors
        Efficiency = "efficiency",
    }
}

/// Adaptive sampling: noisy pixels get more samples than others.
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
    /// The rule by which pixels get samples; `noise` if not given.
    #[serde(default, skip_serializing_if = "SampleRule::is_default")]
    pub by: SampleRule,
    /// With `by: noise`, the standard error of a channel below which a pixel gets no more samples,
    /// as a share of white in a picture with a gamma of 2, from 0.0001 to 1.
    #[serde(with = "Noise", default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<f32>,
    /// Samples that each pixel gets, at most the image's samples per pixel; 16 if not given.
    #[serde(with = "values::Between::<2, MAX_SAMPLES>", default = "sixteen")]
    pub min_samples: u32,
}

impl SampleRule {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

impl Adaptive {
    /// The least and the greatest standard error.
    pub const NOISE: [f64; 2] = [1e-4, 1.0];

    /// Creates a limit of the standard error, with 16 samples or more.
    pub fn by_noise(noise: f32) -> Self {
        Self {
            by: SampleRule::Noise,
            noise: Some(noise),
            min_samples: sixteen(),
        }
    }

    /// Formats the number of samples per pixel of an image with `n` of them, for people.
    pub fn samples(this: Option<Self>, n: u32) -> String {
        let text = counted(n.into(), "sample");
        match this {
            Some(Self {
                by: SampleRule::Efficiency,
                min_samples,
                ..
            }) => format!("{min_samples} or more, on average about {text}"),
            Some(Self { min_samples, .. }) if min_samples < n => {
                format!("{min_samples} to {text}")
            }
            _ => text,
        }
    }

    /// Checks that the keys fit together, and the image's samples per pixel.
    ///
    /// # Errors
    /// The first key that does not fit; `path` is the section's.
    pub(super) fn check(&self, path: FieldPath, n_samples: u32) -> Result<(), Fault> {
        let Self {
            by,
            noise,
            min_samples,
        } = *self;
        match (by, noise) {
            (SampleRule::Noise, None) => {
                let message = "`adaptive` lacks `noise`";
                let help = "add a limit such as `noise: 0.01`, or `by: efficiency`";
                Err(Fault::at_key(path, message, "requires `noise`").with_help(help))
            }
            (SampleRule::Efficiency, Some(_)) => {
                let message = "`by: efficiency` has no limit of noise";
                let help = "remove `noise` or `by`: `samples_per_pixel` is the mean of all pixels";
                let fault = Fault::at_key(path.key("noise"), message, "expected no `noise`");
                Err(fault.with_help(help))
            }
            (SampleRule::Efficiency, None) if n_samples <= min_samples => {
                let message = format!(
                    "`by: efficiency` has no samples to distribute: all pixels get {min_samples}"
                );
                let expected = "requires more `samples_per_pixel` than `min_samples`";
                let help = "raise `samples_per_pixel` (`--spp`), or lower `min_samples`";
                Err(Fault::at_key(path, message, expected).with_help(help))
            }
            _ => Ok(()),
        }
    }
}

kinds! {
    Noise: f32 = Number { expected: "a standard error from 0.0001 to 1", ranges: &[Adaptive::NOISE] };
}

pub(super) fn sixteen() -> u32 {
    16
}
