//! The observed rays of a pixel are those of its rendering.

use crate::common::generators::cases;
use crate::common::scenes::scenes;
use crate::common::{config, counts, film, parse, rays, scene_of, with_cost};
use glam::Vec3;
use proptest::prelude::*;
use render::attribution::{PathObserver, RayTree, TooManyRays};
use render::film::Film;
use scene::build::Sensor;
use scene::config::{Config, CostMode, ShadingModel};
use tracer::accel::{Accel, TraversalStep};
use tracer::cost::{Clock, Cost, Counter, RayKind};
use tracer::trace::Tracer;
use world::geometry::{Aabb, Ray};

/// Calls `check` with the tree and the index of each pixel, and with the film.
fn observed(config: &Config, mut check: impl FnMut(&RayTree, usize, &Film)) {
    let film = film(&with_cost(config.clone(), CostMode::Counters), 1);
    let scene = scene_of(config);
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let observer = PathObserver::new(tracer, &Sensor::new(&scene, config), None);
    let mut tree = RayTree::default();
    for pixel in 0..config.image.n_pixels() {
        let [x, y] = [
            pixel as u32 % film.grid.width,
            pixel as u32 / film.grid.width,
        ];
        observer.observe((x, y), &mut tree);
        check(&tree, pixel, &film);
    }
}

/// A scene of `configs/` with a small image.
fn small(name: &str) -> Config {
    let mut config = config(name);
    (config.image.width, config.image.height) = (24, 18);
    config.image.samples_per_pixel = 2;
    config
}

const SCENES: [&str; 4] = ["seed_extended", "hall_of_mirrors", "spot", "blocks"];

/// Checks that the tree has the counters and the color of the film's pixel.
fn assert_is_pixel(tree: &RayTree, pixel: usize, film: &Film, model: ShadingModel) {
    let of = |counter| u64::from(counts(film, counter)[pixel]);
    let cost = tree.cost();
    assert_eq!(cost.node_visits, of(Counter::NodeVisits));
    assert_eq!(cost.primitive_tests, of(Counter::PrimitiveTests));
    assert_eq!(cost.n_rays(), u64::from(rays(film)[pixel]));
    assert_eq!(cost.rays_of(RayKind::Shadow), of(Counter::ShadowRays));
    assert_eq!(cost.depth, of(Counter::Depth));
    let shown = film.values(|strip| &strip.rgb).nth(pixel).unwrap();
    let color = tree.limited_color(model.sample_limit());
    // The order of the sum is not that of the film.
    let near = [0.99999, 1.00001].map(|factor| film.development.rgb8(factor * color));
    for ((shown, dark), bright) in shown.into_iter().zip(near[0]).zip(near[1]) {
        assert!(
            (dark..=bright).contains(&shown),
            "{color} is shown as {shown}"
        );
    }
    assert!(color.cmple(tree.color() + 1e-5).all());
}

/// Checks that each ray follows the one at whose hit it starts, and that a shadow
/// ray contributes at most as much as that one.
fn assert_is_tree(tree: &RayTree, n_lights: u32) {
    for (number, ray) in tree.rays.iter().enumerate() {
        let is_shadow = ray.kind == RayKind::Shadow;
        assert_eq!(ray.light.is_some(), is_shadow);
        assert!(ray.light.is_none_or(|light| light < n_lights));
        let Some(parent) = ray.parent else {
            assert_eq!((ray.kind, ray.bounce), (RayKind::Camera, 0));
            continue;
        };
        assert!((parent as usize) < number);
        let parent = &tree.rays[parent as usize];
        assert_eq!(parent.sample, ray.sample);
        assert!(parent.kind != RayKind::Shadow);
        let at = parent.ray.at(parent.end().unwrap());
        assert!(at.distance(ray.ray.origin) < 1e-3 * (1.0 + at.length()));
        if is_shadow {
            assert!((ray.contribution - parent.contribution).max_element() < 1e-5);
            assert!(ray.hit.is_none() || ray.contribution == Vec3::ZERO);
        }
    }
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn trees_of_random_scenes_match_their_pixels(scene in scenes()) {
        let config = scene.config();
        let n_lights = scene_of(&config).lights.n_sources() as u32;
        observed(&config, |tree, pixel, film| {
            assert_is_pixel(tree, pixel, film, config.shading.model);
            assert_is_tree(tree, n_lights);
        });
    }
}

