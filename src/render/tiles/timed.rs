//! Rendering ray by ray, timing each pixel. The first pixels of a tile are rendered twice, so that
//! their times do not include cold caches.

use glam::Vec3;

use super::rounds::Rounds;
use super::sample_plan::SamplePlanner;
use super::view::View;
use super::{PathProbe, TileRenderer, follow};
use crate::film::{Pixel, PixelColumns, Rendered};
use crate::schedule::Tile;
use base::stop;
use scene::config::Image;
use tracer::cost::{BounceCounts, Clock, Cost, Counters, Probe, Stopwatch};
use tracer::shade::{LightSample, PathRay};
use tracer::trace::SurfacePoint;

/// Warm-up pixels, rendered before a tile's first pixel is timed. Writing the previous tile has
/// filled the caches and the branch predictor: without a warm-up the first pixel takes up to 1.8
/// times as long as its neighbors, and the second one up to 1.2 times
/// (`benches/tiles/first_pixels`).
const N_WARM_UP: usize = 4;

/// Columns and rows of the pixels that warm up a thread.
const SPREAD: u32 = 8;

/// Paths for which room is allocated before any is traced.
const PATHS: usize = 256;

/// Renders tiles pixel by pixel, counts each and times it.
pub(super) struct SingleRayRenderer<'a> {
    stopwatch: Stopwatch,
    /// The cost of a reading of the clock in nanoseconds.
    overhead_ns: f32,
    /// The pixels of the tile in the order in which they are rendered, listed before any is timed:
    /// finding the next one takes longer where a row of a block ends.
    places: Vec<PixelPlace>,
    /// Plans their samples, if efficiency decides.
    planner: Option<SamplePlanner<'a>>,
    planned: Vec<u32>,
    renderer: PixelRenderer<'a>,
    /// The times in this order, in nanoseconds.
    times_ns: Vec<f32>,
    // The same row by row, as in the film.
    columns: PixelColumns,
    counters: Counters,
    time_ns: Vec<f32>,
    /// Number of pixels rendered before a request to stop.
    n_done: usize,
    warm_up_ns: f64,
}

/// A pixel of a tile.
#[derive(Debug, Clone, Copy)]
struct PixelPlace {
    /// Column and row.
    at: (u32, u32),
    /// Number of the pixel in the tile, row by row.
    index: usize,
    rounds: Rounds,
}

/// Renders single pixels.
struct PixelRenderer<'a> {
    view: View<'a>,
    /// The pixels in the order in which they are rendered.
    pixels: Vec<Pixel>,
    /// The counters of each. [`Counters`] allocates at the first ray of a kind, which would be part
    /// of that pixel's time.
    costs: Vec<Cost>,
    bounces: BounceCounts,
    /// The rays that continue a camera ray's path.
    paths: Vec<PathRay>,
}

impl<'a> SingleRayRenderer<'a> {
    /// Creates a renderer of at most `n_pixels` pixels of the image at a time for the calling
    /// thread, and warms up the thread.
    pub(super) fn new(view: View<'a>, clock: &Clock, (n_pixels, image): (usize, &Image)) -> Self {
        // Filled with nonzero values, so that page faults are not part of a pixel's time: the
        // system would map zeroed pages only at the first write.
        let written_cost = Cost {
            depth: u64::MAX,
            ..Cost::default()
        };
        let mut renderer = Self {
            stopwatch: Stopwatch::start(*clock),
            overhead_ns: clock.overhead_ns() as f32,
            places: Vec::with_capacity(n_pixels),
            planner: SamplePlanner::of(view),
            planned: Vec::new(),
            renderer: PixelRenderer {
                view,
                pixels: vec![Pixel::default(); n_pixels],
                costs: vec![written_cost; n_pixels],
                bounces: BounceCounts::new(view.counts_bounces),
                paths: Vec::with_capacity(PATHS),
            },
            times_ns: vec![f32::NAN; n_pixels],
            columns: PixelColumns::none(n_pixels),
            counters: Counters::default(),
            time_ns: vec![f32::NAN; n_pixels],
            n_done: 0,
            warm_up_ns: 0.0,
        };
        renderer.warm_up_thread(image);
        renderer
    }

