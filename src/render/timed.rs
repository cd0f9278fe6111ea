//! Renders ray by ray and times each pixel. Without a clock it measures the
//! overhead of timing. If pixels are timed, the first ones of a tile are rendered
//! twice, so that their times do not include cold caches.

use glam::Vec3;

use super::view::View;
use super::{SampleSums, TileRenderer};
use crate::config::Image;
use crate::cost::{BounceCounts, Clock, Cost, Counters, Instant, Interruptions, Probe, RayKind};
use crate::film::{Pixel, PixelColumns, PixelTime, Rendered};
use crate::schedule::Tile;
use crate::shade::{LightSample, PathRay};
use crate::simd::Vector;
use crate::stop;
use crate::trace::SurfacePoint;

/// Warm-up pixels, rendered before a tile's first pixel is timed. Writing the
/// previous tile has filled the caches and the branch predictor: without a
/// warm-up the first pixel takes up to 1.8 times as long as its neighbors, and
/// the second one up to 1.2 times (`benches/tiles/first_pixels`).
const N_WARM_UP: usize = 4;

/// Columns and rows of the pixels that warm up a thread.
const SPREAD: u32 = 8;

/// Paths for which there is room before any is traced.
const PATHS: usize = 256;

/// Renders tiles pixel by pixel, counts each and optionally times it.
pub(super) struct SingleRayRenderer<'a> {
    view: View<'a>,
    /// `None` to measure the overhead of timing.
    stopwatch: Option<Stopwatch<'a>>,
    pixels: Vec<Pixel>,
    /// The same as a structure of arrays.
    columns: PixelColumns,
    /// The counters of each pixel. [`Counters`] allocates at the first ray of a
    /// kind, which would be part of that pixel's time.
    costs: Vec<Cost>,
    counters: Counters,
    bounces: BounceCounts,
    times: Vec<PixelTime>,
    /// The rays that continue a camera ray's path.
    paths: Vec<PathRay>,
}

impl<'a> SingleRayRenderer<'a> {
    /// Creates a renderer of at most so many pixels of the image at a time for the calling
    /// thread, and warms up the thread.
    pub(super) fn new(
        view: View<'a>,
        clock: Option<&'a Clock>,
        (n_pixels, image): (usize, &Image),
    ) -> Self {
        // Filled with nonzero values, so that page faults are not part of a pixel's
        // time: the system would map zeroed pages only at the first write.
        let written_cost = Cost {
            depth: u64::MAX,
            ..Cost::default()
        };
        let written_time = PixelTime {
            ns: f32::NAN,
            ..PixelTime::default()
        };
        let mut renderer = Self {
            view,
            stopwatch: clock.map(Stopwatch::new),
            pixels: vec![Pixel::default(); n_pixels],
            columns: PixelColumns::none(n_pixels),
            costs: vec![written_cost; n_pixels],
            counters: Counters::default(),
            bounces: BounceCounts::new(view.counts_bounces),
            times: vec![written_time; n_pixels],
            paths: Vec::with_capacity(PATHS),
        };
        renderer.bounces.reset(n_pixels);
        renderer.warm_up_thread(image);
        renderer
    }

    /// Renders some pixels of the whole picture to fill the caches: without this,
    /// the first pixel of a thread that hits something took up to 12 microseconds
    /// more, and it was the same pixel in each rendering.
    fn warm_up_thread(&mut self, image: &Image) {
        if self.stopwatch.is_none() {
            return;
        }
        let spread = |i: u32, side: u32| (2 * i + 1) * side / (2 * SPREAD);
        for i in 0..SPREAD * SPREAD {
            if stop::is_requested() {
                return;
            }
            let place = (
                spread(i % SPREAD, image.width),
                spread(i / SPREAD, image.height),
            );
            self.render_pixel(place, 0);
        }
    }

