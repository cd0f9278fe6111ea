//! Rendered pixels that are to be written to the film.

use glam::Vec3;

use tracer::cost::{Counters, RaysByBounce};
use tracer::trace::SurfacePoint;
use world::scene::InstanceId;

/// Pixels of a tile and their cost, row by row.
#[derive(Debug, Clone, Copy)]
pub struct Rendered<'a> {
    /// The colors and the surfaces of the pixels.
    pub pixels: &'a PixelColumns,
    /// The counters of the pixels, if they were counted.
    pub counters: Option<&'a Counters>,
    /// The rays of the pixels by bounce; empty unless the film keeps them.
    pub bounces: &'a [RaysByBounce],
    /// The times of the pixels in nanoseconds; empty if they were not measured.
    pub time_ns: &'a [f32],
    /// Time spent on discarded renderings of pixels, in nanoseconds.
    pub warm_up_ns: f64,
}

/// The color and the surface of one pixel.
#[derive(Debug, Clone, Copy)]
pub struct Pixel {
    /// The mean radiance of the samples: linear and not clamped.
    pub color: Vec3,
    /// The standard error of the color, as the root of the mean over the channels; NaN with less
    /// than two samples, or if it is not measured.
    pub noise: f32,
    /// The point that the camera ray of the center sample hit, in render space; NaN without a hit.
    pub position: Vec3,
    /// The shading normal at the point; NaN without a hit.
    pub normal: Vec3,
    /// The color of the surface at the point; black without a hit.
    pub albedo: Vec3,
    /// Distance along the ray, in world units; NaN without a hit.
    pub distance: f32,
    /// Size of the pixel at this distance, in world units; NaN without a hit.
    pub footprint: f32,
    /// Index of the object that was hit; -1 without a hit.
    pub object: i32,
    /// Index of its material; -1 without a hit.
    pub material: i32,
    /// Index of the instance that was hit; -1 for none.
    pub instance: i32,
}

/// A black pixel without a hit.
impl Default for Pixel {
    fn default() -> Self {
        Self {
            color: Vec3::ZERO,
            noise: f32::NAN,
            position: Vec3::NAN,
            normal: Vec3::NAN,
            albedo: Vec3::ZERO,
            distance: f32::NAN,
            footprint: f32::NAN,
            object: -1,
            material: -1,
            instance: -1,
        }
    }
}

impl Pixel {
    /// Sets the instance that the camera ray of the center sample hit.
    #[inline]
    pub fn set_instance(&mut self, instance: Option<InstanceId>) {
        self.instance = instance.map_or(-1, |id| id.0 as i32);
    }

    /// Sets the fields of the surface that the camera ray of the center sample hit.
    #[inline]
    pub fn set_surface(&mut self, point: &SurfacePoint) {
        self.position = point.position;
        self.normal = point.normal;
        self.albedo = point.color;
        self.distance = point.distance;
        self.object = point.object.0 as i32;
        self.material = point.material.0 as i32;
        self.set_instance(point.instance);
    }
}

/// The colors and the surfaces of pixels as a structure of arrays, as in a strip of the film: rows
/// of pixels are copied, not converted.
#[derive(Debug, Clone, Default)]
#[expect(missing_docs, reason = "`Pixel` documents each array")]
pub struct PixelColumns {
    pub color: Vec<Vec3>,
    pub noise: Vec<f32>,
    pub position: Vec<Vec3>,
    pub normal: Vec<Vec3>,
    pub albedo: Vec<Vec3>,
    pub distance: Vec<f32>,
    pub footprint: Vec<f32>,
    pub object: Vec<i32>,
    pub material: Vec<i32>,
    pub instance: Vec<i32>,
}

impl PixelColumns {
    /// Returns black pixels without a hit.
    pub fn none(n: usize) -> Self {
        let mut pixels = Self::default();
        pixels.resize(n);
        pixels
    }

    /// Keeps the first `n` pixels; new ones are black without a hit.
    pub fn resize(&mut self, n: usize) {
        let new = Pixel::default();
        self.color.resize(n, new.color);
        self.noise.resize(n, new.noise);
        self.position.resize(n, new.position);
        self.normal.resize(n, new.normal);
        self.albedo.resize(n, new.albedo);
        self.distance.resize(n, new.distance);
        self.footprint.resize(n, new.footprint);
        self.object.resize(n, new.object);
        self.material.resize(n, new.material);
        self.instance.resize(n, new.instance);
    }

    /// Overwrites pixel `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, pixel: &Pixel) {
        self.color[i] = pixel.color;
        self.noise[i] = pixel.noise;
        self.position[i] = pixel.position;
        self.normal[i] = pixel.normal;
        self.albedo[i] = pixel.albedo;
        self.distance[i] = pixel.distance;
        self.footprint[i] = pixel.footprint;
        self.object[i] = pixel.object;
        self.material[i] = pixel.material;
        self.instance[i] = pixel.instance;
    }
}