    /// Renders some pixels of the whole picture to fill the caches: without this, the first pixel
    /// of a thread that hits something took up to 12 microseconds more, and it was the same pixel
    /// in each rendering.
    fn warm_up_thread(&mut self, image: &Image) {
        self.renderer.bounces.reset(1);
        let spread = |i: u32, side: u32| (2 * i + 1) * side / (2 * SPREAD);
        for i in 0..SPREAD * SPREAD {
            if stop::is_requested() {
                return;
            }
            let at = (
                spread(i % SPREAD, image.width),
                spread(i / SPREAD, image.height),
            );
            let rounds = self.renderer.view.rounds.only_first();
            let place = PixelPlace {
                at,
                index: 0,
                rounds,
            };
            self.renderer.render_pixel(place, 0);
        }
    }

    /// Renders some pixels one after the other, at most as many as there is room for. Returns the
    /// nanoseconds that the last one took.
    pub(super) fn time_last(&mut self, places: impl Iterator<Item = (u32, u32)>) -> f32 {
        self.places.clear();
        for (index, (x, y)) in places.enumerate() {
            self.plan(&Tile::one_pixel(x, y));
            self.push_place(index, (x, y), 0);
        }
        self.renderer.bounces.reset(self.places.len());
        self.render_timed();
        self.times_ns[self.places.len() - 1]
    }

    /// Plans the samples of a tile's pixels, if efficiency decides.
    fn plan(&mut self, tile: &Tile) {
        if let Some(planner) = &mut self.planner {
            planner.plan(tile, &mut self.planned);
        }
    }

    /// Adds a pixel, whose samples are planned as the `i`-th, to the pixels to be rendered.
    fn push_place(&mut self, index: usize, at: (u32, u32), i: usize) {
        let mut rounds = self.renderer.view.rounds;
        if let Some(&n_samples) = self.planned.get(i) {
            rounds = rounds.with_samples(n_samples);
        }
        self.places.push(PixelPlace { at, index, rounds });
    }

    /// Renders the pixels and times them. Returns their number.
    ///
    /// The first pixels are rendered in a separate loop to fill the caches, as jumping to other
    /// pixels in the timed loop causes branch mispredictions.
    fn render_timed(&mut self) -> usize {
        let (places, renderer, stopwatch) = (&self.places, &mut self.renderer, &mut self.stopwatch);
        let times_ns = &mut self.times_ns[..places.len()];
        let is_going_on = |_: &usize| !stop::is_requested();
        // Warm up the caches.
        let n_warm_up = N_WARM_UP.min(places.len() / 4).max(1);
        let begin_ns = stopwatch.cpu_ns();
        for i in (0..n_warm_up).take_while(is_going_on) {
            renderer.render_pixel(places[i], i);
        }
        self.warm_up_ns = stopwatch.cpu_ns() - begin_ns;
        // Time each pixel.
        stopwatch.lap();
        let mut n_done = 0;
        for i in (0..places.len()).take_while(is_going_on) {
            renderer.render_pixel(places[i], i);
            times_ns[i] = stopwatch.lap();
            stopwatch.take_waits_off(&mut times_ns[..=i]);
            n_done = i + 1;
        }
        for ns in &mut times_ns[..n_done] {
            *ns = (*ns - self.overhead_ns).max(1.0);
        }
        n_done
    }
}

impl PixelRenderer<'_> {
    /// Renders a pixel, the `i`-th, in place: a copy would take as long as a ray.
    ///
    /// Never inlined, so that the same code is timed the first time and again.
    #[inline(never)]
    fn render_pixel(&mut self, place: PixelPlace, i: usize) {
        let PixelPlace { at, index, rounds } = place;
        self.bounces.reset_pixel(index);
        let pixel = &mut self.pixels[i];
        *pixel = Pixel::default();
        let mut probe = CountedPixel {
            view: &self.view,
            pixel,
            cost: Cost::default(),
            bounces: &mut self.bounces,
            index,
        };
        let (sums, n_samples) = follow(&self.view, &rounds, at, &mut self.paths, &mut probe);
        self.costs[i] = probe.cost;
        // Average the samples.
        pixel.color = sums.colors.into();
        if self.view.rounds.keeps_noise {
            pixel.noise = sums.noise(n_samples);
        }
        self.view.finish(pixel, n_samples, at);
    }
}

