//! Wavefront rendering: all camera rays of a tile, then their shadow rays, then
//! the reflected rays, and so on until all paths have ended.
//!
//! After Laine, Karras and Aila, "Megakernels Considered
//! Harmful: Wavefront Path Tracing on GPUs", HPG 2013.

use std::ops::Range;

use glam::Vec3;

use super::TileRenderer;
use super::view::{View, limited};
use super::wave::{Shadows, Wave};
use crate::accel::Hit;
use crate::cost::{ByPixel, PixelProbe, RayKind};
use crate::film::{Pixel, Rendered};
use crate::schedule::Tile;
use crate::shade::Path;
use crate::stop;
use crate::trace::SurfacePoint;

/// Most paths in flight at a time, unless a tile has more pixels: enough to keep
/// the kernel busy, few enough to stay in the cache between two steps.
pub(super) const WAVE_LEN: usize = 2048;

/// Renders tiles in waves of rays and counts with a `P`. All buffers are reused
/// from tile to tile.
pub(super) struct StreamRenderer<'a, P> {
    view: View<'a>,
    /// In the order in which their camera rays are traced.
    places: Vec<PixelPlace>,
    pixels: Vec<Pixel>,
    probe: P,
    wave: Wave,
    /// The next wave.
    next: Wave,
    hits: Vec<Option<Hit>>,
    /// The point that each ray of the wave hit.
    met: Vec<Option<SurfacePoint>>,
    shadows: Shadows,
    /// The color of each path, by slot: the first pixel's paths come first.
    colors: Vec<Vec3>,
}

/// A pixel to render.
#[derive(Clone, Copy)]
pub(super) struct PixelPlace {
    /// Its index among the pixels that are rendered together.
    pub(super) pixel: u32,
    /// Its column and row in the picture.
    pub(super) at: (u32, u32),
}

// Inlining is forced: otherwise the compiler decides differently with and without
// counters, and counting appears to be twice as expensive.
impl<'a, P: PixelProbe> StreamRenderer<'a, P> {
    pub(super) fn new(view: View<'a>) -> Self {
        Self {
            view,
            places: Vec::new(),
            pixels: Vec::new(),
            probe: P::default(),
            wave: Wave::default(),
            next: Wave::default(),
            hits: Vec::new(),
            met: Vec::new(),
            shadows: Shadows::default(),
            colors: Vec::new(),
        }
    }

    /// Traces all paths of these pixels, whose numbers are 0, 1, … in any order.
    #[inline(always)]
    pub(super) fn follow(&mut self, places: impl Iterator<Item = PixelPlace>) {
        self.places.clear();
        self.places.extend(places);
        let n_pixels = self.places.len();
        self.pixels.clear();
        self.pixels.resize(n_pixels, Pixel::default());
        let n_samples = self.view.n_samples;
        self.probe.reset(n_pixels, n_samples);
        let n_per_wave = (WAVE_LEN / n_pixels).max(1);
        for first in (0..n_samples).step_by(n_per_wave) {
            if stop::is_requested() {
                break;
            }
            self.render_samples(first..n_samples.min(first + n_per_wave as u32));
        }
    }

    /// The counters of the pixels last followed.
    pub(super) fn probe(&self) -> &P {
        &self.probe
    }

    /// Renders these samples of all pixels.
    #[inline(always)]
    fn render_samples(&mut self, samples: Range<u32>) {
        self.shoot(samples.clone());
        self.trace();
        if samples.contains(&self.view.middle) {
            let middle = (self.view.middle - samples.start) as usize;
            let met = self.met.iter().skip(middle).step_by(samples.len());
            for (place, met) in self.places.iter().zip(met) {
                self.pixels[place.pixel as usize].surface = *met;
            }
        }
        self.shade();
        while !self.wave.rays.is_empty() {
            self.trace();
            self.shade();
        }
        let colors = self.colors.chunks_exact(samples.len());
        for (place, colors) in self.places.iter().zip(colors) {
            let sum = &mut self.pixels[place.pixel as usize].color;
            colors.iter().for_each(|&color| *sum += limited(color));
        }
    }

    /// Starts a path for each of these samples of all pixels.
    #[inline(always)]
    fn shoot(&mut self, samples: Range<u32>) {
        self.wave.clear();
        let mut slot = 0;
        for &PixelPlace { pixel, at } in &self.places {
            for sample in samples.clone() {
                let ray = self.view.camera_ray(at, sample);
                self.wave.push(ray, pixel, Path::from_eye(ray.origin), slot);
                slot += 1;
            }
        }
        self.colors.clear();
        self.colors.resize(slot as usize, Vec3::ZERO);
    }

    /// Finds the hits of the wave's rays.
    #[inline(always)]
    fn trace(&mut self) {
        let Self { view, wave, .. } = self;
        let probe = ByPixel::new(&mut self.probe, &wave.pixels);
        view.tracer
            .nearest_stream(&wave.rays, &mut self.hits, probe);
        let met = wave
            .rays
            .iter()
            .zip(&self.hits)
            .map(|(ray, hit)| hit.map(|hit| view.tracer.surface_point(ray, hit)));
        self.met.clear();
        self.met.extend(met);
    }

    /// Shades the hits of the wave's rays; the reflected rays become the wave.
    fn shade(&mut self) {
        let View { tracer, shader, .. } = &self.view;
        self.shadows
            .gather(shader, &self.met, &self.wave.pixels, &mut self.probe);
        self.shadows.trace(tracer, &mut self.probe);
        self.next.clear();
        for (i, (ray, met)) in self.wave.rays.iter().zip(&self.met).enumerate() {
            let path = &mut self.wave.paths[i];
            let reflected = match met {
                Some(point) => shader.shade(path, ray, point, self.shadows.lights_at(i)),
                None => {
                    shader.miss(path, ray);
                    None
                }
            };
            let (pixel, slot) = (self.wave.pixels[i], self.wave.slots[i]);
            match reflected {
                Some(ray) => {
                    self.probe.rays(RayKind::Reflection, pixel as usize, 1);
                    self.probe.bounce(pixel as usize, path.depth);
                    self.next.push(ray, pixel, *path, slot);
                }
                None => self.colors[slot as usize] = path.color,
            }
        }
        std::mem::swap(&mut self.wave, &mut self.next);
    }
}

impl<P: PixelProbe> TileRenderer for StreamRenderer<'_, P> {
    fn render(&mut self, tile: &Tile) -> Rendered<'_> {
        let place = |at| PixelPlace {
            pixel: tile.index(at),
            at,
        };
        self.follow(tile.pixels().map(place));
        for &PixelPlace { pixel, at } in &self.places {
            self.view.finish(&mut self.pixels[pixel as usize], at);
        }
        Rendered {
            pixels: &self.pixels,
            counters: self.probe.counted(),
            times: &[],
            warm_up_ns: 0.0,
        }
    }
}
