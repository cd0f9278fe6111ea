//! Ray after ray, pixel after pixel, with a look at the clock in between.

use glam::Vec3;

use super::view::{View, limited};
use super::{TileRenderer, thread_number};
use crate::cost::{Clock, Cost, Probe, RayKind};
use crate::film::{Pixel, PixelCost};
use crate::geometry::Ray;
use crate::schedule::Tile;
use crate::shade::Path;
use crate::trace::SurfacePoint;

/// Renders tiles pixel by pixel, counting and timing each.
pub(super) struct TimedRenderer<'a> {
    view: View<'a>,
    clock: &'a Clock,
    /// The pixels that are rendered at one go, at most.
    pixels: Vec<Pixel>,
}

impl<'a> TimedRenderer<'a> {
    /// Renders `n_pixels` pixels at one go, at most.
    pub(super) fn new(view: View<'a>, clock: &'a Clock, n_pixels: usize) -> Self {
        // Written to once: no pixel shall pay for the first touch of memory.
        let pixels = vec![Pixel::default(); n_pixels];
        Self {
            view,
            clock,
            pixels,
        }
    }

    /// Renders a pixel where it is to stay: a copy would cost as much as a ray.
    fn pixel<P: Probe>(&self, place: (u32, u32), pixel: &mut Pixel, probe: &mut P) {
        *pixel = Pixel::default();
        for sample in 0..self.view.n_samples {
            let ray = self.view.camera_ray(place, sample);
            let met = self.view.tracer.trace(&ray, RayKind::Camera, probe);
            if sample == self.view.middle {
                pixel.surface = met;
            }
            pixel.color += limited(self.radiance(ray, met, probe));
        }
        self.view.finish(pixel, place);
    }

    /// The light that comes along a camera ray, given what the ray met.
    fn radiance<P: Probe>(
        &self,
        camera_ray: Ray,
        first: Option<SurfacePoint>,
        probe: &mut P,
    ) -> Vec3 {
        let View { tracer, shader, .. } = &self.view;
        let mut path = Path::from_eye(camera_ray.origin);
        let (mut ray, mut met) = (camera_ray, first);
        while let Some(point) = met {
            let lights = shader
                .light_samples(&point)
                .filter(|sample| !tracer.is_shadowed(&sample.shadow, probe))
                .map(|sample| sample.light);
            match shader.shade(&mut path, &ray, &point, lights) {
                Some(mirrored) => ray = mirrored,
                None => return path.color,
            }
            probe.bounce(path.depth);
            met = tracer.trace(&ray, RayKind::Reflection, probe);
        }
        shader.miss(&mut path, &ray);
        path.color
    }
}

impl TileRenderer for TimedRenderer<'_> {
    /// One reading of the clock ends a pixel and begins the next.
    fn render(&mut self, tile: &Tile) -> &[Pixel] {
        let thread = thread_number();
        let mut pixels = std::mem::take(&mut self.pixels);
        let mut n_pixels = 0;
        let mut begin = self.clock.now();
        for (place, pixel) in tile.pixels().zip(&mut pixels) {
            let mut counted = Cost::default();
            self.pixel(place, pixel, &mut counted);
            let end = self.clock.now();
            pixel.cost = Some(PixelCost {
                counted,
                time_ns: Some(self.clock.elapsed_ns(begin, end)),
                tile: tile.number,
                thread,
            });
            n_pixels += 1;
            begin = end;
        }
        self.pixels = pixels;
        &self.pixels[..n_pixels]
    }
}
