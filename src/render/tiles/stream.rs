//! Wavefront rendering: all camera rays of a tile, then their shadow rays, then the reflected rays,
//! and so on until all paths have ended. Each step is a loop over lanes.
//!
//! After Laine, Karras and Aila, "Megakernels Considered Harmful: Wavefront Path Tracing on GPUs",
//! HPG 2013.

use std::ops::Range;

use glam::Vec3;

use super::TileRenderer;
use super::camera_rays::{AddSamples, FinishPixels, Places, StartPaths};
use super::noisy_pixels::NoisyPixels;
use super::rounds::FirstSamples;
use super::view::View;
use super::wave_times::{ByStage, CountStages, StageColumns, WaveStage, WaveTimes};
use crate::film::{Pixel, PixelColumns, Rendered};
use crate::schedule::Tile;
use base::stop;
use math::simd::{N_LANES, Simd, VectorColumn};
use tracer::accel::{Hit, PathStream, RayDevice};
use tracer::cost::{BounceCounts, ByPixel, Clock, Counter, PixelProbe, RayKind, Stopwatch};
use tracer::shade::{Eyes, PathStarts, PathWave, SampleIds, WaveShader};
use tracer::trace::{Points, ShadowLight};

/// Greatest number of paths in flight at a time, unless a tile has more pixels: enough to keep the
/// kernel busy, few enough to stay in the cache between two steps.
const WAVE_LEN: usize = 2048;
/// The same for a device, which needs many rays at a time.
const DEVICE_WAVE_LEN: usize = 262_144;

/// The starts of the wave's paths.
macro_rules! starts {
    ($renderer:expr) => {
        PathStarts {
            eyes: match $renderer.view.eye() {
                Some(eye) => Eyes::One(eye),
                None => Eyes::OfSlots(&$renderer.eyes),
            },
            ids: &$renderer.ids,
        }
    };
}

/// Renders tiles in waves of rays and counts with a `P`. All buffers are reused from tile to tile.
pub(super) struct StreamRenderer<'a, P> {
    view: View<'a>,
    simd: Simd,
    places: Places,
    noisy: NoisyPixels,
    /// The planned number of samples of each pixel; empty if noise decides.
    pub(super) planned: Vec<u32>,
    pixels: PixelColumns,
    probe: P,
    bounces: BounceCounts,
    stopwatch: Stopwatch,
    /// The times of the waves' stages, if they are measured.
    times: Option<WaveTimes>,
    wave: PathWave,
    /// The next wave.
    next: PathWave,
    hits: Vec<Option<Hit>>,
    points: Points,
    shader: WaveShader<'a>,
    /// The light along the shadow rays.
    lights: ShadowLight,
    /// The origins of the camera rays by slot, unless all start at one point.
    eyes: Vec<Vec3>,
    /// The samples by slot, in a scene that needs random numbers.
    ids: SampleIds,
    /// The samples by ray, for a device that follows the paths.
    samples: Vec<[u32; 2]>,
    /// The media by ray, for the same.
    media: Vec<[u32; 4]>,
    /// The color of each path, by slot.
    colors: VectorColumn,
    /// The color of each pixel, in the order of `places`.
    means: VectorColumn,
    /// The distance of each pixel's surface; NaN without one.
    distances: Vec<f32>,
    footprints: Vec<f32>,
}

impl<'a, P: PixelProbe> StreamRenderer<'a, P> {
    pub(super) fn new(view: View<'a>) -> Self {
        let simd = view.tracer.simd();
        Self {
            view,
            simd,
            places: Places::default(),
            noisy: NoisyPixels::default(),
            planned: Vec::new(),
            pixels: PixelColumns::default(),
            probe: P::default(),
            bounces: BounceCounts::new(view.counts_bounces),
            stopwatch: Stopwatch::start(Clock::system()),
            times: None,
            wave: PathWave::default(),
            next: PathWave::default(),
            hits: Vec::new(),
            points: Points::default(),
            shader: view.shader.wave_shader(simd),
            lights: ShadowLight::default(),
            eyes: Vec::new(),
            ids: SampleIds::default(),
            samples: Vec::new(),
            media: Vec::new(),
            colors: VectorColumn::default(),
            means: VectorColumn::default(),
            distances: Vec::new(),
            footprints: Vec::new(),
        }
    }

