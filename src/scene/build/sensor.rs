//! The camera, the sampler and the film settings of an image.

use crate::config::{Config, ExtraArrays, FilmSettings, Image};
use world::camera::{Camera, ImagePlane, RayCone};
use world::color::Development;
use world::scene::Scene;

/// Camera, sampler and film of a picture, as in Mitsuba: where its pixels are, and how their light
/// is kept.
#[derive(Debug, Clone, Copy)]
pub struct Sensor {
    /// The size, the window and the samples of the picture.
    pub image: Image,
    /// The positions of the pixels of the whole picture, in render space.
    pub plane: ImagePlane,
    /// The footprint of a camera ray as a cone, if a material has a picture.
    pub cone: Option<RayCone>,
    /// The conversion of light to the numbers of the picture.
    pub development: Development,
    /// The greatest value of a channel of a sample.
    pub sample_limit: f32,
    /// The arrays of the film beyond what every film keeps.
    pub extra_arrays: ExtraArrays,
    /// The samples of a pixel per root of its neighbors' variance over cost, if efficiency decides
    /// and they have been planned.
    pub samples_per_root: Option<f64>,
}

impl Sensor {
    /// Creates the sensor of a scene's config.
    pub fn new(scene: &Scene, config: &Config) -> Self {
        Self::with_image(scene, config, config.image)
    }

    /// Creates the sensor of a scene's config for another image.
    pub fn with_image(scene: &Scene, config: &Config, image: Image) -> Self {
        let model = scene.shading.model;
        Self {
            development: config.film.development(model),
            sample_limit: config.film.sample_limit(model),
            extra_arrays: config.extra_arrays(),
            ..Self::from_camera(scene, &config.camera, image)
        }
    }

    /// Creates the sensor of a camera in a scene, with the default film.
    pub fn from_camera(scene: &Scene, camera: &Camera, image: Image) -> Self {
        let plane = camera.image_plane(image.picture_size(), &scene.space);
        let cone = || plane.ray_cone(image.samples_per_pixel);
        let (model, film) = (scene.shading.model, FilmSettings::default());
        Self {
            image,
            plane,
            cone: scene.has_images.then(cone),
            development: film.development(model),
            sample_limit: film.sample_limit(model),
            extra_arrays: ExtraArrays::default(),
            samples_per_root: None,
        }
    }
}