/// Counts the rays of a pixel, and keeps what it sees.
struct CountedPixel<'a> {
    view: &'a View<'a>,
    pixel: &'a mut Pixel,
    cost: Cost,
    bounces: &'a mut BounceCounts,
    /// Number of the pixel in the tile.
    index: usize,
}

impl PathProbe for CountedPixel<'_> {
    #[inline]
    fn trace(&mut self, path: &PathRay) -> Option<SurfacePoint> {
        self.cost.bounce(path.depth);
        self.bounces.add(self.index, path.depth, 1);
        let tracer = &self.view.tracer;
        let hit = tracer.trace_after(path.length, &path.ray, path.kind, &mut self.cost);
        // The camera ray of the middle sample stores the visible surface.
        if path.depth == 0
            && path.id.sample == self.view.middle
            && let Some(point) = &hit
        {
            self.pixel.set_surface(point);
        }
        hit
    }

    #[inline]
    fn shade(
        &mut self,
        eye: Vec3,
        path: &PathRay,
        met: Option<&SurfacePoint>,
        next: &mut Vec<PathRay>,
    ) -> Vec3 {
        let View { tracer, shader, .. } = self.view;
        // End in the background, or shade the point by the light that arrives.
        let Some(point) = met else {
            return shader.miss(path);
        };
        let mut arriving = |sample: LightSample| {
            if !shader.casts_shadows() {
                return Some(sample.light);
            }
            self.bounces.add(self.index, path.depth, 1);
            let share = tracer.light_along(&sample.shadow, &mut self.cost);
            sample.light.weakened_to(share)
        };
        let lights = shader.light_samples(path, point);
        let lights = lights.filter_map(&mut arriving);
        shader.shade(eye, path, point, lights, next)
    }
}

impl TileRenderer for SingleRayRenderer<'_> {
    fn render(&mut self, tile: &Tile) {
        let n_pixels = tile.n_pixels();
        let begin_ns = self.stopwatch.cpu_ns();
        self.plan(tile);
        let planning_ns = self.stopwatch.cpu_ns() - begin_ns;
        self.places.clear();
        for (x, y) in tile.pixels() {
            let index = tile.index(x, y) as usize;
            self.push_place(index, (x, y), index);
        }
        self.renderer.bounces.reset(n_pixels);
        self.n_done = self.render_timed();
        self.warm_up_ns += planning_ns;
    }

    /// Copies the pixels to rows, which is not part of their times.
    fn rendered(&mut self) -> Rendered<'_> {
        let n_pixels = self.places.len();
        let PixelRenderer { view, pixels, .. } = &self.renderer;
        self.counters.reset(n_pixels, view.rounds.n_uniform());
        self.time_ns.resize(n_pixels, 0.0);
        for (i, &PixelPlace { index, .. }) in self.places.iter().enumerate() {
            self.columns.set(index, &pixels[i]);
            self.time_ns[index] = self.times_ns[i];
            if i < self.n_done {
                self.counters.add(index, &self.renderer.costs[i]);
            }
        }
        Rendered {
            pixels: &self.columns,
            counters: Some(&self.counters),
            bounces: self.renderer.bounces.get(),
            time_ns: &self.time_ns,
            warm_up_ns: self.warm_up_ns,
        }
    }

    fn stopwatch(&mut self) -> &mut Stopwatch {
        &mut self.stopwatch
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tiles::stream::StreamRenderer;
    use crate::tiles::{TilePlan, mirrors};
    use scene::build::Sensor;
    use scene::config::Tiling;
    use tracer::accel::Accel;
    use tracer::trace::Tracer;

    #[test]
    fn a_warm_up_is_timed_and_not_counted() {
        let (config, scene) = mirrors(320, 320);
        let accel = Accel::new(&scene, config.acceleration);
        let tracer = Tracer::new(&scene, &accel);
        let plan = TilePlan::new(tracer, &Sensor::new(&scene, &config), Tiling::default());
        let view = View::new(tracer, &plan.sensor);
        let clock = Clock::calibrated();
        let mut cold = StreamRenderer::<Counters>::new(view);
        let mut warm = SingleRayRenderer::new(view, &clock, plan.room());
        for number in [0, 200, 399] {
            let tile = plan.tile(number).unwrap();
            cold.render(&tile);
            warm.render(&tile);
            let [cold, warm] = [cold.rendered(), warm.rendered()];
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
}