    /// Creates a renderer that times the stages of its waves.
    pub(super) fn timed(view: View<'a>, clock: &Clock) -> Self {
        Self {
            stopwatch: Stopwatch::start(*clock),
            times: Some(WaveTimes::new(view.rounds.n_uniform())),
            ..Self::new(view)
        }
    }

    /// Traces all paths of these pixels. Each has a number (0, 1, … in any order), a column and a
    /// row.
    pub(super) fn follow(&mut self, places: impl Iterator<Item = (u32, (u32, u32))>) {
        self.places.fill(places);
        self.begin(self.places.len());
        self.follow_places();
    }

    /// Starts with `n_pixels` pixels and empty counters.
    pub(super) fn begin(&mut self, n_pixels: usize) {
        self.pixels.resize(n_pixels);
        self.probe.reset(n_pixels, self.view.rounds.n_uniform());
        self.bounces.reset(n_pixels);
        if let Some(times) = &mut self.times {
            times.begin_tile(n_pixels);
        }
    }

    /// Traces all paths of the pixels in `places`.
    fn follow_places(&mut self) {
        self.begin_places();
        let first = self.view.rounds.first();
        if self.view.rounds.measure_noise() {
            self.noisy.begin(&self.places);
            self.render_adaptively(first);
        } else {
            self.render_round(first);
        }
    }

    /// Starts with empty sums of the pixels in `places`.
    fn begin_places(&mut self) {
        let n_pixels = self.places.len();
        self.means.reset(n_pixels);
        self.distances.clear();
        self.distances.resize(n_pixels + N_LANES, f32::NAN);
    }

    /// Renders the first samples of a tile's pixels, whose numbers of samples are planned then.
    pub(super) fn render_first(&mut self, tile: &Tile) {
        self.begin(tile.n_pixels());
        self.places.fill_group(tile, tile);
        self.begin_places();
        self.noisy.begin(&self.places);
        self.render_counted(self.view.rounds.first());
    }

    /// Renders the other samples of the tile's pixels, by their planned numbers.
    pub(super) fn render_planned(&mut self) {
        let next = self.end_round(self.view.rounds.first().end);
        self.render_adaptively(next);
        self.finish_places();
    }

    /// Renders rounds of samples until no pixel needs more.
    fn render_adaptively(&mut self, mut round: Range<u32>) {
        while self.places.len() > 0 && !round.is_empty() && !stop::is_requested() {
            self.render_counted(round.clone());
            round = self.end_round(round.end);
        }
        self.noisy.end(&mut self.places);
        if !self.view.rounds.keeps_noise {
            return;
        }
        for i in 0..self.places.len() {
            let (number, _) = self.places.get(i);
            self.pixels.noise[number] = self.noisy.noise(i, &self.means);
        }
    }

    /// Renders a round of the noisy pixels, and counts its samples.
    fn render_counted(&mut self, round: Range<u32>) {
        let n_samples = round.len();
        self.render_round(round);
        if self.view.rounds.are_adaptive() {
            for i in 0..self.places.len() {
                let (number, _) = self.places.get(i);
                self.probe.camera_rays(number, n_samples);
            }
        }
    }

    /// Removes the pixels that need no more than `n` samples. Returns the next round.
    fn end_round(&mut self, n: u32) -> Range<u32> {
        let rounds = &self.view.rounds;
        let (places, means) = (&mut self.places, &self.means);
        (self.noisy).end_round(places, means, rounds, n, &self.planned);
        rounds.after(n)
    }

    /// Returns the columns and rows of the pixels in the order in which they started, while all need
    /// samples.
    pub(super) fn started(&self) -> impl Iterator<Item = (u32, u32)> {
        (0..self.places.len()).map(|i| self.places.get(i).1)
    }

    /// Returns the variance and the cost of the first samples of a pixel, by its position in the
    /// order in which pixels started, before others are rendered.
    pub(super) fn first_samples(&self, i: usize) -> FirstSamples {
        let sums = self.noisy.sums(i, &self.means);
        let (number, _) = self.places.get(i);
        let counters = self.probe.counted();
        let count = |counter| counters.map_or(0, |counters| counters.get(counter)[number]);
        let cost = count(Counter::NodeVisits) + count(Counter::PrimitiveTests);
        self.view.rounds.first_samples(&sums, cost)
    }

