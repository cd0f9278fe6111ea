//! What is observed of a pixel's rays is what they do when nobody looks.

mod common;

use common::{config, film, scene_of, with_cost};
use glam::Vec3;
use raycost::accel::{Accel, Step};
use raycost::config::CostMode;
use raycost::cost::RayKind;
use raycost::observe::{Observer, RayTree};

/// The pixels of a scene of `configs/`, small, with the tree of each.
fn observed(name: &str, mut check: impl FnMut(&RayTree, usize, &raycost::film::Film)) {
    let mut config = with_cost(config(name), CostMode::Counters);
    (config.image.width, config.image.height) = (24, 18);
    config.image.samples_per_pixel = 2;
    let film = film(&config, 1);
    let scene = scene_of(&config);
    let accel = Accel::new(&scene.primitives, config.acceleration);
    let observer = Observer::new(&scene, &accel, &config.image, None);
    let mut tree = RayTree::default();
    for pixel in 0..config.image.n_pixels() {
        let [x, y] = [pixel as u32 % 24, pixel as u32 / 24];
        observer.observe((x, y), &mut tree);
        check(&tree, pixel, &film);
    }
}

const SCENES: [&str; 4] = ["seed_extended", "hall_of_mirrors", "spot", "blocks"];

#[test]
fn trees_cost_and_show_what_pixels_do() {
    for name in SCENES {
        observed(name, |tree, pixel, film| {
            let of = |array: fn(&raycost::film::Strip) -> &Vec<u32>| {
                u64::from(film.values(array).nth(pixel).unwrap())
            };
            let cost = tree.cost();
            assert_eq!(cost.node_visits, of(|strip| &strip.node_visits));
            assert_eq!(cost.primitive_tests, of(|strip| &strip.primitive_tests));
            assert_eq!(cost.n_rays(), of(|strip| &strip.rays));
            assert_eq!(cost.depth, of(|strip| &strip.depth));
            let shown = film.values(|strip| &strip.rgb).nth(pixel).unwrap();
            let color = tree.color();
            for (channel, shown) in color.to_array().into_iter().zip(shown) {
                let limited = channel.min(1.0) * 255.0;
                // A sample that is brighter than 1 is limited by itself.
                assert!(limited >= f32::from(shown) - 0.51, "{name}: {color}");
                if color.max_element() < 0.5 {
                    assert!(limited <= f32::from(shown) + 0.51, "{name}: {color}");
                }
            }
        });
    }
}

#[test]
fn steps_are_what_is_counted() {
    for name in SCENES {
        observed(name, |tree, _, _| {
            for ray in &tree.rays {
                let steps = tree.steps_of(ray);
                let count = |is: fn(&Step) -> bool| steps.iter().filter(|step| is(step)).count();
                assert_eq!(
                    count(|step| matches!(step, Step::Node { .. })),
                    ray.node_visits as usize
                );
                assert_eq!(
                    count(|step| matches!(step, Step::Test { .. })),
                    ray.primitive_tests as usize
                );
                let met = |id| {
                    steps.iter().any(
                        |step| matches!(step, Step::Test { primitive, hit: true } if *primitive == id),
                    )
                };
                assert!(ray.hit.is_none_or(|hit| met(hit.primitive)), "{name}");
            }
        });
    }
}

#[test]
fn rays_follow_their_parents_and_shadows_are_parts_of_them() {
    observed("hall_of_mirrors", |tree, _, _| {
        for (number, ray) in tree.rays.iter().enumerate() {
            let Some(parent) = ray.parent else {
                assert_eq!((ray.kind, ray.bounce), (RayKind::Camera, 0));
                continue;
            };
            assert!((parent as usize) < number);
            let parent = &tree.rays[parent as usize];
            assert_eq!(parent.sample, ray.sample);
            assert!(parent.hit.is_some());
            let at = parent.ray.at(parent.hit.unwrap().t);
            assert!(at.distance(ray.ray.origin) < 1e-3 * (1.0 + at.length()));
            if ray.kind == RayKind::Shadow {
                assert!((ray.contribution - parent.contribution).max_element() < 1e-5);
                assert!(ray.hit.is_none() || ray.contribution == Vec3::ZERO);
            }
        }
    });
}
