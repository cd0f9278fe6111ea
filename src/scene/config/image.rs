//! The `image` section.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::adaptive::{Adaptive, MAX_SAMPLES};
use crate::yaml::{Fault, FieldPath};
use math::sampling::{PixelFilter, PixelPattern};
use world::kinds;
use world::values::{self, Number};

/// Longest side of a picture in pixels.
pub const MAX_SIDE: u32 = 65_535;

/// Size and sampling of the picture.
///
/// ```
/// # use raycost_scene::config::Image;
/// let image: Image = raycost_scene::yaml::from_str("
/// { width: 640, height: 480, samples_per_pixel: 4, seed: 7, sampler: sobol }
/// ").unwrap();
/// # assert_eq!(image.samples_per_pixel, 4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(
    deny_unknown_fields,
    expecting = "a size such as { width: 400, height: 300 }"
)]
pub struct Image {
    /// Columns.
    #[serde(with = "values::Count::<MAX_SIDE>")]
    pub width: u32,
    /// Rows.
    #[serde(with = "values::Count::<MAX_SIDE>")]
    pub height: u32,
    /// Camera rays through each pixel.
    #[serde(with = "values::Count::<MAX_SAMPLES>", default = "values::one")]
    pub samples_per_pixel: u32,
    /// Seed of the sampling pattern; 0 if not given.
    #[serde(with = "values::Unsigned", default)]
    pub seed: u64,
    /// The pattern of the samples in a pixel; `stratified` if not given.
    #[serde(default)]
    pub sampler: PixelPattern,
    /// The pixel filter; `box` if not given.
    #[serde(default)]
    pub filter: PixelFilter,
    /// The radius of the filter in pixels, from 0.1 to 10; the filter's usual one if not
    /// given.
    #[serde(with = "FilterRadius", default)]
    pub filter_radius: Option<f32>,
    /// Adaptive sampling, which needs `sampler: sobol`: then `samples_per_pixel` is the maximum per
    /// pixel, or by efficiency the mean.
    #[serde(default)]
    pub adaptive: Option<Adaptive>,
    /// The position in a larger picture, for a window of one.
    #[serde(skip)]
    pub window: Option<PictureWindow>,
}

/// The position of a window in a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct PictureWindow {
    /// The column and the row of the window's first pixel in the picture.
    pub origin: [u32; 2],
    /// Columns and rows of the picture.
    pub picture: [u32; 2],
}

impl Image {
    /// Creates an image of `width` times `height` pixels with the defaults of a scene file; sides are
    /// from 1 to 65,535.
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            samples_per_pixel: 1,
            seed: 0,
            sampler: PixelPattern::default(),
            filter: PixelFilter::default(),
            filter_radius: None,
            adaptive: None,
            window: None,
        }
    }

    /// Returns columns and rows of the whole picture.
    pub fn picture_size(&self) -> [u32; 2] {
        let size = [self.width, self.height];
        self.window.map_or(size, |window| window.picture)
    }

    /// Returns the column and the row of the first pixel in the whole picture.
    pub fn origin(&self) -> [u32; 2] {
        self.window.map_or([0; 2], |window| window.origin)
    }

    /// Returns only this window, given by its first column and row, its width and its height;
    /// `None` if it is empty or extends beyond the image.
    pub fn cropped(&self, [x, y, width, height]: [u32; 4]) -> Option<Self> {
        let fits = |first: u32, n: u32, all: u32| n > 0 && first <= all && n <= all - first;
        let [left, top] = self.origin();
        let window = PictureWindow {
            origin: [left + x, top + y],
            picture: self.picture_size(),
        };
        (fits(x, width, self.width) && fits(y, height, self.height)).then_some(Self {
            width,
            height,
            window: Some(window),
            ..*self
        })
    }

    /// Returns an image with the sides that `shrink` returns, and one sample per pixel.
    pub fn shrunk(&self, shrink: impl Fn(u32) -> u32) -> Self {
        let [width, height] = [self.width, self.height].map(&shrink);
        let window = self.window.map(|window| {
            let picture = window.picture.map(&shrink);
            let [left, top] = window.origin.map(&shrink);
            let origin = [
                left.min(picture[0].saturating_sub(width)),
                top.min(picture[1].saturating_sub(height)),
            ];
            PictureWindow { origin, picture }
        });
        Self {
            width,
            height,
            window,
            samples_per_pixel: 1,
            adaptive: None,
            ..*self
        }
    }

    /// Samples each pixel until its standard error is below this share of white, from 0.0001 to 1.
    pub fn sample_until(&mut self, noise: f32) {
        let by_noise = Adaptive::by_noise(noise);
        self.adaptive = Some(Adaptive {
            min_samples: self
                .adaptive
                .map_or(by_noise.min_samples, |adaptive| adaptive.min_samples),
            ..by_noise
        });
        self.sampler = PixelPattern::Sobol;
    }

    /// Returns the number of pixels.
    pub fn n_pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Returns the number of camera rays of the picture: the maximum if noise decides, about the
    /// number if efficiency does.
    pub fn n_camera_rays(&self) -> u64 {
        self.n_pixels() as u64 * u64::from(self.samples_per_pixel)
    }

    /// Formats the number of samples per pixel, for people: "64 samples", "16 to 64 samples".
    pub fn samples(&self) -> String {
        Adaptive::samples(self.adaptive, self.samples_per_pixel)
    }

    /// Returns the samples of every pixel; 0 if sampling is adaptive.
    pub fn uniform_samples(&self) -> u32 {
        match self.adaptive {
            None => self.samples_per_pixel,
            Some(_) => 0,
        }
    }

    /// Checks that the sampling settings fit together.
    ///
    /// # Errors
    /// The first key that does not fit.
    pub fn check_sampling(&self) -> Result<(), Fault> {
        let Some(adaptive) = self.adaptive else {
            return Ok(());
        };
        let path = FieldPath::default().key("image").key("adaptive");
        if self.sampler == PixelPattern::Sobol {
            return adaptive.check(path, self.samples_per_pixel);
        }
        let message = "`adaptive` needs samples whose first ones are evenly spread";
        Err(Fault::at_key(path, message, "requires `sampler: sobol`")
            .with_help("add `sampler: sobol` to `image`"))
    }

    /// Returns the radius of the filter in pixels.
    pub fn filter_radius(&self) -> f32 {
        self.filter_radius.unwrap_or(self.filter.usual_radius())
    }
}

kinds! {
    FilterRadius: f32 = Number { expected: "a radius in pixels from 0.1 to 10", ranges: &[[0.1, 10.0]] };
}
