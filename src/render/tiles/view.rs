//! Pixels → camera rays, and their results → pixels.

use glam::Vec3;

use super::rounds::Rounds;
use crate::film::Pixel;
use math::sampling::{Dimension, FilterSampler, Sampler};
use math::simd::{Integer, Mask, Real, Vector};
use scene::build::Sensor;
use tracer::accel::RayDevice;
use tracer::shade::{EyeMedia, PathFormulas, PathRay, SampleId, Shader};
use tracer::trace::Tracer;
use world::camera::ImagePlane;
use world::geometry::Ray;

/// Everything that rendering a pixel needs.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// Finds hits in the scene.
    pub tracer: Tracer<'a>,
    pub(crate) shader: Shader<'a>,
    /// The media in which camera rays start.
    pub(super) eye_media: EyeMedia<'a>,
    /// The samples of each pixel.
    pub rounds: Rounds,
    /// The sample at the center of the pixel.
    pub(super) middle: u32,
    /// The greatest value of a channel of a sample.
    sample_limit: f32,
    /// True if rays are counted by bounce.
    pub(super) counts_bounces: bool,
    /// The positions of the pixels.
    plane: ImagePlane,
    /// World units in a unit of render space.
    pub(super) unit: f32,
    sampler: Sampler,
    filter: FilterSampler,
    /// Columns and rows of the whole picture.
    width: u32,
    height: u32,
    /// The column and the row of the image's first pixel in the whole picture.
    origin: [u32; 2],
    /// The side of a square with the area of a pixel on the plane.
    pitch: f32,
}

impl<'a> View<'a> {
    /// Creates the view of a scene through the pixels of a sensor.
    pub fn new(tracer: Tracer<'a>, sensor: &Sensor) -> Self {
        let (image, plane, scene) = (&sensor.image, sensor.plane, tracer.scene);
        let sampler = Sampler::new(image.sampler, image.samples_per_pixel, image.seed);
        let rounds = Rounds::new(sensor);
        let [width, height] = image.picture_size();
        Self {
            tracer: tracer.with_cone(sensor.cone),
            shader: Shader::new(scene, sampler),
            eye_media: EyeMedia::new(tracer, &plane, image.filter_radius()),
            rounds,
            middle: sampler.center(),
            sample_limit: sensor.sample_limit,
            counts_bounces: sensor.extra_arrays.bounces,
            plane,
            unit: scene.space.world_length(1.0),
            sampler,
            filter: FilterSampler::new(image.filter, image.filter_radius()),
            width,
            height,
            origin: image.origin(),
            pitch: plane.pitch(),
        }
    }

    /// Returns the formulas of the paths.
    pub fn formulas(&self) -> PathFormulas<'a> {
        self.shader.formulas(self.tracer.cone())
    }

    /// Returns the device that follows the paths, if there is one.
    pub(super) fn path_device(&self) -> Option<&'a dyn RayDevice> {
        let device = self.tracer.accel.device()?;
        let follows = device.follows_paths(&self.sampler, self.tracer.cone());
        follows.then_some(device)
    }

    /// Returns the view of the whole picture through the first samples of its pixels.
    pub(super) fn of_first_samples(self) -> Self {
        Self {
            rounds: self.rounds.only_first(),
            counts_bounces: false,
            origin: [0; 2],
            ..self
        }
    }

    /// Returns columns and rows of the whole picture.
    pub(super) fn picture_size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Returns the column and the row of the image's first pixel in the whole picture.
    pub(super) fn origin(&self) -> [u32; 2] {
        self.origin
    }

    /// Returns the number of a pixel in the whole picture, row by row.
    #[inline(always)]
    pub(super) fn pixel_number(&self, x: u32, y: u32) -> u32 {
        let [left, top] = self.origin;
        (top + y) * self.width + left + x
    }

    /// Returns the camera ray of one of the pixel's samples.
    pub(crate) fn camera_ray(&self, x: u32, y: u32, sample: u32) -> Ray {
        let rays = self.camera_rays([x as f32, y as f32], self.pixel_number(x, y), sample);
        let [origin, direction] = rays.map(Vec3::from);
        Ray { origin, direction }
    }

    /// Returns the start of the path of one of the pixel's samples.
    pub(crate) fn camera_path(&self, x: u32, y: u32, sample: u32) -> PathRay {
        let id = SampleId {
            pixel: self.pixel_number(x, y),
            sample,
        };
        PathRay::from_camera(self.camera_ray(x, y, sample), &self.eye_media, id)
    }

    /// Returns the origins and the directions of the camera rays of one sample of a pixel per lane,
    /// with these columns and rows, and these numbers.
    #[inline(always)]
    pub(super) fn camera_rays<R: Real>(
        &self,
        [x, y]: [R; 2],
        pixel: R::Integer,
        sample: u32,
    ) -> [Vector<R>; 2] {
        let even = self.sampler.position::<R>(pixel, sample);
        let [dx, dy] = self.filter.position(even);
        let [x, y] = self.in_picture([x, y]);
        let rays = self.plane.rays(x + dx, y + dy);
        match self.plane.lens() {
            None => rays,
            Some(lens) => {
                let sample = pixel.splat(sample);
                let on_lens = self
                    .sampler
                    .pair(pixel, sample, pixel.splat(Dimension::LENS.0));
                lens.refracted(rays, on_lens)
            }
        }
    }

    /// Returns the footprints of pixels at these distances, without a lens, in world units; NaN at
    /// NaN.
    #[inline(always)]
    pub(super) fn footprints<R: Real>(&self, at: [R; 2], distance: R) -> R {
        let footprint = self
            .plane
            .footprints(self.pitch, self.in_picture(at), distance);
        R::select(distance.le(distance), footprint, distance) * distance.splat(self.unit)
    }

    /// Returns columns and rows in the whole picture: sums of whole numbers, exact.
    #[inline(always)]
    fn in_picture<R: Real>(&self, [x, y]: [R; 2]) -> [R; 2] {
        let [left, top] = self.origin.map(|n| n as f32);
        [x + x.splat(left), y + y.splat(top)]
    }

    /// Returns the point at which all camera rays start, if there is one.
    pub(super) fn eye(&self) -> Option<Vec3> {
        self.plane.eye()
    }

    /// Limits each channel of a sample to the greatest value of the shading model.
    #[inline(always)]
    pub fn limited<R: Real>(&self, color: Vector<R>) -> Vector<R> {
        let most = color.x.splat(self.sample_limit);
        debug_assert!(
            color.x.equals(color.x).all()
                && color.y.equals(color.y).all()
                && color.z.equals(color.z).all(),
            "a sample is not a number"
        );
        Vector {
            x: color.x.min(most),
            y: color.y.min(most),
            z: color.z.min(most),
        }
    }

    /// Divides the sum of the samples' colors by their number, and sets the footprint.
    pub(super) fn finish(&self, pixel: &mut Pixel, n_samples: u32, (x, y): (u32, u32)) {
        pixel.color /= n_samples as f32;
        let footprint = self.footprints([x as f32, y as f32], pixel.distance);
        pixel.footprint = self.footprint(pixel.position, footprint);
        pixel.distance *= self.unit;
    }

    /// Returns the footprint of a pixel that sees a position; `of_pinhole` comes from
    /// [`footprints`](Self::footprints).
    #[inline]
    pub(super) fn footprint(&self, position: Vec3, of_pinhole: f32) -> f32 {
        let behind_lens = self.plane.footprint_behind_lens(self.pitch, position);
        behind_lens.map_or(of_pinhole, |footprint| self.unit * footprint)
    }
}
