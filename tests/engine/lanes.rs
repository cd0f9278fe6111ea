//! Idle lanes of warps are those of the rays of each pixel, traced one at a time.

use std::collections::BTreeMap;
use std::sync::Mutex;

use crate::common::generators::cases;
use crate::common::scenes::scenes;
use crate::common::{config, film_on, parse, scene_of, with_cost};
use base::Keyword;
use math::sampling::PixelPattern;
use math::simd::Simd;
use proptest::prelude::*;
use render::attribution::{PathObserver, RayTree, TracedRay};
use render::film::Film;
use render::lanes::{IdleLanes, LAUNCH_SIDE, LaneKind, WarpSums};
use render::schedule::TileGrid;
use render::tiles::render;
use scene::build::Sensor;
use scene::config::{Config, CostMode, RayOrder, Warps};
use tracer::accel::{Accel, CountRay, Hit, RayDevice, ShadowStream};
use tracer::cost::{Counter, DeviceLaunch, Meter, RayKind, StreamProbe, Traversals};
use tracer::trace::Tracer;
use world::geometry::RayStream;

/// Measures the idle lanes of a config; also returns the film.
fn measured(config: &Config, n_threads: usize, simd: Simd, warps: Warps) -> (IdleLanes, Film) {
    let film = film_on(config, n_threads, simd);
    let scene = scene_of(config);
    let accel = Accel::new(&scene, config.acceleration).with_simd(simd);
    let sensor = Sensor::new(&scene, config);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
    let idle = pool.build().unwrap().install(|| {
        IdleLanes::measure(Tracer::new(&scene, &accel), &sensor, &film, warps, &|_| {})
    });
    (idle, film)
}

/// A ray, and those that are launched with it: in a block, of a sample, of a kind, after a number of
/// bounces, the shadow ray of a number.
struct Lane {
    launch: ([u32; 2], u32, LaneKind, u32, usize),
    pixel: (u32, u32),
    octant: [bool; 3],
    material: Option<u32>,
    steps: u64,
}

/// The lanes of all rays, pixel by pixel and ray by ray.
fn lanes_of_rays(config: &Config) -> BTreeMap<(u32, u32), Vec<Lane>> {
    let scene = scene_of(config);
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let observer = PathObserver::new(tracer, &Sensor::new(&scene, config), None).without_steps();
    let material = |ray: &TracedRay| {
        let hit = ray.surface()?;
        Some(scene.primitives[hit.primitive as usize].material.0)
    };
    let mut lanes = BTreeMap::new();
    let mut tree = RayTree::default();
    for y in 0..config.image.height {
        for x in 0..config.image.width {
            observer.observe((x, y), &mut tree);
            let lane = |(i, ray): (usize, &TracedRay)| {
                let kind = match ray.kind {
                    RayKind::Camera => LaneKind::Camera,
                    RayKind::Shadow => LaneKind::Shadow,
                    _ => LaneKind::Bounce,
                };
                let is_sibling = |other: &&TracedRay| {
                    ray.kind == RayKind::Shadow
                        && other.kind == RayKind::Shadow
                        && other.parent == ray.parent
                };
                let before = tree.rays[..i].iter().rev();
                let number = before.take_while(is_sibling).count();
                let block = [x / LAUNCH_SIDE, y / LAUNCH_SIDE];
                let parent = ray.parent.map(|parent| &tree.rays[parent as usize]);
                Lane {
                    launch: (block, ray.sample, kind, ray.bounce, number),
                    pixel: (x, y),
                    octant: ray.ray.direction.to_array().map(f32::is_sign_negative),
                    material: parent.and_then(material),
                    steps: u64::from(ray.node_visits) + u64::from(ray.primitive_tests),
                }
            };
            lanes.insert((x, y), tree.rays.iter().enumerate().map(lane).collect());
        }
    }
    lanes
}

