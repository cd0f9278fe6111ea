//! The `image` section.

use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer};

use super::adaptive::{Adaptive, MAX_SAMPLES};
use crate::sampling::{PixelFilter, PixelPattern};
use crate::yaml::{self, Fault, FieldPath, Number};

/// Longest side of a picture in pixels.
pub const MAX_SIDE: u32 = 65_535;

/// Size and sampling of the picture.
///
/// ```
/// # use raycost::config::Image;
/// let image: Image = raycost::yaml::from_str("
/// { width: 640, height: 480, samples_per_pixel: 4, seed: 7, sampler: sobol }
/// ").unwrap();
/// # assert_eq!(image.samples_per_pixel, 4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a size such as { width: 400, height: 300 }"
)]
pub struct Image {
    /// Columns, 1 to 65,535.
    #[serde(deserialize_with = "yaml::count::<_, MAX_SIDE>")]
    pub width: u32,
    /// Rows, 1 to 65,535.
    #[serde(deserialize_with = "yaml::count::<_, MAX_SIDE>")]
    pub height: u32,
    /// Camera rays through each pixel, 1 to 65,536; 1 if not given.
    #[serde(deserialize_with = "yaml::count::<_, MAX_SAMPLES>", default = "one")]
    pub samples_per_pixel: u32,
    /// Seed of the sampling pattern; 0 if not given.
    #[serde(deserialize_with = "yaml::seed", default)]
    pub seed: u64,
    /// The pattern of the samples in a pixel; `stratified` if not given.
    #[serde(default)]
    pub sampler: PixelPattern,
    /// The pixel filter; `box` if not given.
    #[serde(default)]
    pub filter: PixelFilter,
    /// The radius of the filter in pixels, from 0.1 to 10; the filter's usual one if not
    /// given.
    #[serde(deserialize_with = "filter_radius", default)]
    pub filter_radius: Option<f32>,
    /// Adaptive sampling, which needs [`PixelPattern::Sobol`]: then `samples_per_pixel`
    /// is the most that a pixel gets.
    #[serde(default)]
    pub adaptive: Option<Adaptive>,
}

impl Image {
    /// The number of pixels.
    pub fn n_pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The number of camera rays of the picture; the most if sampling is adaptive.
    pub fn n_camera_rays(&self) -> u64 {
        self.n_pixels() as u64 * u64::from(self.samples_per_pixel)
    }

    /// The number of samples per pixel, for people: "64 samples", "16 to 64 samples".
    pub fn samples(&self) -> String {
        Adaptive::samples(self.adaptive, self.samples_per_pixel)
    }

    /// The samples of every pixel; 0 if sampling is adaptive.
    pub fn uniform_samples(&self) -> u32 {
        match self.adaptive {
            None => self.samples_per_pixel,
            Some(_) => 0,
        }
    }

    /// Checks that the settings of samples fit together.
    ///
    /// # Errors
    /// The key that does not.
    pub fn check_sampling(&self) -> Result<(), Fault> {
        if self.adaptive.is_none() || self.sampler == PixelPattern::Sobol {
            return Ok(());
        }
        let message = "`adaptive` needs samples whose first ones are evenly spread";
        let image = FieldPath::default().key("image");
        Err(
            Fault::of_key(image.key("adaptive"), message, "requires `sampler: sobol`")
                .with_help("add `sampler: sobol` to `image`"),
        )
    }

    /// The radius of the filter in pixels.
    pub fn filter_radius(&self) -> f32 {
        self.filter_radius.unwrap_or(self.filter.usual_radius())
    }
}

fn filter_radius<'de, D: Deserializer<'de>>(d: D) -> Result<Option<f32>, D::Error> {
    let number = Number {
        expected: "a radius in pixels from 0.1 to 10",
        accepts: |radius| (0.1..=10.0).contains(&radius),
    };
    number.deserialize(d).map(Some)
}

fn one() -> u32 {
    1
}
