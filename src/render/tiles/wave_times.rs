//! The times of the stages of a group's waves → the times of its pixels.
//!
//! The rays of a wave cannot be timed one by one, but each stage of the wave can. The time of a
//! stage is split over the pixels of the group in proportion to the counts of that stage: the more
//! samples pixels have, the fewer of them share a group.

use std::ops::Range;

use crate::schedule::Tile;
use math::simd::{InstructionSet, Lanes, SimdKernel};
use tracer::cost::{Counter, Counters, Stopwatch};

/// The stages of a wave.
#[derive(Debug, Clone, Copy)]
pub(super) enum WaveStage {
    /// Searching the hierarchy for the nearest hits; by node visits and primitive tests.
    Hierarchy,
    /// Finding, shading and lighting the surfaces at the hits, and continuing paths; by hits.
    Surfaces,
    /// Tracing shadow rays; by their node visits and primitive tests.
    ShadowRays,
    /// Starting paths, ending them, and writing pixels; by rays, without shadow rays.
    Paths,
}

const N_STAGES: usize = 4;

/// A number for each stage.
pub(super) type ByStage = [f32; N_STAGES];

/// The numbers of each stage for the pixels of a tile.
pub(super) type StageColumns = [Vec<f32>; N_STAGES];

/// The steps of a traversal.
const STEPS: [Counter; 2] = [Counter::NodeVisits, Counter::PrimitiveTests];

/// The rays of paths; camera rays are counted where pixels differ in samples.
const PATH_RAYS: [Counter; 4] = [
    Counter::Samples,
    Counter::ReflectionRays,
    Counter::RefractionRays,
    Counter::DiffuseRays,
];

/// The times of the stages of one group, and their counts for the pixels of a tile.
#[derive(Debug)]
pub(super) struct WaveTimes {
    /// The nanoseconds of each step of the group's waves, and its stage.
    laps_ns: Vec<f32>,
    stages: Vec<WaveStage>,
    /// Samples of every pixel; 0 if they are counted.
    n_samples: u32,
    /// Number of rays of each pixel that hit nothing.
    misses: Vec<u32>,
    /// Node visits and primitive tests of the shadow rays of each pixel.
    shadow_steps: Vec<u64>,
    /// The pixels of the group, row by row.
    rows: Vec<Range<usize>>,
}

impl WaveTimes {
    pub(super) fn new(n_samples: u32) -> Self {
        Self {
            laps_ns: Vec::new(),
            stages: Vec::new(),
            n_samples,
            misses: Vec::new(),
            shadow_steps: Vec::new(),
            rows: Vec::new(),
        }
    }

    /// Starts a tile of `n_pixels` pixels.
    pub(super) fn begin_tile(&mut self, n_pixels: usize) {
        self.misses.clear();
        self.misses.resize(n_pixels, 0);
        self.shadow_steps.clear();
        self.shadow_steps.resize(n_pixels, 0);
    }

    /// Starts a group of a tile.
    pub(super) fn begin(&mut self, tile: &Tile, group: &Tile) {
        self.rows.clear();
        self.rows.extend(tile.rows_of(group));
        self.laps_ns.clear();
        self.stages.clear();
    }

    /// Ends a step of a stage, and starts the next one.
    pub(super) fn lap(&mut self, stage: WaveStage, stopwatch: &mut Stopwatch) {
        self.laps_ns.push(stopwatch.lap());
        self.stages.push(stage);
    }

    /// Ends the group. Returns the nanoseconds of its stages, without waits for a CPU.
    pub(super) fn end(&mut self, stopwatch: &mut Stopwatch) -> ByStage {
        stopwatch.take_waits_off(&mut self.laps_ns);
        let mut ns = ByStage::default();
        for (stage, lap_ns) in self.stages.iter().zip(&self.laps_ns) {
            ns[*stage as usize] += lap_ns;
        }
        ns
    }

