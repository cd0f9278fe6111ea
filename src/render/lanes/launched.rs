//! The warps in which a device traces the rays of a picture: the warps of its launches.

use std::sync::{Mutex, PoisonError};

use super::{IdleLanes, WarpSums};
use crate::film::Film;
use crate::schedule::Tile;
use crate::tiles::{OnProgress, View, recount};
use base::locked;
use math::sampling::Sampler;
use scene::build::Sensor;
use tracer::accel::{CountRay, Hit, PathStream, RayDevice, ShadowStream, TakePath};
use tracer::cost::{Counter, Counters, DeviceLaunch, FollowedPath, RayKind};
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
/// launches, and of each pixel the share of idle lanes, the cycles and the multiprocessor; `None`
/// without a device, and if it does not say how large its warps are.
pub(super) fn measure(
    tracer: Tracer,
    sensor: &Sensor,
    film: &Film,
    report: OnProgress,
) -> Option<IdleLanes> {
    let device = WarpCounter {
        device: tracer.accel.device()?,
        warps: Mutex::default(),
    };
    let accel = tracer.accel.clone().with_device(Some(&device));
    let view = View::new(Tracer::new(tracer.scene, &accel), sensor);
    let width = film.grid.width as usize;
    let n_pixels = film.samples().len();
    let found = Mutex::new(IdleLanes {
        of_pixels: vec![f32::NAN; n_pixels],
        cycles: vec![0.0; n_pixels],
        sms: vec![-1; n_pixels],
        ..IdleLanes::default()
    });
    let keep = |part: &Tile, counters: &Counters| {
        let [steps, lane_steps, cycles, sms] =
            [STEPS, LANE_STEPS, CYCLES, NEXT_SM].map(|counter| counters.get(counter));
        let mut found = locked(&found);
        for (x, y) in part.pixels() {
            let (i, pixel) = (part.index(x, y) as usize, y as usize * width + x as usize);
            let at = |counts: &[u64]| counts.get(i).copied().unwrap_or(0);
            found.of_pixels[pixel] = (1.0 - at(steps) as f64 / at(lane_steps) as f64) as f32;
            found.cycles[pixel] = at(cycles) as f32;
            found.sms[pixel] = at(sms) as i32 - 1;
        }
    };
    recount(view, film, keep, report);
    let mut found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    found.launched = std::mem::take(&mut *locked(&device.warps));
    // Of other queries, the counters are of rays.
    let follows = (found.launched.iter()).any(|warps| warps.query == "path");
    if !follows || found.cycles.iter().all(|&cycles| cycles == 0.0) {
        found.cycles.clear();
    }
    if !follows || found.sms.iter().all(|&sm| sm < 0) {
        found.sms.clear();
    }
    found.launched.sort_by_key(|warps| warps.query);
    (!found.launched.is_empty()).then_some(found)
}

/// The counters in whose place a [`WarpCounter`] reports the steps of a warp's rays and of all of its
/// lanes, the cycles of a path, and the number of its multiprocessor plus 1.
const STEPS: Counter = Counter::NodeVisits;
const LANE_STEPS: Counter = Counter::PrimitiveTests;
const CYCLES: Counter = Counter::ReflectionRays;
const NEXT_SM: Counter = Counter::Depth;

/// A device that reports, in place of the counters of each ray, the steps of its warp, and for a path
/// its cycles and its multiprocessor.
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
        let mut warps = locked(&self.warps);
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
            path.cost.rays[RayKind::Reflection as usize] = path.cycles.unwrap_or(0).into();
            path.cost.depth = path.sm.map_or(0, |sm| u64::from(sm) + 1);
            take(i, &path, hit);
        });
        launch
    }
}