/// The pixels of a picture in the order of rays.
fn pixels(config: &Config, order: RayOrder) -> Vec<(u32, u32)> {
    let (width, height) = (config.image.width, config.image.height);
    let mut pixels = Vec::new();
    match order {
        RayOrder::Rows => {
            pixels.extend((0..height).flat_map(|y| (0..width).map(move |x| (x, y))));
        }
        RayOrder::Tiles | RayOrder::Octant | RayOrder::Material => {
            for top in (0..height).step_by(4) {
                for left in (0..width).step_by(8) {
                    let columns = left..width.min(left + 8);
                    let rows = top..height.min(top + 4);
                    pixels.extend(rows.flat_map(|y| columns.clone().map(move |x| (x, y))));
                }
            }
        }
        RayOrder::Morton => {
            let side = width.max(height).next_power_of_two();
            add_quadrants([0, 0], side, &mut pixels);
            pixels.retain(|&(x, y)| x < width && y < height);
        }
        RayOrder::Waves => {
            let grid = TileGrid::new(width, height, config.tiles.size);
            pixels.extend((0..grid.n_tiles()).flat_map(|number| grid.tile(number).pixels()));
        }
    }
    pixels
}

/// Adds the pixels of a square: of its quadrants at the upper left, the upper right, the lower left
/// and the lower right.
fn add_quadrants([left, top]: [u32; 2], side: u32, pixels: &mut Vec<(u32, u32)>) {
    if side == 1 {
        return pixels.push((left, top));
    }
    let half = side / 2;
    for [x, y] in [[0, 0], [half, 0], [0, half], [half, half]] {
        add_quadrants([left + x, top + y], half, pixels);
    }
}

/// The sums of one kind of rays, and the share of each pixel, row by row, all of it in 64 bits.
fn twin(config: &Config, warps: Warps) -> (BTreeMap<LaneKind, WarpSums>, Vec<f64>) {
    let of_pixels = lanes_of_rays(config);
    let in_order = pixels(config, warps.order);
    let in_order = in_order.iter().flat_map(|pixel| &of_pixels[pixel]);
    let mut launches: BTreeMap<_, Vec<&Lane>> = BTreeMap::new();
    for lane in in_order {
        launches.entry(lane.launch).or_default().push(lane);
    }
    let mut sums: BTreeMap<LaneKind, WarpSums> = BTreeMap::new();
    let mut shares: BTreeMap<(u32, u32), [u64; 2]> = BTreeMap::new();
    for ((_, _, kind, ..), mut rays) in launches {
        match warps.order {
            // From the last axis to the first.
            RayOrder::Octant => rays.sort_by_key(|lane| {
                let [x, y, z] = lane.octant;
                [z, y, x]
            }),
            RayOrder::Material => {
                rays.sort_by_key(|lane| (lane.material.is_none(), lane.material));
            }
            _ => {}
        }
        for warp in rays.chunks(warps.warp as usize) {
            let steps: u64 = warp.iter().map(|lane| lane.steps).sum();
            let most = warp.iter().map(|lane| lane.steps).max().unwrap();
            let lane_steps = most * u64::from(warps.warp);
            let of_kind = sums.entry(kind).or_default();
            of_kind.n_rays += warp.len() as u64;
            of_kind.n_warps += 1;
            of_kind.steps += steps;
            of_kind.lane_steps += lane_steps;
            for lane in warp {
                let share = shares.entry(lane.pixel).or_default();
                *share = [share[0] + steps, share[1] + lane_steps];
            }
        }
    }
    let share = |pixel| {
        let [steps, lane_steps] = shares[&pixel];
        1.0 - steps as f64 / lane_steps as f64
    };
    let shares = pixels(config, RayOrder::Rows).into_iter().map(share);
    (sums, shares.collect())
}

/// Checks idle lanes against rays that were traced one at a time.
fn assert_is_twin(config: &Config, warps: Warps) {
    let (idle, film) = measured(config, 2, Simd::best(), warps);
    let (expected, shares) = twin(config, warps);
    for kind in LaneKind::ALL {
        let expected = expected.get(&kind).copied().unwrap_or_default();
        assert_eq!(idle.sums(Some(kind), warps), expected, "{warps:?} {kind:?}");
    }
    let bits = |share: &f32| if share.is_nan() { 0 } else { share.to_bits() };
    let shares: Vec<u32> = shares.iter().map(|&share| bits(&(share as f32))).collect();
    assert_eq!(idle.of_pixels.iter().map(bits).collect::<Vec<_>>(), shares);
    // The rays and their steps are the same as in the rendering.
    let all = idle.sums(None, warps);
    assert_eq!(all.n_rays, film.totals.n_rays());
    let [visits, tests] = [Counter::NodeVisits, Counter::PrimitiveTests];
    assert_eq!(all.steps, film.totals.get(visits) + film.totals.get(tests));
    let cameras = idle.sums(Some(LaneKind::Camera), warps).n_rays;
    assert_eq!(cameras, film.totals.rays_of(RayKind::Camera));
}

