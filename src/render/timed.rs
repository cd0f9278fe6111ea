//! Ray after ray, pixel after pixel, with a look at the clock in between; or
//! without, to tell what the look costs.

use glam::Vec3;

use super::view::{View, limited};
use super::{TileRenderer, thread_number};
use crate::cost::{Clock, Cost, NoProbe, Probe, RayKind};
use crate::film::{Pixel, PixelCost, PixelTime};
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
        Self {
            view,
            clock,
            pixels: touched_pixels(n_pixels),
        }
    }
}

impl TileRenderer for TimedRenderer<'_> {
    /// One reading of the clock ends a pixel and begins the next.
    fn render(&mut self, tile: &Tile) -> &[Pixel] {
        let thread = thread_number();
        let mut n_pixels = 0;
        let mut begin = self.clock.now();
        for (place, pixel) in tile.pixels().zip(&mut self.pixels) {
            let mut counted = Cost::default();
            render_pixel(&self.view, place, pixel, &mut counted);
            let end = self.clock.now();
            pixel.cost = Some(PixelCost {
                counted,
                time: Some(PixelTime {
                    ns: self.clock.elapsed_ns(begin, end),
                    is_rejected: !end.is_on_cpu_of(begin),
                }),
                tile: tile.number,
                thread,
            });
            n_pixels += 1;
            begin = end;
        }
        &self.pixels[..n_pixels]
    }
}

/// The same rays in the same order, neither counted nor timed: what a
/// [`TimedRenderer`] takes longer is what its instruments cost.
pub(super) struct BareRenderer<'a> {
    view: View<'a>,
    /// The pixels that are rendered at one go, at most.
    pixels: Vec<Pixel>,
}

impl<'a> BareRenderer<'a> {
    /// Renders `n_pixels` pixels at one go, at most.
    pub(super) fn new(view: View<'a>, n_pixels: usize) -> Self {
        Self {
            view,
            pixels: touched_pixels(n_pixels),
        }
    }
}

impl TileRenderer for BareRenderer<'_> {
    fn render(&mut self, tile: &Tile) -> &[Pixel] {
        let mut n_pixels = 0;
        for (place, pixel) in tile.pixels().zip(&mut self.pixels) {
            render_pixel(&self.view, place, pixel, &mut NoProbe);
            n_pixels += 1;
        }
        &self.pixels[..n_pixels]
    }
}

/// Room for so many pixels.
fn touched_pixels(n_pixels: usize) -> Vec<Pixel> {
    // Written to once: no pixel shall pay for the first touch of memory.
    vec![Pixel::default(); n_pixels]
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