    /// Renders these samples of all pixels in waves.
    fn render_round(&mut self, samples: Range<u32>) {
        let is_on_device = self.view.tracer.accel.device().is_some();
        let wave_len = if is_on_device {
            DEVICE_WAVE_LEN
        } else {
            WAVE_LEN
        };
        let n_per_wave = (wave_len / self.places.len()).max(1);
        for first in samples.clone().step_by(n_per_wave) {
            if stop::is_requested() {
                break;
            }
            self.render_samples(first..samples.end.min(first + n_per_wave as u32));
        }
    }

    /// Returns the counters of the pixels last followed.
    pub(super) fn probe(&self) -> &P {
        &self.probe
    }

    /// Ends a stage of the wave, if waves are timed.
    #[inline]
    fn lap(&mut self, stage: WaveStage) {
        if let Some(times) = &mut self.times {
            self.stopwatch.add_device_ns(self.probe.take_device_ns());
            times.lap(stage, &mut self.stopwatch);
        }
    }

    /// Renders these samples of all pixels.
    fn render_samples(&mut self, samples: Range<u32>) {
        // Start a path for each sample.
        self.start(samples.clone());
        self.count_samples(samples.len() as u32);
        self.lap(WaveStage::Paths);
        // Trace and shade the camera rays; the middle sample stores the visible surfaces.
        let middle = samples.contains(&self.view.middle);
        let stored = middle.then(|| (self.view.middle - samples.start) as usize);
        let stored = stored.map(|sample| (sample, samples.len()));
        if let Some(device) = self.view.path_device() {
            self.follow_on(device, stored);
        } else {
            self.trace(stored);
            self.shade();
            // Trace and shade the rays that continue the paths, until all have ended.
            while !self.wave.rays.is_empty() {
                self.trace(None);
                self.shade();
            }
        }
        // Add the colors of the paths to their pixels.
        if self.view.rounds.measure_noise() {
            let sums = [&mut self.colors, &mut self.means];
            let add = self.noisy.add(&self.view, &self.places, samples, sums);
            return self.simd.run(add);
        }
        self.simd.run(AddSamples {
            view: &self.view,
            places: &self.places,
            n_samples: samples.len(),
            colors: &self.colors,
            sums: &mut self.means,
        });
    }

    /// Counts the camera rays of all pixels by bounce.
    fn count_samples(&mut self, n_samples: u32) {
        if self.bounces.is_kept() {
            for i in 0..self.places.len() {
                let (number, _) = self.places.get(i);
                self.bounces.add(number, 0, n_samples);
            }
        }
    }

    /// Starts a path for each of these samples of all pixels.
    fn start(&mut self, samples: Range<u32>) {
        // Make room for the paths.
        let n_slots = N_LANES * self.places.n_blocks() * samples.len();
        self.colors.reset(n_slots);
        self.wave.restart(0);
        let is_random = self.shader.is_random();
        if is_random {
            self.ids.resize(n_slots);
        }
        // Generate the camera rays.
        self.simd.run(StartPaths {
            view: &self.view,
            places: &self.places,
            samples,
            wave: &mut self.wave,
            ids: is_random.then_some(&mut self.ids),
        });
        // Initialize the data that only some scenes need.
        if self.shader.has_branches() {
            self.wave.start_branches(&self.view.eye_media);
        }
        if self.shader.measures_paths() {
            self.wave.measure();
        }
        if self.view.eye().is_none() {
            self.eyes.resize(n_slots, Vec3::ZERO);
            for (ray, &slot) in self.wave.rays.iter().zip(self.wave.slots()) {
                self.eyes[slot as usize] = ray.origin;
            }
        }
    }

    /// Lets a device follow the paths of the wave from the camera to their ends; `stored` as in
    /// [`trace`](Self::trace).
    fn follow_on(&mut self, device: &dyn RayDevice, stored: Option<(usize, usize)>) {
        let Self {
            wave,
            ids,
            samples,
            media,
            hits,
            probe,
            bounces,
            colors,
            ..
        } = self;
        ids.write(wave.slots(), samples);
        wave.write_media(media);
        hits.clear();
        hits.resize(wave.rays.len(), None);
        let (pixels, slots) = (wave.pixels(), wave.slots());
        let paths = PathStream {
            rays: &wave.rays,
            samples,
            media,
        };
        let launch = device.follow(&paths, &mut |i, path, hit| {
            let pixel = pixels[i] as usize;
            hits[i] = hit;
            colors.add(slots[i] as usize, path.color);
            probe.path(pixel, path);
            bounces.add_all(pixel, &path.bounces);
        });
        probe.launched(launch);
        // All steps of a path are charged by its node visits and primitive tests.
        self.lap(WaveStage::Hierarchy);
        if let Some((sample, n_samples)) = stored {
            self.find_points();
            self.store_surfaces(sample, n_samples);
            self.lap(WaveStage::Paths);
        }
    }