proptest! {
    #![proptest_config(cases(10))]

    #[test]
    fn idle_lanes_of_random_scenes_are_those_of_single_rays(
        scene in scenes(),
        warp in prop::sample::select(&Warps::SIZES),
        order in prop::sample::select(RayOrder::KEYWORDS),
        tile_size in 2_u32..40,
    ) {
        let mut config = with_cost(scene.config(), CostMode::Counters);
        config.tiles.size = tile_size;
        assert_is_twin(&config, Warps { warp, order });
    }
}

#[test]
fn launches_end_at_the_edges_of_blocks() {
    let mut config = with_cost(config("glass"), CostMode::Counters);
    config.image.samples_per_pixel = 1;
    for (width, height) in [(2 * LAUNCH_SIDE + 3, 5), (9, LAUNCH_SIDE + 2)] {
        (config.image.width, config.image.height) = (width, height);
        for order in [RayOrder::Rows, RayOrder::Tiles, RayOrder::Material] {
            assert_is_twin(&config, Warps { warp: 64, order });
        }
    }
    // Morton curves and raycost's tiles that blocks do not cut.
    (config.image.width, config.image.height) = (LAUNCH_SIDE, 20);
    for order in [RayOrder::Morton, RayOrder::Waves] {
        assert_is_twin(&config, Warps { warp: 8, order });
    }
}

#[test]
fn threads_instruction_sets_and_tiles_change_no_bit() {
    let mut config = with_cost(config("cornell_box"), CostMode::Counters);
    (config.image.width, config.image.height) = (50, 37);
    config.image.samples_per_pixel = 3;
    let warps = Warps::default();
    let bits = |idle: &IdleLanes| -> Vec<u32> {
        idle.of_pixels.iter().map(|share| share.to_bits()).collect()
    };
    let (expected, _) = measured(&config, 1, Simd::best(), warps);
    for (n_threads, simd, tile_size) in [
        (2, Simd::best(), 16),
        (3, Simd::available()[0], 16),
        (3, Simd::best(), 7),
    ] {
        config.tiles.size = tile_size;
        let (found, _) = measured(&config, n_threads, simd, warps);
        assert_eq!(bits(&found), bits(&expected));
        for &order in RayOrder::KEYWORDS {
            let warps = Warps { order, ..warps };
            let is_same = found.sums(None, warps) == expected.sums(None, warps);
            assert!(is_same || order == RayOrder::Waves && tile_size == 7);
        }
    }
}

#[test]
fn adaptive_samples_are_launched_as_they_are_rendered() {
    let mut config = config("cornell_box");
    (config.image.width, config.image.height) = (16, 12);
    let text = "{ noise: 0.05, min_samples: 2 }";
    config.image.adaptive = Some(scene::yaml::from_str(text).unwrap());
    config.image.samples_per_pixel = 20;
    assert_is_twin(&with_cost(config, CostMode::Counters), Warps::default());
}

/// A device that is the processor, in warps of this many rays; it notes the query of each launch and
/// the steps of its rays.
#[derive(Debug)]
struct Lockstep<'a> {
    accel: &'a Accel<'a>,
    warp: Option<usize>,
    launches: Mutex<Vec<(&'static str, Vec<u64>)>>,
}

/// The node visits and the primitive tests of each ray of a stream.
struct Counts(Vec<[u32; 2]>);

impl StreamProbe for Counts {
    const COUNTS: bool = true;

    fn traversals<const N: usize>(&mut self, first: usize, traversals: &Traversals<N>) {
        traversals.for_each(|i, visits, tests| self.0[first + i] = [visits, tests]);
    }
}

