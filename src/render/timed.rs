//! Ray after ray, pixel after pixel, with a look at the clock in between; or
//! without, to tell what the look costs.

use glam::Vec3;

use super::TileRenderer;
use super::view::{View, limited};
use crate::cost::{Clock, Cost, Counters, Probe, RayKind};
use crate::film::{Pixel, PixelTime, Rendered};
use crate::geometry::Ray;
use crate::schedule::Tile;
use crate::shade::Path;
use crate::trace::SurfacePoint;

/// Renders tiles pixel by pixel, counting each, and timing it by a clock.
pub(super) struct SingleRayRenderer<'a> {
    view: View<'a>,
    /// None to tell what the clock costs.
    clock: Option<&'a Clock>,
    pixels: Vec<Pixel>,
    counters: Counters,
    times: Vec<PixelTime>,
}

impl<'a> SingleRayRenderer<'a> {
    /// Renders `n_pixels` pixels at one go, at most.
    pub(super) fn new(view: View<'a>, clock: Option<&'a Clock>, n_pixels: usize) -> Self {
        // Written to once: no pixel shall pay for the first touch of memory.
        Self {
            view,
            clock,
            pixels: vec![Pixel::default(); n_pixels],
            counters: Counters::default(),
            times: vec![PixelTime::default(); n_pixels],
        }
    }
}

impl TileRenderer for SingleRayRenderer<'_> {
    /// One reading of the clock ends a pixel and begins the next.
    fn render(&mut self, tile: &Tile) -> Rendered<'_> {
        let now = || self.clock.map(|clock| (clock, clock.now()));
        let n_pixels = tile.n_pixels();
        self.counters.reset(n_pixels, self.view.n_samples);
        let mut begin = now();
        for place in tile.pixels() {
            let i = tile.index(place) as usize;
            let mut counted = Cost::default();
            render_pixel(&self.view, place, &mut self.pixels[i], &mut counted);
            self.counters.add(i, &counted);
            let end = now();
            if let (Some((clock, begin)), Some((_, end))) = (begin, end) {
                self.times[i] = PixelTime {
                    ns: clock.elapsed_ns(begin, end),
                    is_rejected: !end.is_on_cpu_of(begin),
                };
            }
            begin = end;
        }
        let n_times = if self.clock.is_some() { n_pixels } else { 0 };
        Rendered {
            pixels: &self.pixels[..n_pixels],
            counters: Some(&self.counters),
            times: &self.times[..n_times],
        }
    }
}

/// Renders a pixel where it is to stay: a copy would cost as much as a ray.
fn render_pixel<P: Probe>(view: &View, place: (u32, u32), pixel: &mut Pixel, probe: &mut P) {
    *pixel = Pixel::default();
    for sample in 0..view.n_samples {
        let ray = view.camera_ray(place, sample);
        let met = view.tracer.trace(&ray, RayKind::Camera, probe);
        if sample == view.middle {
            pixel.surface = met;
        }
        pixel.color += limited(radiance(view, ray, met, probe));
    }
    view.finish(pixel, place);
}

/// The light that comes along a camera ray, given what the ray met.
fn radiance<P: Probe>(
    view: &View,
    camera_ray: Ray,
    first: Option<SurfacePoint>,
    probe: &mut P,
) -> Vec3 {
    let View { tracer, shader, .. } = view;
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
