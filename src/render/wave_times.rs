//! The times of the stages of a group's waves → the times of its pixels.
//!
//! The rays of a wave cannot be timed one by one, but each stage of the wave can. The time of
//! a stage is split over the pixels of the group in proportion to what that stage counts: the
//! more samples pixels have, the fewer of them share a group.

use crate::cost::{Clock, Counter, Counters, Instant};

/// The stages of a wave.
#[derive(Debug, Clone, Copy)]
pub(super) enum WaveStage {
    /// Camera rays start, and samples become pixels; split by samples.
    Samples,
    /// The hierarchy is searched for the nearest hits; by node visits and primitive tests.
    Hierarchy,
    /// The surfaces at the hits are found, and shading begins; by hits.
    Surfaces,
    /// Light samples are drawn and added; by hits.
    Lights,
    /// Shadow rays are traced; by their node visits and primitive tests.
    ShadowRays,
    /// Paths go on or end; by rays, without those of shadows.
    Paths,
}

const N_STAGES: usize = 6;

/// A number for each stage.
pub(super) type ByStage = [f64; N_STAGES];

/// The rays that continue paths.
const PATH_RAYS: [Counter; 3] = [
    Counter::ReflectionRays,
    Counter::RefractionRays,
    Counter::DiffuseRays,
];

/// The times of the stages of one group, and what they count of the pixels of a tile.
#[derive(Debug)]
pub(super) struct WaveTimes<'a> {
    clock: &'a Clock,
    /// The end of the last stage.
    begin: Instant,
    ns: ByStage,
    /// Samples of every pixel; 0 if they are counted.
    n_samples: u32,
    /// Whether pixels are rendered that count.
    counts: bool,
    /// Surfaces that the rays of each pixel have hit.
    hits: Vec<u64>,
    /// Node visits and primitive tests of the shadow rays of each.
    shadow_steps: Vec<u64>,
}

impl<'a> WaveTimes<'a> {
    pub(super) fn new(clock: &'a Clock, n_samples: u32) -> Self {
        Self {
            clock,
            begin: clock.now(),
            ns: ByStage::default(),
            n_samples,
            counts: true,
            hits: Vec::new(),
            shadow_steps: Vec::new(),
        }
    }

    /// Begins a tile of so many pixels.
    pub(super) fn begin_tile(&mut self, n_pixels: usize) {
        if self.counts {
            for counts in [&mut self.hits, &mut self.shadow_steps] {
                counts.clear();
                counts.resize(n_pixels, 0);
            }
        }
    }

    /// Begins a group.
    pub(super) fn begin(&mut self) {
        self.ns = ByStage::default();
        self.begin = self.clock.now();
    }

    /// Ends a stage, and begins the next one.
    pub(super) fn lap(&mut self, stage: WaveStage) {
        let end = self.clock.now();
        self.ns[stage as usize] += f64::from(self.clock.elapsed_ns(self.begin, end));
        self.begin = end;
    }

    /// The nanoseconds of each stage of the group.
    pub(super) fn ns(&self) -> ByStage {
        self.ns
    }

    /// Begins or ends rendering pixels that do not count.
    pub(super) fn set_counting(&mut self, counts: bool) {
        self.counts = counts;
    }

    /// Counts the surfaces that the rays of these pixels have hit.
    pub(super) fn count_hits<T>(&mut self, pixels: &[u32], hits: &[Option<T>]) {
        if self.counts {
            for (&pixel, hit) in pixels.iter().zip(hits) {
                self.hits[pixel as usize] += u64::from(hit.is_some());
            }
        }
    }

    /// Counts the steps of shadow rays, which are traced between two calls: one before them
    /// and one after them.
    pub(super) fn count_shadow_steps(&mut self, counters: &Counters, pixels: &[u32]) {
        if self.counts {
            for &pixel in pixels {
                let pixel = pixel as usize;
                self.shadow_steps[pixel] = steps(counters, pixel) - self.shadow_steps[pixel];
            }
        }
    }

    /// What each stage counts of a pixel.
    #[inline]
    pub(super) fn counts(&self, counters: &Counters, pixel: usize) -> ByStage {
        let shadow_steps = self.shadow_steps[pixel];
        let nearest_steps = steps(counters, pixel) - shadow_steps;
        let count = |counter| counters.get(counter).get(pixel).copied().unwrap_or(0);
        let n_samples = u64::from(self.n_samples) + count(Counter::Samples);
        let n_rays = n_samples + PATH_RAYS.map(count).iter().sum::<u64>();
        let hits = self.hits[pixel];
        [n_samples, nearest_steps, hits, hits, shadow_steps, n_rays].map(|n| n as f64)
    }
}

/// The node visits and the primitive tests of a pixel so far.
#[inline]
fn steps(counters: &Counters, pixel: usize) -> u64 {
    let count = |counter| counters.get(counter)[pixel];
    count(Counter::NodeVisits) + count(Counter::PrimitiveTests)
}