impl Lockstep<'_> {
    /// Notes a launch, and reports the counters of its rays.
    fn launch(&self, query: &'static str, counts: &Counts, count: CountRay) -> DeviceLaunch {
        let steps = |&[visits, tests]: &[u32; 2]| u64::from(visits) + u64::from(tests);
        let steps = counts.0.iter().map(steps).collect();
        self.launches.lock().unwrap().push((query, steps));
        for (i, &[visits, tests]) in counts.0.iter().enumerate() {
            count(i, visits, tests);
        }
        DeviceLaunch {
            ns: 0.0,
            warp_size: self.warp,
        }
    }

    /// The sums of a query's launches.
    fn sums(&self, query: &str, warp: usize) -> WarpSums {
        let mut sums = WarpSums::default();
        for (of, steps) in self.launches.lock().unwrap().iter() {
            for steps in steps.chunks(warp).filter(|_| *of == query) {
                sums.n_rays += steps.len() as u64;
                sums.n_warps += 1;
                sums.steps += steps.iter().sum::<u64>();
                sums.lane_steps += warp as u64 * steps.iter().max().unwrap();
            }
        }
        sums
    }
}

impl RayDevice for Lockstep<'_> {
    fn nearest(
        &self,
        rays: &RayStream,
        hits: &mut Vec<Option<Hit>>,
        count: CountRay,
    ) -> DeviceLaunch {
        let mut counts = Counts(vec![[0; 2]; rays.len()]);
        self.accel.nearest_stream(rays, hits, &mut counts);
        self.launch("nearest", &counts, count)
    }

    fn occluded(
        &self,
        rays: &ShadowStream,
        occluded: &mut Vec<bool>,
        count: CountRay,
    ) -> DeviceLaunch {
        let mut counts = Counts(vec![[0; 2]; rays.len()]);
        self.accel.occluded_stream(rays, occluded, &mut counts);
        self.launch("occluded", &counts, count)
    }
}

/// Measures the idle lanes of a config on a device with warps of this size, and checks that the
/// warps of its launches are measured.
fn on_device(config: &Config, warp: Option<usize>) -> (IdleLanes, Film) {
    let film = film_on(config, 2, Simd::best());
    let scene = scene_of(config);
    let accel = Accel::new(&scene, config.acceleration);
    let device = Lockstep {
        accel: &accel,
        warp,
        launches: Mutex::default(),
    };
    let on_device = accel.clone().with_device(Some(&device));
    let (tracer, sensor) = (Tracer::new(&scene, &on_device), Sensor::new(&scene, config));
    let idle = IdleLanes::measure(tracer, &sensor, &film, Warps::default(), &|_| {});
    for launched in &idle.launched {
        assert_eq!(Some(launched.warp as usize), warp);
        assert_eq!(launched.sums, device.sums(launched.query, warp.unwrap()));
    }
    (idle, film)
}

#[test]
fn a_device_has_the_warps_of_its_launches() {
    let glass = |adaptive: Option<&str>| {
        let mut config = with_cost(config("glass"), CostMode::Counters);
        (config.image.width, config.image.height) = (45, 34);
        config.image.samples_per_pixel = 6;
        config.image.sampler = PixelPattern::Sobol;
        config.image.adaptive = adaptive.map(|text| scene::yaml::from_str(text).unwrap());
        config
    };
    for adaptive in [
        None,
        Some("{ noise: 0.05, min_samples: 2 }"),
        Some("{ by: efficiency, min_samples: 2 }"),
    ] {
        let config = glass(adaptive);
        let (idle, film) = on_device(&config, Some(12));
        let queries: Vec<_> = idle
            .launched
            .iter()
            .map(|launched| launched.query)
            .collect();
        assert_eq!(queries, ["nearest", "occluded"]);
        // The rays and their steps are the same as in the rendering.
        let [nearest, occluded] = [0, 1].map(|i| idle.launched[i].sums);
        let [visits, tests] = [Counter::NodeVisits, Counter::PrimitiveTests];
        let steps = film.totals.get(visits) + film.totals.get(tests);
        assert_eq!(nearest.steps + occluded.steps, steps, "{adaptive:?}");
        assert_eq!(occluded.n_rays, film.totals.rays_of(RayKind::Shadow));
        assert_eq!(nearest.n_rays + occluded.n_rays, film.totals.n_rays());
        let lane_steps = nearest.lane_steps + occluded.lane_steps;
        let share = 1.0 - steps as f64 / lane_steps as f64;
        assert_eq!(idle.share(Warps::default()), share);
        // The orders are those without a device.
        let (without, _) = measured(&config, 2, Simd::best(), Warps::default());
        for &order in RayOrder::KEYWORDS {
            let warps = Warps { warp: 16, order };
            assert_eq!(idle.sums(None, warps), without.sums(None, warps));
        }
        // A device that does not say how large its warps are has none.
        let (unknown, _) = on_device(&config, None);
        assert_eq!(unknown, without);
    }
}