#[test]
fn trees_of_the_example_scenes_match_their_pixels() {
    for name in SCENES {
        let config = small(name);
        observed(&config, |tree, pixel, film| {
            assert_is_pixel(tree, pixel, film, config.shading.model);
            assert_is_tree(tree, config.lights.len() as u32);
        });
    }
}

#[test]
fn shadow_rays_point_to_their_lights() {
    let config = small("hall_of_mirrors");
    observed(&config, |tree, _, film| {
        for ray in &tree.rays {
            if let Some(light) = ray.light {
                let light = config.lights[light as usize].in_space(&film.space);
                let light = light.illuminate(ray.ray.origin.into());
                assert!(Vec3::from(light.direction).abs_diff_eq(ray.ray.direction, 1e-3));
            }
        }
    });
}

#[test]
fn a_light_next_to_a_surface_is_finite_and_keeps_its_index() {
    let config = parse(
        "image: { width: 1, height: 1 }
camera: { look_at: { eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 20 } }
materials: { m: { color: 1 } }
lights:
  - point: { position: [0, 0, 1e-13], color: [0, 1, 1], intensity: 1e15, falloff: inverse_square }
  - point: { position: [0, 3, 5] }
objects:
  - plane: { point: [0, 0, 0], normal: [0, 0, 1] }
    material: m
",
    );
    let light = &config.lights[0];
    let radiance = light.illuminate(Vec3::ZERO.into()).radiance;
    assert!(Vec3::from(radiance).is_finite(), "{radiance:?}");
    let scene = scene_of(&config);
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let mut tree = RayTree::default();
    PathObserver::new(tracer, &Sensor::new(&scene, &config), None).observe((0, 0), &mut tree);
    let lights: Vec<_> = tree.rays.iter().map(|ray| ray.light).collect();
    assert_eq!(lights, [None, Some(0), Some(1)]);
}

#[test]
fn the_steps_match_the_counters() {
    for name in SCENES {
        observed(&small(name), |tree, _, _| {
            for ray in &tree.rays {
                let steps = tree.steps_of(ray);
                let count =
                    |is: fn(&TraversalStep) -> bool| steps.iter().filter(|step| is(step)).count();
                assert_eq!(
                    count(|step| matches!(step, TraversalStep::Node { .. })),
                    ray.node_visits as usize
                );
                assert_eq!(
                    count(|step| matches!(step, TraversalStep::Test { .. })),
                    ray.primitive_tests as usize
                );
                let was_hit = |id| {
                    steps.iter().any(
                        |step| matches!(step, TraversalStep::Test { primitive, hit: true } if *primitive == id),
                    )
                };
                assert!(ray.hit.is_none_or(|hit| was_hit(hit.primitive)), "{name}");
            }
        });
    }
}

#[test]
fn many_pixels_equal_single_ones() {
    let config = small("hall_of_mirrors");
    let scene = scene_of(&config);
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let observer = PathObserver::new(tracer, &Sensor::new(&scene, &config), None).without_steps();
    let places: Vec<_> = (0..18).flat_map(|y| (0..24).map(move |x| (x, y))).collect();
    let observed = observer.observe_many(places.iter().copied(), u64::MAX, |_| {});
    let observed = observed.unwrap();
    let mut alone = RayTree::default();
    let mut totals = Cost::default();
    for (pixel, place) in observed.iter().zip(&places) {
        assert_eq!(pixel.place, *place);
        observer.observe(*place, &mut alone);
        assert_eq!(pixel.tree, alone);
        assert!(alone.steps.is_empty());
        totals = totals.with(alone.cost());
    }
    assert_eq!(observed.len(), places.len());
    let film = film(&with_cost(config, CostMode::Counters), 1);
    assert_eq!(totals, film.totals);
}

