//! The tile loop: scene → film, on all threads.

use std::sync::{Mutex, PoisonError};

use glam::Vec3;
use rayon::prelude::*;

use crate::accel::Accel;
use crate::config::Image;
use crate::cost::{Clock, Cost, Meter, NoProbe, Probe, RayKind};
use crate::film::{Film, Pixel, PixelCost, STRIP_ROWS, Strip};
use crate::sampling::PixelPattern;
use crate::scene::Scene;
use crate::shade::Shader;
use crate::trace::Tracer;

/// Pixels along a tile's side: small enough to share out evenly, large enough
/// that one tile's film is written at one go.
pub const TILE_SIDE: u32 = STRIP_ROWS;

/// What has been rendered since the last report.
#[derive(Debug, Clone, Copy, Default)]
pub struct Progress {
    /// Pixels.
    pub n_pixels: u64,
    /// Rays; 0 where nothing is counted.
    pub n_rays: u64,
}

/// Renders the scene on the current rayon pool and measures every pixel with
/// the `meter`. `report` hears of each tile, from any thread.
pub fn render(
    scene: &Scene,
    accel: &Accel,
    image: &Image,
    meter: &Meter,
    report: impl Fn(Progress) + Sync,
) -> Film {
    let mut film = Film::new(image.width, image.height, meter.mode());
    let strips: Vec<_> = film.strips.iter_mut().map(Mutex::new).collect();
    let tracer = Tracer::new(scene, accel);
    let renderer = Renderer {
        scene,
        shader: Shader::new(scene, tracer),
        tracer,
        pattern: PixelPattern::new(image.samples_per_pixel, image.seed),
        image,
    };
    let n_columns = image.width.div_ceil(TILE_SIDE);
    let n_tiles = n_columns * image.height.div_ceil(TILE_SIDE);
    let render_tile = |pixels: &mut Vec<Pixel>, number| {
        let tile = Tile::new(number, n_columns, image);
        let counted = match meter {
            Meter::Off => renderer.tile(&tile, pixels),
            Meter::Counters => renderer.counted_tile(&tile, pixels),
            Meter::Time(clock) => renderer.timed_tile(&tile, clock, pixels),
        };
        // The film is written a tile at a time, outside of any pixel's time:
        // first touches of its memory would show in the heatmap.
        let strip = &strips[(tile.rows[0] / STRIP_ROWS) as usize];
        tile.store(
            pixels,
            &mut strip.lock().unwrap_or_else(PoisonError::into_inner),
        );
        report(Progress {
            n_pixels: pixels.len() as u64,
            n_rays: counted.n_rays(),
        });
        counted
    };
    let totals = (0..n_tiles)
        .into_par_iter()
        .map_init(tile_pixels, render_tile)
        .reduce(Cost::default, Cost::with);
    drop(strips);
    film.totals = totals;
    film
}

/// Room for a tile's pixels, written to once: no pixel shall pay for the first
/// touch of its memory.
fn tile_pixels() -> Vec<Pixel> {
    let mut pixels = vec![Pixel::default(); (TILE_SIDE * TILE_SIDE) as usize];
    pixels.clear();
    pixels
}

/// A rectangle of pixels that one thread renders.
struct Tile {
    number: u32,
    /// First column and the one after the last.
    columns: [u32; 2],
    /// First row and the one after the last.
    rows: [u32; 2],
}

impl Tile {
    /// Tiles are numbered along rows from the top left.
    fn new(number: u32, n_columns: u32, image: &Image) -> Self {
        let span = |index: u32, end: u32| {
            let first = index * TILE_SIDE;
            [first, (first + TILE_SIDE).min(end)]
        };
        Self {
            number,
            columns: span(number % n_columns, image.width),
            rows: span(number / n_columns, image.height),
        }
    }

    /// Its pixels (x, y), row by row.
    fn pixels(&self) -> impl Iterator<Item = (u32, u32)> {
        let [[left, right], [top, bottom]] = [self.columns, self.rows];
        (top..bottom).flat_map(move |y| (left..right).map(move |x| (x, y)))
    }