    /// Finds the points that the wave's rays meet. If `stored` is a sample's index and the number
    /// of samples, first stores the surfaces that the camera rays of this sample hit.
    fn trace(&mut self, stored: Option<(usize, usize)>) {
        // Find the nearest hits.
        let probe = ByPixel::new(&mut self.probe, self.wave.pixels());
        let tracer = &self.view.tracer;
        tracer.nearest_stream(&self.wave.rays, &mut self.hits, probe);
        self.lap(WaveStage::Hierarchy);
        // Compute their surface points, which the film stores without fog.
        let has_particles = self.shader.has_particles();
        if stored.is_some() || !has_particles {
            self.find_points();
        }
        if let Some((sample, n_samples)) = stored {
            self.store_surfaces(sample, n_samples);
        }
        // Replace hits by particles of fog that lie before them.
        if has_particles {
            self.shader
                .meet_particles(&self.ids, &self.wave, &mut self.hits);
            self.find_points();
        }
        if let Some(times) = &mut self.times {
            times.count_misses(self.wave.pixels(), self.points.missed());
        }
        self.lap(WaveStage::Paths);
    }

    /// Computes the points of the wave's hits.
    fn find_points(&mut self) {
        (self.view.tracer).group_hits(&self.hits, &mut self.points);
        self.lap(WaveStage::Paths);
        let Self { wave, hits, .. } = self;
        let tracer = &self.view.tracer;
        tracer.surface_points(wave.lengths(), &wave.rays, hits, &mut self.points);
        self.lap(WaveStage::Surfaces);
    }

    /// Stores the surfaces that the camera rays of one of `n_samples` samples hit.
    fn store_surfaces(&mut self, sample: usize, n_samples: usize) {
        for i in 0..self.places.len() {
            let (block, lane) = (i / N_LANES, i % N_LANES);
            let ray = N_LANES * n_samples * block + sample * self.places.in_block(block) + lane;
            let (number, _) = self.places.get(i);
            let mut pixel = Pixel::default();
            if let Some(point) = self.points.by_ray(ray) {
                [pixel.position, pixel.normal] = self.points.position_and_normal(point);
                let [object, material] = self.points.object_and_material(point);
                (pixel.object, pixel.material) = (object as i32, material as i32);
                pixel.set_instance(self.points.instance(point));
                pixel.albedo = self.points.color(point);
                self.distances[i] = self.points.distance(point);
                pixel.distance = self.view.unit * self.distances[i];
            }
            self.pixels.set(number, &pixel);
        }
    }

    /// Shades the points; the reflected rays become the wave.
    fn shade(&mut self) {
        // Weaken the light on the way to the hits; add the background to the rays without a hit.
        self.shader.weaken(&mut self.wave, &self.hits);
        let (wave, points) = (&self.wave, &self.points);
        self.shader.add_background(wave, points, &mut self.colors);
        self.lap(WaveStage::Paths);
        // Light the points: ambient and emitted light, then one light sample after the other.
        self.shader.begin(&self.wave, &self.points);
        self.count_shadow_steps();
        for sample in 0..self.shader.n_light_samples(self.wave.depth) {
            self.light(sample);
        }
        self.count_shadow_steps();
        // End the paths' steps: add the radiance of the points, and collect the rays that continue.
        let starts = starts!(self);
        let (wave, points) = (&self.wave, &self.points);
        self.shader
            .end(starts, wave, points, &mut self.next, &mut self.colors);
        // Count the next wave.
        let (pixels, depth) = (self.next.pixels(), self.next.depth);
        if P::COUNTS {
            for (kind, rays) in self.next.kinds() {
                self.probe.rays_of_pixels(kind, &pixels[rays]);
            }
        }
        self.probe.bounce(pixels, depth);
        self.bounces.add_to_pixels(pixels, depth);
        std::mem::swap(&mut self.wave, &mut self.next);
        self.lap(WaveStage::Surfaces);
    }

