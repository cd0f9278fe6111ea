//! Idle lanes: how well a SIMT machine, such as a graphics card, would be used by a picture's rays.
//!
//! A warp traces as many rays as it has lanes in lockstep: it takes as many steps as its longest
//! ray, and the lanes of shorter rays idle. The steps of a ray are its node visits and primitive
//! tests, which are exact: no card is needed.
//!
//! Rays are traced in launches, as a wavefront path tracer does: of a block of [`LAUNCH_SIDE`] x
//! [`LAUNCH_SIDE`] pixels the camera rays of one sample, the rays after a number of bounces, the
//! first shadow ray of each of their hits, the second, and so on. The rays of a launch, without
//! gaps, fill warps in a [`RayOrder`]. In the last warp of a launch, lanes without a ray idle.
//!
//! A device has warps of its own: it traces all rays once more, in the [launches](LaunchedWarps) of a
//! rendering.
//!
//! The rays are traced once more after the rendering, one at a time. All sums are of integers: they
//! do not depend on threads, on instruction sets or on the tiles of the rendering, except for
//! [`RayOrder::Waves`], which is the order in these tiles.

mod launches;
mod order;
mod launched;

use rayon::prelude::*;

use crate::film::Film;
use crate::schedule::TileGrid;
use crate::tiles::{OnProgress, Progress, View};
use base::{Keyword, stop};
use launches::{LaneRay, Launches, PixelBlock, trace};
use scene::build::Sensor;
use scene::config::{Image, RayOrder, Warps};
use tracer::trace::Tracer;

pub use launched::LaunchedWarps;
pub use launches::{LAUNCH_SIDE, LaneKind};

/// The idle lanes of a picture.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct IdleLanes {
    /// By kind of ray, by order, and by size of warp.
    sums: [[[WarpSums; N_WARPS]; N_ORDERS]; LaneKind::ALL.len()],
    /// The warps of the launches on the device that traced the rays; empty without one, and if it
    /// does not say how large they are.
    pub launched: Vec<LaunchedWarps>,
    /// The share of idle lanes, 0 to 1, of the warps that trace the rays of each pixel, of the
    /// device's if there are any: a warp counts once for each ray. Row-major, row 0 on top; NaN for
    /// a pixel whose warps take no steps.
    pub of_pixels: Vec<f32>,
    /// The cycles of the device's clock for the paths of each pixel; empty if the device has no clock
    /// or does not follow whole paths.
    pub cycles: Vec<f32>,
    /// The multiprocessor that followed the paths of each pixel, or the last of several, -1 without
    /// samples; empty if the device does not say.
    pub sms: Vec<i32>,
}

const N_WARPS: usize = Warps::SIZES.len();
const N_ORDERS: usize = RayOrder::KEYWORDS.len();

/// The steps of some rays and of the warps that trace them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WarpSums {
    /// Number of rays.
    pub n_rays: u64,
    /// Number of warps.
    pub n_warps: u64,
    /// Node visits and primitive tests of the rays.
    pub steps: u64,
    /// Steps of all lanes, the idle ones included: lanes times the greatest number of steps of a
    /// ray, summed over the warps.
    pub lane_steps: u64,
}

impl WarpSums {
    /// Returns the sums of one warp of this many lanes, given the steps of its rays.
    fn of_warp(steps: impl ExactSizeIterator<Item = u64> + Clone, warp: u32) -> Self {
        Self {
            n_rays: steps.len() as u64,
            n_warps: 1,
            steps: steps.clone().sum(),
            lane_steps: u64::from(warp) * steps.max().unwrap_or(0),
        }
    }

    /// Adds both.
    fn with(self, other: Self) -> Self {
        Self {
            n_rays: self.n_rays + other.n_rays,
            n_warps: self.n_warps + other.n_warps,
            steps: self.steps + other.steps,
            lane_steps: self.lane_steps + other.lane_steps,
        }
    }

    /// Returns the share of idle lanes, 0 to 1; NaN without steps.
    pub fn idle_share(&self) -> f64 {
        1.0 - self.steps as f64 / self.lane_steps as f64
    }
}

impl IdleLanes {
    /// Traces all rays of a film of this scene, which was rendered with counters, on the current
    /// rayon pool, and once more on the device that the structure has. `warps` are those of
    /// [`of_pixels`](Self::of_pixels) without a device. `report` is called after each sample of a
    /// block, and for a device after each tile: the pixels are counted twice then.
    pub fn measure(
        tracer: Tracer,
        sensor: &Sensor,
        film: &Film,
        warps: Warps,
        report: OnProgress,
    ) -> Self {
        let view = View::new(tracer, sensor);
        let n_samples = film.samples();
        let mut found = Self {
            of_pixels: vec![f32::NAN; n_samples.len()],
            ..Self::default()
        };
        for block in PixelBlock::all(film.grid.width, film.grid.height) {
            if stop::is_requested() {
                break;
            }
            found.add_block(&view, &film.grid, &block, &n_samples, warps, report);
        }
        match launched::measure(tracer, sensor, film, report) {
            Some(on_device) => Self {
                sums: found.sums,
                ..on_device
            },
            None => found,
        }
    }