    /// Puts the tile's pixels, in the order of [`pixels`](Self::pixels), into
    /// their strip.
    fn store(&self, pixels: &[Pixel], strip: &mut Strip) {
        let width = strip.object.len() / strip.n_rows as usize;
        for ((x, y), pixel) in self.pixels().zip(pixels) {
            let row = (y - strip.first_row) as usize;
            strip.put(row * width + x as usize, pixel);
        }
    }
}

/// All that rendering a pixel needs.
struct Renderer<'a> {
    scene: &'a Scene,
    shader: Shader<'a>,
    tracer: Tracer<'a>,
    pattern: PixelPattern,
    image: &'a Image,
}

impl Renderer<'_> {
    /// Renders the tile into `pixels` without measuring anything.
    fn tile(&self, tile: &Tile, pixels: &mut Vec<Pixel>) -> Cost {
        pixels.clear();
        pixels.extend(tile.pixels().map(|(x, y)| self.pixel(x, y, &mut NoProbe)));
        Cost::default()
    }

    /// Renders the tile into `pixels`, counting; gives the sum of the counters.
    fn counted_tile(&self, tile: &Tile, pixels: &mut Vec<Pixel>) -> Cost {
        pixels.clear();
        let thread = rayon::current_thread_index().unwrap_or(0) as u32;
        let mut total = Cost::default();
        for (x, y) in tile.pixels() {
            let mut counted = Cost::default();
            let mut pixel = self.pixel(x, y, &mut counted);
            pixel.cost = Some(PixelCost {
                counted,
                time_ns: None,
                tile: tile.number,
                thread,
            });
            pixels.push(pixel);
            total = total.with(counted);
        }
        total
    }

    /// Renders the tile into `pixels`, counting and timing each of them; gives
    /// the sum of the counters. One reading of the clock ends a pixel and
    /// begins the next.
    fn timed_tile(&self, tile: &Tile, clock: &Clock, pixels: &mut Vec<Pixel>) -> Cost {
        pixels.clear();
        let thread = rayon::current_thread_index().unwrap_or(0) as u32;
        let mut total = Cost::default();
        let mut begin = clock.now();
        for (x, y) in tile.pixels() {
            let mut counted = Cost::default();
            let mut pixel = self.pixel(x, y, &mut counted);
            let end = clock.now();
            pixel.cost = Some(PixelCost {
                counted,
                time_ns: Some(clock.elapsed_ns(begin, end)),
                tile: tile.number,
                thread,
            });
            pixels.push(pixel);
            total = total.with(counted);
            begin = end;
        }
        total
    }

    /// Renders one pixel; its cost is left to the caller.
    fn pixel<P: Probe>(&self, x: u32, y: u32, probe: &mut P) -> Pixel {
        let number = u64::from(y) * u64::from(self.image.width) + u64::from(x);
        let n_samples = self.image.samples_per_pixel;
        let mut color = Vec3::ZERO;
        let mut surface = None;
        for i in 0..n_samples {
            let offset = self.pattern.point(number, i);
            let ray = self
                .scene
                .image_plane
                .ray(x as f32 + offset.x, y as f32 + offset.y);
            let met = self.tracer.trace(&ray, RayKind::Camera, probe);
            if i == self.pattern.center() {
                surface = met;
            }
            // Limited a sample at a time, so that a bright edge stays smooth.
            let radiance = self.shader.radiance(&ray, met.as_ref(), probe);
            color += radiance.min(Vec3::ONE);
        }
        let plane = &self.scene.image_plane;
        let footprint_at = |distance| plane.footprint(x as f32, y as f32, distance);
        Pixel {
            color: color / n_samples as f32,
            surface,
            footprint: surface.map_or(f32::NAN, |point| footprint_at(point.distance)),
            cost: None,
        }
    }
}