    /// Counts the rays of the wave's pixels that hit nothing.
    pub(super) fn count_misses(&mut self, pixels: &[u32], missed: &[u32]) {
        for &ray in missed {
            self.misses[pixels[ray as usize] as usize] += 1;
        }
    }

    /// Counts the steps of shadow rays, which are traced between two calls: one before them and one
    /// after them.
    pub(super) fn count_shadow_steps(&mut self, counters: &Counters) {
        for row in &self.rows {
            let steps = STEPS.map(|counter| &counters.get(counter)[row.clone()]);
            let shadow_steps = &mut self.shadow_steps[row.clone()];
            for (i, of_shadows) in shadow_steps.iter_mut().enumerate() {
                *of_shadows = steps[0][i] + steps[1][i] - *of_shadows;
            }
        }
    }
}

/// Writes the counts of each stage for the pixels of a tile and for its groups.
pub(super) struct CountStages<'a> {
    pub(super) times: &'a WaveTimes,
    pub(super) counters: &'a Counters,
    pub(super) tile: &'a Tile,
    pub(super) groups: &'a [Tile],
    pub(super) of_pixels: &'a mut StageColumns,
    pub(super) of_groups: &'a mut Vec<ByStage>,
}

impl SimdKernel for CountStages<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) {
        let Self {
            times, counters, ..
        } = self;
        let n_pixels = counters.n_pixels();
        self.of_pixels
            .iter_mut()
            .for_each(|column| column.resize(n_pixels, 0.0));
        let [hierarchy, surfaces, shadow_rays, paths] =
            self.of_pixels.each_mut().map(|column| &mut column[..]);
        paths.fill(times.n_samples as f32);
        for kind in PATH_RAYS {
            for (n_rays, &n) in paths.iter_mut().zip(counters.get(kind)) {
                *n_rays += single(n);
            }
        }
        for ((hits, n_rays), &misses) in surfaces.iter_mut().zip(&*paths).zip(&times.misses) {
            *hits = n_rays - misses as f32;
        }
        let [visits, tests] = STEPS.map(|counter| &counters.get(counter)[..n_pixels]);
        let of_shadows = &times.shadow_steps[..n_pixels];
        let columns = hierarchy.iter_mut().zip(shadow_rays);
        for (i, (hierarchy, shadow_rays)) in columns.enumerate() {
            *hierarchy = single(visits[i] + tests[i] - of_shadows[i]);
            *shadow_rays = single(of_shadows[i]);
        }
        self.of_groups.clear();
        for group in self.groups {
            let mut sums = [set.splat(0.0); N_STAGES];
            let mut rests = ByStage::default();
            for row in self.tile.rows_of(group) {
                let columns = self.of_pixels.iter().map(|column| &column[row.clone()]);
                for ((sum, sum_of_rest), column) in sums.iter_mut().zip(&mut rests).zip(columns) {
                    let (blocks, rest) = column.as_chunks();
                    blocks
                        .iter()
                        .for_each(|block| *sum = *sum + set.load(block));
                    rest.iter().for_each(|n| *sum_of_rest += n);
                }
            }
            let whole = sums.map(|sum| sum.to_array().into_iter().sum::<f32>());
            let sums = std::array::from_fn(|stage| whole[stage] + rests[stage]);
            self.of_groups.push(sums);
        }
    }
}

/// Converts a count below 2^52 to a float. Vectors of integers of 64 bits are converted only by
/// AVX-512DQ, and here by every set: the count becomes the fraction of a number whose exponent is
/// 52.
#[inline(always)]
fn single(count: u64) -> f32 {
    const TWO_TO_52: f64 = (1_u64 << 52) as f64;
    (f64::from_bits(TWO_TO_52.to_bits() | count) - TWO_TO_52) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_become_numbers() {
        for count in [0, 1, 2, 1 << 24, 123_456_789_012, (1 << 52) - 1] {
            assert_eq!(single(count), count as f32);
        }
    }
}