/// Camera rays only, of whole tiles: the same warps as in the order of waves.
#[test]
fn pixels_have_the_idle_lanes_of_the_device() {
    let mut config = with_cost(config("spot"), CostMode::Counters);
    (config.image.width, config.image.height) = (64, 48);
    config.image.samples_per_pixel = 1;
    config.lights.clear();
    config.tiles.size = 16;
    let (idle, _) = on_device(&config, Some(16));
    let waves = Warps {
        warp: 16,
        order: RayOrder::Waves,
    };
    let (expected, _) = measured(&config, 2, Simd::best(), waves);
    assert_eq!(idle.launched.len(), 1);
    assert_eq!(idle.launched[0].sums, expected.sums(None, waves));
    assert!(idle.of_pixels.iter().any(|&share| share > 0.1));
    let bits = |idle: &IdleLanes| {
        idle.of_pixels
            .iter()
            .map(|n| n.to_bits())
            .collect::<Vec<_>>()
    };
    assert_eq!(bits(&idle), bits(&expected));
}

/// Each ray is tested against both spheres: the lanes without a ray idle, and no other.
#[test]
fn equal_rays_idle_only_where_a_launch_ends() {
    let config = parse(
        "
image: { width: 6, height: 5 }
camera: { orthographic: { eye: [0, 0, 5], target: [0, 0, 0], height: 1 } }
acceleration: brute_force
cost: counters
materials: { plain: { color: 1 } }
lights: [{ point: { position: [0, 9, 9] } }]
objects:
  - { sphere: { center: [0, 0, 0], radius: 3 }, material: plain }
  - { sphere: { center: [9, 0, 0], radius: 1 }, material: plain }
",
    );
    let warps = Warps {
        warp: 16,
        order: RayOrder::Rows,
    };
    let (idle, _) = measured(&config, 1, Simd::best(), warps);
    let sums = idle.sums(Some(LaneKind::Camera), warps);
    let expected = WarpSums {
        n_rays: 30,
        n_warps: 2,
        steps: 60,
        lane_steps: 64,
    };
    assert_eq!(sums, expected);
    assert_eq!(sums.idle_share(), 1.0 - 30.0 / 32.0);
    assert_eq!(idle.sums(Some(LaneKind::Bounce), warps).n_rays, 0);
    // Shadow rays stop at the first hit, if it is before their light: none is.
    let shadows = idle.sums(Some(LaneKind::Shadow), warps);
    assert_eq!([shadows.n_warps, shadows.steps], [2, 60]);
    assert!(idle.of_pixels[..16].iter().all(|&share| share == 0.0));
    assert!(idle.of_pixels[16..].iter().all(|&share| share == 0.125));
}

#[test]
fn pixels_without_rays_have_no_share() {
    let mut config = with_cost(config("spot"), CostMode::Counters);
    (config.image.width, config.image.height) = (20, 12);
    let scene = scene_of(&config);
    let accel = Accel::new(&scene, config.acceleration);
    let (tracer, sensor) = (Tracer::new(&scene, &accel), Sensor::new(&scene, &config));
    let plan = render::tiles::TilePlan::new(tracer, &sensor, config.tiles);
    let (mut film, _) = render(tracer, &plan, &Meter::new(config.cost), &|_| {});
    film.tiles[0].is_missing = true;
    let idle = IdleLanes::measure(tracer, &sensor, &film, Warps::default(), &|_| {});
    for (i, share) in idle.of_pixels.iter().enumerate() {
        assert_eq!(share.is_nan(), i % 20 < 16, "{i}");
    }
    assert!(idle.sums(None, Warps::default()).n_rays >= 4 * 12);
}
