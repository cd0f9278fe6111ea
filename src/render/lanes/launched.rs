//! The warps in which a device traces the rays of a picture: the warps of its launches.

use std::sync::{Mutex, PoisonError};

use super::WarpSums;
use crate::film::Film;
use crate::schedule::Tile;
use crate::tiles::{OnProgress, View, recount};
use math::sampling::Sampler;
use scene::build::Sensor;
use tracer::accel::{CountRay, Hit, PathStream, RayDevice, ShadowStream, TakePath};
use tracer::cost::{Counter, Counters, DeviceLaunch, FollowedPath};
use tracer::trace::Tracer;
use world::camera::RayCone;
use world::geometry::RayStream;

/// The warps of a query's launches on a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LaunchedWarps {
    /// The name of the query: `nearest`, `occluded`, or `path` for whole paths.
    pub query: &'static str,
    /// Number of rays of a warp.
    pub warp: u32,
    /// The steps of the rays and of their warps.
    pub sums: WarpSums,
}

/// Lets the device of a tracer trace all rays of a film once more. Returns the warps of its
/// launches, and the share of idle lanes of each pixel, as [`IdleLanes`](super::IdleLanes) has
/// them; `None` without a device, and if it does not say how large its warps are.
pub(super) fn measure(
    tracer: Tracer,
    sensor: &Sensor,
    film: &Film,
    report: OnProgress,
) -> Option<(Vec<LaunchedWarps>, Vec<f32>)> {
    let device = WarpCounter {
        device: tracer.accel.device()?,
        warps: Mutex::default(),
    };
    let accel = tracer.accel.clone().with_device(Some(&device));
    let view = View::new(Tracer::new(tracer.scene, &accel), sensor);
    let width = film.grid.width as usize;
    let of_pixels = Mutex::new(vec![f32::NAN; film.samples().len()]);
    let keep = |part: &Tile, counters: &Counters| {
        let [steps, lane_steps] = [Counter::NodeVisits, Counter::PrimitiveTests];
        let (steps, lane_steps) = (counters.get(steps), counters.get(lane_steps));
        let mut of_pixels = of_pixels.lock().unwrap_or_else(PoisonError::into_inner);
        for (x, y) in part.pixels() {
            let i = part.index(x, y) as usize;
            let share = 1.0 - steps[i] as f64 / lane_steps[i] as f64;
            of_pixels[y as usize * width + x as usize] = share as f32;
        }
    };
    recount(view, film, keep, report);
    let of_pixels = of_pixels.into_inner();
    let warps = device.warps.into_inner();
    let mut warps = warps.unwrap_or_else(PoisonError::into_inner);
    warps.sort_by_key(|warps| warps.query);
    let of_pixels = of_pixels.unwrap_or_else(PoisonError::into_inner);
    (!warps.is_empty()).then_some((warps, of_pixels))
}

/// A device that reports, in place of the counters of each ray, the steps of its warp: as node visits
/// the steps of the warp's rays, as primitive tests the steps of all of its lanes.
#[derive(Debug)]
struct WarpCounter<'a> {
    device: &'a dyn RayDevice,
    warps: Mutex<Vec<LaunchedWarps>>,
}

impl WarpCounter<'_> {
    /// Adds the warps of a launch, given the steps of its rays.
    fn add(&self, query: &'static str, launch: DeviceLaunch, steps: &[u64], count: CountRay) {
        let Some(warp) = launch.warp_size else {
            return;
        };
        let mut all = WarpSums::default();
        for (number, steps) in steps.chunks(warp).enumerate() {
            let sums = WarpSums::of_warp(steps.iter().copied(), warp as u32);
            for i in 0..steps.len() {
                let [steps, lane_steps] =
                    [sums.steps, sums.lane_steps].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
                count(number * warp + i, steps, lane_steps);
            }
            all = all.with(sums);
        }
        let mut warps = self.warps.lock().unwrap_or_else(PoisonError::into_inner);
        let warp = warp as u32;
        let same = |one: &&mut LaunchedWarps| (one.query, one.warp) == (query, warp);
        match warps.iter_mut().find(same) {
            Some(one) => one.sums = one.sums.with(all),
            None => warps.push(LaunchedWarps {
                query,
                warp,
                sums: all,
            }),
        }
    }
}

impl RayDevice for WarpCounter<'_> {
    fn nearest(
        &self,
        rays: &RayStream,
        hits: &mut Vec<Option<Hit>>,
        count: CountRay,
    ) -> DeviceLaunch {
        let mut steps = vec![0; rays.len()];
        let launch = self.device.nearest(rays, hits, &mut |i, visits, tests| {
            steps[i] = u64::from(visits) + u64::from(tests);
        });
        self.add("nearest", launch, &steps, count);
        launch
    }

    fn occluded(
        &self,
        rays: &ShadowStream,
        occluded: &mut Vec<bool>,
        count: CountRay,
    ) -> DeviceLaunch {
        let mut steps = vec![0; rays.rays().len()];
        let launch = self
            .device
            .occluded(rays, occluded, &mut |i, visits, tests| {
                steps[i] = u64::from(visits) + u64::from(tests);
            });
        self.add("occluded", launch, &steps, count);
        launch
    }

    fn follows_paths(&self, sampler: &Sampler, cone: Option<RayCone>) -> bool {
        self.device.follows_paths(sampler, cone)
    }

    fn follow(&self, paths: &PathStream, take: TakePath) -> DeviceLaunch {
        let mut followed = vec![(FollowedPath::default(), None); paths.rays.len()];
        let launch = self.device.follow(paths, &mut |i, path, hit| {
            followed[i] = (*path, hit);
        });
        let steps = followed.iter().map(|(path, _)| path.cost);
        let steps: Vec<u64> = steps
            .map(|cost| cost.node_visits + cost.primitive_tests)
            .collect();
        self.add("path", launch, &steps, &mut |i, steps, lane_steps| {
            let (mut path, hit) = followed[i];
            path.cost.node_visits = steps.into();
            path.cost.primitive_tests = lane_steps.into();
            take(i, &path, hit);
        });
        launch
    }
}