    /// Renders the first pixels to fill the caches; returns the time in
    /// nanoseconds. This is a separate loop, as jumping to other pixels in the
    /// loop of the timed ones causes branch mispredictions.
    fn warm_up(&mut self, tile: &Tile) -> f64 {
        let Some(clock) = self.stopwatch.as_ref().map(|stopwatch| stopwatch.clock) else {
            return 0.0;
        };
        let begin = clock.now();
        let n_pixels = N_WARM_UP.min(tile.n_pixels() / 4).max(1);
        for place in tile.pixels().take(n_pixels) {
            if stop::is_requested() {
                break;
            }
            let i = tile.index(place) as usize;
            self.render_pixel(place, i);
        }
        clock.elapsed_ns(begin, clock.now()).into()
    }

    /// Renders pixel `i` of a tile in place: a copy would take as long as a ray.
    pub(super) fn render_pixel(&mut self, place: (u32, u32), i: usize) {
        let Self {
            view,
            pixels,
            costs,
            bounces,
            paths,
            ..
        } = self;
        bounces.reset_pixel(i);
        let pixel = &mut pixels[i];
        *pixel = Pixel::default();
        // A local variable, which stays in registers.
        let mut cost = Cost::default();
        let probe = &mut cost;
        let mut sums = SampleSums::zero(0.0);
        let mut round = view.rounds.first();
        while !round.is_empty() {
            for sample in round.clone() {
                let path = view.camera_path(place, sample);
                let met = view.tracer.trace(&path.ray, RayKind::Camera, probe);
                if let Some(point) = met
                    && sample == view.middle
                {
                    pixel.set_surface(&point);
                }
                let mut counted = |bounce| bounces.add(i, bounce, 1);
                let color = radiance(view, path, met, paths, probe, &mut counted);
                sums.add(view.limited(Vector::from(color)));
            }
            round = view.rounds.next(&sums, round.end);
        }
        pixel.color = sums.colors.into();
        view.finish(pixel, round.end, place);
        costs[i] = cost;
    }
}

impl TileRenderer for SingleRayRenderer<'_> {
    fn render(&mut self, tile: &Tile) -> Rendered<'_> {
        let n_pixels = tile.n_pixels();
        self.bounces.reset(n_pixels);
        let warm_up_ns = self.warm_up(tile);
        if let Some(stopwatch) = &mut self.stopwatch {
            stopwatch.start();
        }
        let mut n_done = 0;
        for place in tile.pixels() {
            if stop::is_requested() {
                break;
            }
            n_done += 1;
            let i = tile.index(place) as usize;
            self.render_pixel(place, i);
            if let Some(stopwatch) = &mut self.stopwatch {
                self.times[i] = stopwatch.lap();
            }
        }
        for (i, pixel) in self.pixels[..n_pixels].iter().enumerate() {
            self.columns.set(i, pixel);
        }
        self.counters.reset(n_pixels, self.view.rounds.n_uniform());
        for (i, cost) in self.costs[..n_done].iter().enumerate() {
            self.counters.add(i, cost);
        }
        let n_times = match self.stopwatch {
            Some(_) => n_pixels,
            None => 0,
        };
        Rendered {
            pixels: &self.columns,
            counters: Some(&self.counters),
            bounces: self.bounces.get(),
            times: &self.times[..n_times],
            warm_up_ns,
        }
    }
}

/// Times consecutive pixels on one thread.
struct Stopwatch<'a> {
    clock: &'a Clock,
    interruptions: Interruptions,
    /// The start of the pixel.
    begin: Instant,
    /// Whether the previous pixel was disturbed.
    was_disturbed: bool,
}

impl<'a> Stopwatch<'a> {
    fn new(clock: &'a Clock) -> Self {
        Self {
            clock,
            interruptions: Interruptions::of_this_thread(),
            begin: clock.now(),
            was_disturbed: false,
        }
    }

    /// Starts the first pixel.
    #[inline]
    fn start(&mut self) {
        self.interruptions.take();
        self.was_disturbed = false;
        self.begin = self.clock.now();
    }