#[test]
fn every_ray_of_a_timed_pixel_has_a_time() {
    let config = small("seed_extended");
    let scene = scene_of(&config);
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let clock = Clock::calibrated();
    let observer = PathObserver::new(tracer, &Sensor::new(&scene, &config), Some(&clock));
    let pixels = observer.observe_many([(17, 12)].into_iter(), u64::MAX, |_| {});
    let rays = &pixels.unwrap()[0].tree.rays;
    assert!(rays.len() > 2 && rays.iter().all(|ray| ray.time_ns >= 1.0));
}

#[test]
fn the_memory_limits_the_number_of_rays() {
    let config = small("seed_extended");
    let scene = scene_of(&config);
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let observer = PathObserver::new(tracer, &Sensor::new(&scene, &config), None).without_steps();
    // There is no end of pixels: only the memory ends this.
    let places = std::iter::repeat((17, 12));
    let full = observer.observe_many(places, 1 << 20, |_| {});
    let TooManyRays { n_pixels, n_rays } = full.unwrap_err();
    assert!(
        n_pixels > 1000 && n_pixels < n_rays && n_rays < 1 << 16,
        "{n_pixels}, {n_rays}"
    );
}

/// Returns true if a ray from `origin` meets the box; `None` within `margin` of its edges.
fn meets(bounds: &Aabb, ray: &Ray, margin: f64) -> Option<bool> {
    let meets = |margin: f64| {
        let size = (bounds.max - bounds.min).as_dvec3() + 2.0 * margin;
        if size.min_element() < 0.0 {
            return false;
        }
        let axis = |axis: usize| {
            let at =
                |side: f64| (side - f64::from(ray.origin[axis])) / f64::from(ray.direction[axis]);
            let low = at(f64::from(bounds.min[axis]) - margin);
            let high = at(f64::from(bounds.max[axis]) + margin);
            [low.min(high), low.max(high)]
        };
        let slabs = [0, 1, 2].map(axis);
        let enter = slabs
            .iter()
            .fold(0.0, |enter: f64, slab| enter.max(slab[0]));
        let exit = slabs
            .iter()
            .fold(f64::INFINITY, |exit: f64, slab| exit.min(slab[1]));
        enter <= exit
    };
    let [shrunken, enlarged] = [-margin, margin].map(meets);
    (shrunken == enlarged).then_some(shrunken)
}

#[test]
fn rays_that_hit_nothing_test_the_boxes_of_the_nodes_that_they_meet() {
    let mut n_compared = 0;
    for name in ["spot", "trellis"] {
        let config = small(name);
        let scene = scene_of(&config);
        let accel = Accel::new(&scene, config.acceleration);
        let nodes = accel.nodes();
        let children = |id| nodes.iter().filter(move |node| node.parent == Some(id));
        observed(&config, |tree, _, _| {
            for ray in tree
                .rays
                .iter()
                .filter(|ray| ray.hit.is_none() && ray.t_max.is_infinite())
            {
                for step in tree.steps_of(ray) {
                    let TraversalStep::Node { id, boxes } = *step else {
                        continue;
                    };
                    let met = children(id).map(|node| meets(&node.bounds, &ray.ray, 1e-4));
                    if let Some(met) = met.collect::<Option<Vec<bool>>>() {
                        let n_hits = met.iter().filter(|met| **met).count();
                        assert_eq!(
                            [boxes.n, boxes.n_hits],
                            [met.len(), n_hits].map(|n| n as u8)
                        );
                        n_compared += 1;
                    }
                }
            }
        });
    }
    assert!(n_compared > 1000, "{n_compared}");
}
