//! Pixels → camera rays, and their results → pixels.

use glam::Vec3;

use crate::accel::Accel;
use crate::camera::ImagePlane;
use crate::config::Image;
use crate::film::Pixel;
use crate::geometry::Ray;
use crate::sampling::PixelPattern;
use crate::scene::Scene;
use crate::shade::Shader;
use crate::trace::Tracer;

/// Everything that rendering a pixel needs.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    pub(crate) tracer: Tracer<'a>,
    pub(crate) shader: Shader<'a>,
    /// Samples per pixel.
    pub(crate) n_samples: u32,
    /// The sample at the center of the pixel.
    pub(super) middle: u32,
    /// The positions of the pixels in world space.
    plane: ImagePlane,
    pattern: PixelPattern,
    width: u32,
}

impl<'a> View<'a> {
    pub(crate) fn new(scene: &'a Scene, accel: &'a Accel<'a>, image: &Image) -> Self {
        let pattern = PixelPattern::new(image.samples_per_pixel, image.seed);
        Self {
            tracer: Tracer::new(scene, accel),
            shader: Shader::new(scene),
            n_samples: image.samples_per_pixel,
            middle: pattern.center(),
            plane: scene.image_plane,
            pattern,
            width: image.width,
        }
    }

    /// Replaces the image plane.
    pub(crate) fn through(self, plane: ImagePlane) -> Self {
        Self { plane, ..self }
    }

    /// Returns the camera ray of one of the pixel's samples.
    pub(crate) fn camera_ray(&self, (x, y): (u32, u32), sample: u32) -> Ray {
        let pixel = u64::from(y) * u64::from(self.width) + u64::from(x);
        let offset = self.pattern.point(pixel, sample);
        self.plane.ray(x as f32 + offset.x, y as f32 + offset.y)
    }

    /// Divides the sum of the samples' colors by their number, and sets the
    /// footprint.
    pub(super) fn finish(&self, pixel: &mut Pixel, (x, y): (u32, u32)) {
        let footprint_at = |distance| self.plane.footprint(x as f32, y as f32, distance);
        pixel.color /= self.n_samples as f32;
        pixel.footprint = pixel
            .surface
            .map_or(f32::NAN, |point| footprint_at(point.distance));
    }
}

/// Limits a sample to 1 in each channel. Samples are limited before they are
/// averaged, so that bright edges stay antialiased.
pub(super) fn limited(color: Vec3) -> Vec3 {
    color.min(Vec3::ONE)
}