    /// Adds the light of one sample of the lights at all points.
    fn light(&mut self, sample: usize) {
        // Cast the shadow rays toward the light.
        let (wave, points) = (&self.wave, &self.points);
        self.shader.cast(sample, starts!(self), wave, points);
        self.lap(WaveStage::Surfaces);
        // Trace them.
        let shadows = &self.shader.shadows;
        if self.shader.casts_shadows() {
            (self.probe).rays_of_pixels(RayKind::Shadow, shadows.pixels());
            (self.bounces).add_to_pixels(shadows.pixels(), self.wave.depth);
            let probe = ByPixel::new(&mut self.probe, shadows.pixels());
            let tracer = &self.view.tracer;
            tracer.shadow_stream(&shadows.rays, &mut self.lights, probe);
            self.lap(WaveStage::ShadowRays);
        } else {
            self.lights.shares.clear();
            self.lights.shares.resize(shadows.pixels().len(), 1.0);
        }
        // Add the light that arrives.
        let (wave, points) = (&self.wave, &self.points);
        let lights = &self.lights.shares;
        self.shader
            .add_light(sample, starts!(self), wave, points, lights);
        self.lap(WaveStage::Surfaces);
    }

    /// Counts the steps of shadow rays if waves are timed; called before and after they are traced.
    fn count_shadow_steps(&mut self) {
        if self.shader.casts_shadows()
            && let (Some(times), Some(counters)) = (&mut self.times, self.probe.counted())
        {
            times.count_shadow_steps(counters);
        }
    }

    /// Renders a group of a tile's pixels. Returns the nanoseconds of each stage since the end of
    /// the last lap, if waves are timed.
    pub(super) fn render_group(&mut self, tile: &Tile, group: &Tile) -> ByStage {
        self.places.fill_group(tile, group);
        if let Some(times) = &mut self.times {
            times.begin(tile, group);
        }
        self.render_places();
        let times = self.times.as_mut();
        times.map_or(ByStage::default(), |times| times.end(&mut self.stopwatch))
    }

    /// Writes the counts of the stages of waves, for the pixels and the groups of a tile, if waves
    /// are timed.
    pub(super) fn count_stages(
        &self,
        tile: &Tile,
        groups: &[Tile],
        of_pixels: &mut StageColumns,
        of_groups: &mut Vec<ByStage>,
    ) {
        if let (Some(times), Some(counters)) = (&self.times, self.probe.counted()) {
            self.simd.run(CountStages {
                times,
                counters,
                tile,
                groups,
                of_pixels,
                of_groups,
            });
        }
    }

    /// Renders the pixels in `places`.
    fn render_places(&mut self) {
        self.follow_places();
        self.finish_places();
    }

    /// Writes the results of the pixels in `places`.
    fn finish_places(&mut self) {
        let rounds = &self.view.rounds;
        // Divide the sums of colors by the numbers of samples, and compute footprints.
        self.simd.run(FinishPixels {
            view: &self.view,
            places: &self.places,
            n_samples: rounds.measure_noise().then(|| self.noisy.n_samples()),
            colors: &mut self.means,
            distances: &self.distances,
            footprints: &mut self.footprints,
        });
        // Copy the results to the pixels.
        for i in 0..self.places.len() {
            let (number, _) = self.places.get(i);
            self.pixels.color[number] = self.means.get(i);
            let position = self.pixels.position[number];
            self.pixels.footprint[number] = self.view.footprint(position, self.footprints[i]);
        }
        self.lap(WaveStage::Paths);
    }
}

impl<P: PixelProbe> TileRenderer for StreamRenderer<'_, P> {
    fn render(&mut self, tile: &Tile) {
        self.begin(tile.n_pixels());
        self.render_group(tile, tile);
    }

    fn rendered(&mut self) -> Rendered<'_> {
        Rendered {
            pixels: &self.pixels,
            counters: self.probe.counted(),
            bounces: self.bounces.get(),
            time_ns: &[],
            warm_up_ns: 0.0,
        }
    }

    fn stopwatch(&mut self) -> &mut Stopwatch {
        &mut self.stopwatch
    }
}
