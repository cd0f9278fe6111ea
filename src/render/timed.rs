//! Ray after ray, pixel after pixel, with a look at the clock in between; or
//! without, to tell what the look costs. A tile's first pixels are rendered twice
//! where they are timed, so that the first one does not pay for cold caches.

use glam::Vec3;

use super::view::{View, limited};
use super::{Plan, TileRenderer};
use crate::config::Image;
use crate::cost::{Clock, Cost, Counters, Instant, Interruptions, Probe, RayKind};
use crate::film::{Pixel, PixelTime, Rendered};
use crate::geometry::Ray;
use crate::schedule::Tile;
use crate::shade::Path;
use crate::stop;
use crate::trace::SurfacePoint;

/// Pixels that are rendered once more before a tile's first pixel is timed. The
/// writing of the tile before has left the caches and the branch predictor with
/// its own code and data: without them the first pixel costs up to 1.8 times as
/// much as its neighbors, and the second one up to 1.2 times
/// (`benches/tiles/first_pixels`).
const N_WARM_UP: usize = 4;

/// Columns, and rows, of the pixels that warm a thread up.
const SPREAD: u32 = 8;

/// Renders tiles pixel by pixel, counting each, and timing it by a clock.
pub(super) struct SingleRayRenderer<'a> {
    view: View<'a>,
    /// None to tell what the clock costs.
    stopwatch: Option<Stopwatch<'a>>,
    pixels: Vec<Pixel>,
    /// What is counted of each pixel. Counters grow where a tile has its first
    /// ray of a kind, and no pixel shall pay for that.
    costs: Vec<Cost>,
    counters: Counters,
    times: Vec<PixelTime>,
}

impl<'a> SingleRayRenderer<'a> {
    /// Renders tiles of the plan on the calling thread.
    pub(super) fn new(view: View<'a>, clock: Option<&'a Clock>, plan: &Plan) -> Self {
        let n_pixels = plan.max_pixels();
        // Written to once: no pixel shall pay for the first touch of memory. The
        // allocator would leave zeros to the system, which maps pages of them when
        // they are written to.
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
            costs: vec![written_cost; n_pixels],
            counters: Counters::default(),
            times: vec![written_time; n_pixels],
        };
        renderer.warm_up_thread(&plan.image);
        renderer
    }

    /// Renders some pixels all over the picture for nothing but what that leaves in
    /// the caches: the first pixel of a thread that hits something took up to 12
    /// microseconds more, in each rendering the same one.
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
            render_pixel(&self.view, place, &mut self.pixels[0], &mut self.costs[0]);
        }
    }

    /// Renders the first pixels for nothing but what that leaves in the caches;
    /// gives the time in nanoseconds. A loop of its own: where the loop of the
    /// timed pixels goes on with other ones, the processor predicts wrong.
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
            render_pixel(&self.view, place, &mut self.pixels[i], &mut self.costs[i]);
        }
        clock.elapsed_ns(begin, clock.now()).into()
    }
}

impl TileRenderer for SingleRayRenderer<'_> {
    fn render(&mut self, tile: &Tile) -> Rendered<'_> {
        let n_pixels = tile.n_pixels();
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
            render_pixel(&self.view, place, &mut self.pixels[i], &mut self.costs[i]);
            if let Some(stopwatch) = &mut self.stopwatch {
                self.times[i] = stopwatch.lap();
            }
        }
        self.counters.reset(n_pixels, self.view.n_samples);
        for (i, cost) in self.costs[..n_done].iter().enumerate() {
            self.counters.add(i, cost);
        }
        let n_times = match self.stopwatch {
            Some(_) => n_pixels,
            None => 0,
        };
        Rendered {
            pixels: &self.pixels[..n_pixels],
            counters: Some(&self.counters),
            times: &self.times[..n_times],
            warm_up_ns,
        }
    }
}

/// Times one pixel after the other on one thread.
struct Stopwatch<'a> {
    clock: &'a Clock,
    interruptions: Interruptions,
    /// When the pixel was begun.
    begin: Instant,
    /// Whether the pixel before was disturbed.
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

    /// Begins with a first pixel.
    #[inline]
    fn start(&mut self) {
        self.interruptions.take();
        self.was_disturbed = false;
        self.begin = self.clock.now();
    }

    /// Ends a pixel; the same reading of the clock begins the next one.
    ///
    /// A pixel after one that was disturbed is disturbed as well: it comes into
    /// cold caches, and what happens between the clock and the look at the
    /// interruptions falls into its time.
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

/// Renders a pixel where it is to stay: a copy would cost as much as a ray.
fn render_pixel(view: &View, place: (u32, u32), pixel: &mut Pixel, counted: &mut Cost) {
    *pixel = Pixel::default();
    // In registers until the end.
    let mut cost = Cost::default();
    let probe = &mut cost;
    for sample in 0..view.n_samples {
        let ray = view.camera_ray(place, sample);
        let met = view.tracer.trace(&ray, RayKind::Camera, probe);
        if sample == view.middle {
            pixel.surface = met;
        }
        pixel.color += limited(radiance(view, ray, met, probe));
    }
    view.finish(pixel, place);
    *counted = cost;
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

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::accel::Accel;
    use crate::config::{Config, Tiling};
    use crate::render::Plan;
    use crate::scene::{Geometries, Scene};
    use crate::yaml::Source;

    #[test]
    fn a_warm_up_takes_time_and_is_not_counted() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/configs/seed_extended.yaml");
        let source = Source::read(file.as_ref()).unwrap();
        let config: Config = source.parse().unwrap();
        let geometries = Geometries::read(&config, source.folder(), u64::MAX).unwrap();
        let scene = Scene::new(&config, geometries).unwrap();
        let accel = Accel::new(&scene.primitives, config.acceleration);
        let plan = Plan::new(&scene, &accel, &config.image, Tiling::default());
        let view = View::new(&scene, &accel, &config.image);
        let clock = Clock::calibrated();
        let mut cold = SingleRayRenderer::new(view, None, &plan);
        let mut warm = SingleRayRenderer::new(view, Some(&clock), &plan);
        for number in [0, 200, 399] {
            let tile = plan.tile(number).unwrap();
            let [cold, warm] = [cold.render(&tile), warm.render(&tile)];
            assert_eq!(cold.warm_up_ns, 0.0);
            assert!(warm.warm_up_ns >= 1.0);
            assert_eq!(
                cold.counters.unwrap().total(),
                warm.counters.unwrap().total()
            );
            let colors = |rendered: Rendered| -> Vec<Vec3> {
                rendered.pixels.iter().map(|pixel| pixel.color).collect()
            };
            assert_eq!(colors(cold), colors(warm));
        }
    }

    #[test]
    fn a_pixel_that_lost_its_processor_is_rejected_with_the_next_one() {
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
