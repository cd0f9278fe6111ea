//! The rays of a tile that are traced together.
//!
//! Structures of arrays: the values that the ray kernel reads are contiguous.

use crate::accel::ShadowRay;
use crate::cost::{ByPixel, PixelProbe, RayKind};
use crate::geometry::Ray;
use crate::light::Illumination;
use crate::shade::{Path, Shader};
use crate::trace::{SurfacePoint, Tracer};

/// Rays of one kind; each has one entry in every array.
#[derive(Default)]
pub(super) struct Wave {
    pub(super) rays: Vec<Ray>,
    /// The pixel of each ray, as its index in the tile.
    pub(super) pixels: Vec<u32>,
    /// The path that ends with each ray.
    pub(super) paths: Vec<Path>,
    /// The index of the path's color.
    pub(super) slots: Vec<u32>,
}

impl Wave {
    pub(super) fn push(&mut self, ray: Ray, pixel: u32, path: Path, slot: u32) {
        self.rays.push(ray);
        self.pixels.push(pixel);
        self.paths.push(path);
        self.slots.push(slot);
    }

    pub(super) fn clear(&mut self) {
        self.rays.clear();
        self.pixels.clear();
        self.paths.clear();
        self.slots.clear();
    }
}

/// The shadow rays of a wave's points, point by point.
#[derive(Default)]
pub(super) struct Shadows {
    rays: Vec<ShadowRay>,
    /// The illumination along each ray unless it is occluded.
    lights: Vec<Illumination<f32>>,
    /// The pixel of each ray, as its index in the tile.
    pixels: Vec<u32>,
    occluded: Vec<bool>,
    /// For each ray of the wave the end of its shadow rays in `rays`.
    ends: Vec<usize>,
}

impl Shadows {
    /// Collects and counts the shadow rays of all points that the rays of a wave
    /// hit; `pixels` are the pixels of these rays.
    pub(super) fn gather<P: PixelProbe>(
        &mut self,
        shader: &Shader,
        met: &[Option<SurfacePoint>],
        pixels: &[u32],
        probe: &mut P,
    ) {
        self.clear();
        for (met, &pixel) in met.iter().zip(pixels) {
            if let Some(point) = met {
                let first = self.rays.len();
                for sample in shader.light_samples(point) {
                    self.rays.push(sample.shadow);
                    self.lights.push(sample.light);
                    self.pixels.push(pixel);
                }
                let n_rays = self.rays.len() - first;
                probe.rays(RayKind::Shadow, pixel as usize, n_rays);
            }
            self.ends.push(self.rays.len());
        }
    }

    /// Traces the shadow rays.
    pub(super) fn trace<P: PixelProbe>(&mut self, tracer: &Tracer, probe: &mut P) {
        let probes = ByPixel::new(probe, &self.pixels);
        tracer.shadow_stream(&self.rays, &mut self.occluded, probes);
    }

    /// Returns the unoccluded lights of the point that ray `ray` of the wave hit.
    pub(super) fn lights_at(&self, ray: usize) -> impl Iterator<Item = Illumination<f32>> {
        let first = ray.checked_sub(1).map_or(0, |before| self.ends[before]);
        let rays = first..self.ends[ray];
        let reached = self.lights[rays.clone()].iter().zip(&self.occluded[rays]);
        reached.filter_map(|(light, is_occluded)| (!is_occluded).then_some(*light))
    }

    fn clear(&mut self) {
        self.rays.clear();
        self.lights.clear();
        self.pixels.clear();
        self.ends.clear();
    }
}