    /// Ends a pixel; the same reading of the clock starts the next one.
    ///
    /// A pixel after a disturbed one is rejected too: its caches are cold, and an
    /// interruption between the reading of the clock and the check falls into its
    /// time.
    #[inline]
    fn lap(&mut self) -> PixelTime {
        let end = self.clock.now();
        let is_disturbed = self.interruptions.take() || !end.is_on_cpu_of(self.begin);
        let time = PixelTime {
            ns: self.clock.elapsed_ns(self.begin, end),
            is_rejected: is_disturbed || self.was_disturbed,
        };
        self.begin = end;
        self.was_disturbed = is_disturbed;
        time
    }
}

/// Returns the radiance along a camera ray, the start of a path, given the point that it
/// hit. `paths` is a reused buffer; `bounces` gets the bounces before each ray.
fn radiance<P: Probe>(
    view: &View,
    camera_path: PathRay,
    first: Option<SurfacePoint>,
    paths: &mut Vec<PathRay>,
    probe: &mut P,
    bounces: &mut impl FnMut(u32),
) -> Vec3 {
    let View { tracer, shader, .. } = view;
    let mut color = Vec3::ZERO;
    let (mut path, mut met) = (camera_path, shader.met_in_fog(&camera_path, first));
    let eye = camera_path.ray.origin;
    paths.clear();
    bounces(0);
    // All rays of a depth before those of the next, as in waves.
    let mut n_traced = 0;
    loop {
        color += match met {
            Some(point) => {
                let mut is_shadowed = |sample: &LightSample| {
                    bounces(path.depth);
                    tracer.is_shadowed(&sample.shadow, probe)
                };
                let lights = shader
                    .light_samples(&path, &point)
                    .filter(|sample| !shader.casts_shadows() || !is_shadowed(sample))
                    .map(|sample| sample.light);
                shader.shade(eye, &path, &point, lights, paths)
            }
            None => shader.miss(&path),
        };
        let Some(&next) = paths.get(n_traced) else {
            return color;
        };
        n_traced += 1;
        path = next;
        probe.bounce(path.depth);
        bounces(path.depth);
        let hit = tracer.trace_after(path.length, &path.ray, path.kind, probe);
        met = shader.met_in_fog(&path, hit);
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::accel::Accel;
    use crate::config::{Config, Tiling};
    use crate::render::TilePlan;
    use crate::scene::{Geometries, Scene};
    use crate::yaml::Source;

    #[test]
    fn a_warm_up_is_timed_and_not_counted() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/configs/seed_extended.yaml");
        let source = Source::read(file.as_ref()).unwrap();
        let mut config: Config = source.parse().unwrap();
        let geometries = Geometries::read(&mut config, source.folder(), u64::MAX).unwrap();
        let scene = Scene::new(&config, geometries).unwrap();
        let accel = Accel::new(&scene, config.acceleration);
        let plan = TilePlan::new(&scene, &accel, &config.image, Tiling::default());
        let view = View::new(&scene, &accel, &config.image);
        let clock = Clock::calibrated();
        let mut cold = SingleRayRenderer::new(view, None, plan.room());
        let mut warm = SingleRayRenderer::new(view, Some(&clock), plan.room());
        for number in [0, 200, 399] {
            let tile = plan.tile(number).unwrap();
            let [cold, warm] = [cold.render(&tile), warm.render(&tile)];
            assert_eq!(cold.warm_up_ns, 0.0);
            assert!(warm.warm_up_ns >= 1.0);
            assert_eq!(
                cold.counters.unwrap().total(),
                warm.counters.unwrap().total()
            );
            let colors = |rendered: Rendered| -> Vec<Vec3> { rendered.pixels.color.clone() };
            assert_eq!(colors(cold), colors(warm));
        }
    }

    #[test]
    fn an_interrupted_pixel_and_the_next_one_are_rejected() {
        let clock = Clock::calibrated();
        let mut stopwatch = Stopwatch::new(&clock);
        if !stopwatch.interruptions.is_reported() {
            return;
        }
        stopwatch.start();
        std::thread::sleep(Duration::from_micros(50));
        assert!(stopwatch.lap().is_rejected);
        assert!(stopwatch.lap().is_rejected);
        // A thread is not interrupted a hundred times in a row.
        assert!((0..100).any(|_| !stopwatch.lap().is_rejected));
    }
}