    /// Adds the rays of a block.
    fn add_block(
        &mut self,
        view: &View,
        grid: &TileGrid,
        block: &PixelBlock,
        n_samples: &[u32],
        warps: Warps,
        report: OnProgress,
    ) {
        let width = grid.width as usize;
        let index = |place: (u32, u32)| place.1 as usize * width + place.0 as usize;
        let most = block.pixels().map(|place| n_samples[index(place)]).max();
        let most = most.unwrap_or(0);
        let mut pixels = vec![WarpSums::default(); (LAUNCH_SIDE * LAUNCH_SIDE) as usize];
        for sample in (0..most).take_while(|_| !stop::is_requested()) {
            let has_sample = |place| sample < n_samples[index(place)];
            let launches = trace(view, block, sample, has_sample);
            let n_rays = launches.values().map(Vec::len).sum::<usize>() as u64;
            self.add_launches(grid, block, &launches, warps, &mut pixels);
            report(Progress {
                n_pixels: if sample == 0 { block.n_pixels() } else { 0 },
                n_rays,
                work: block.n_pixels() as f64 / f64::from(most),
                is_restored: false,
            });
        }
        for place in block.pixels() {
            self.of_pixels[index(place)] = pixels[block.index(place)].idle_share() as f32;
        }
    }

    /// Adds launches to the sums, and the warps of the chosen order and size to those of the pixels.
    fn add_launches(
        &mut self,
        grid: &TileGrid,
        block: &PixelBlock,
        launches: &Launches,
        warps: Warps,
        pixels: &mut [WarpSums],
    ) {
        let unsorted = launches.iter().flat_map(|(launch, rays)| {
            let orders = RayOrder::KEYWORDS.iter();
            orders.map(move |&order| (launch.kind, order, rays))
        });
        let unsorted: Vec<_> = unsorted.collect();
        let sorted = unsorted.into_par_iter().map(|(kind, order, rays)| {
            let rays = order::sorted(rays, order, grid, block);
            let sums = Warps::SIZES.map(|warp| fill(&rays, warp));
            let of_pixels = (order == warps.order).then_some(rays);
            (kind, order, sums, of_pixels)
        });
        let sorted: Vec<_> = sorted.collect();
        for (kind, order, sums, of_pixels) in sorted {
            let all = &mut self.sums[kind as usize][order as usize];
            for (all, sums) in all.iter_mut().zip(sums) {
                *all = all.with(sums);
            }
            if let Some(rays) = of_pixels {
                add_to_pixels(&rays, warps.warp, pixels);
            }
        }
    }

    /// Returns the share of idle lanes, 0 to 1, of all rays: of the device's launches, or without
    /// them in warps of one of [`Warps::SIZES`]; NaN without steps.
    pub fn share(&self, warps: Warps) -> f64 {
        let of_launches = self.launched.iter().map(|launched| launched.sums);
        match of_launches.reduce(WarpSums::with) {
            Some(sums) => sums.idle_share(),
            None => self.sums(None, warps).idle_share(),
        }
    }

    /// Returns the sums over the rays of one kind, or over all rays, in warps of one of
    /// [`Warps::SIZES`].
    pub fn sums(&self, kind: Option<LaneKind>, warps: Warps) -> WarpSums {
        let size = Warps::SIZES.iter().position(|warp| *warp == warps.warp);
        let kinds = LaneKind::ALL.into_iter();
        let kinds = kinds.filter(|other| kind.is_none_or(|kind| *other == kind));
        let sums = kinds.map(|kind| match size {
            Some(size) => self.sums[kind as usize][warps.order as usize][size],
            None => WarpSums::default(),
        });
        sums.fold(WarpSums::default(), WarpSums::with)
    }

    /// Returns an upper bound of the bytes of a block's rays, if they are as many as in usual
    /// scenes, and of the shares of all pixels.
    pub fn estimate_bytes(image: &Image) -> u64 {
        let n_pixels = image.n_pixels() as u64;
        let n_rays = RAYS_PER_SAMPLE * n_pixels.min(u64::from(LAUNCH_SIDE * LAUNCH_SIDE));
        // Rays row by row, launch by launch, and sorted; numbers of samples, shares, and strips.
        3 * n_rays * size_of::<LaneRay>() as u64 + 3 * n_pixels * size_of::<f32>() as u64
    }
}

/// Rays of a sample in usual scenes.
const RAYS_PER_SAMPLE: u64 = 16;

/// Fills warps of this many lanes with the rays. Returns their sums.
fn fill(rays: &[LaneRay], warp: u32) -> WarpSums {
    let warps = rays.chunks(warp as usize);
    let warps = warps.map(|rays| WarpSums::of_warp(steps(rays), warp));
    warps.fold(WarpSums::default(), WarpSums::with)
}

/// Returns the steps of some rays.
fn steps(rays: &[LaneRay]) -> impl ExactSizeIterator<Item = u64> + Clone {
    rays.iter().map(|ray| u64::from(ray.steps))
}

/// Adds the steps of the warps of one launch to the pixels of their rays.
fn add_to_pixels(rays: &[LaneRay], warp: u32, pixels: &mut [WarpSums]) {
    for rays in rays.chunks(warp as usize) {
        let sums = WarpSums::of_warp(steps(rays), warp);
        for ray in rays {
            let pixel = &mut pixels[ray.pixel as usize];
            *pixel = pixel.with(sums);
        }
    }
}
