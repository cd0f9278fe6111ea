//! Attributed costs sum exactly to the counters of the film.

use std::collections::HashMap;

use crate::common::kept::kept;
use crate::common::{config, counts, parse, rays, with_cost};
use render::attribution::{
    AttributedCost, AttributionRule, CostAttribution, Hierarchy, Visits, Work,
};
use render::film::Strip;
use scene::config::{Acceleration, Adaptive, Config, CostMode, PixelPattern, SampleRule};
use tracer::cost::{Counter, RayKind, StepCounter};
use world::scene::Instances;

const SCENES: [&str; 6] = [
    "seed_extended",
    "hall_of_mirrors",
    "spot",
    "blocks",
    "trellis",
    "herd",
];

/// A small picture of a scene of `configs/`.
fn small(name: &str, samples: u32, cost: CostMode) -> Config {
    let mut config = with_cost(config(name), cost);
    (config.image.width, config.image.height) = (48, 36);
    config.image.samples_per_pixel = samples;
    config
}

fn total(accounts: &[AttributedCost], charge: AttributionRule) -> Work {
    let work = accounts.iter().map(|account| account.all(charge));
    work.fold(Work::default(), Work::with)
}

#[test]
fn costs_of_objects_and_materials_sum_to_the_film() {
    let adaptive = |mut config: Config, by, noise| {
        config.image.sampler = PixelPattern::Sobol;
        config.image.adaptive = Some(Adaptive {
            by,
            noise,
            min_samples: 2,
        });
        config
    };
    let uniform = |name| (name, small(name, 3, CostMode::Counters));
    let counted = |name| small(name, 8, CostMode::Counters);
    let noisy = |name| (name, adaptive(counted(name), SampleRule::Noise, Some(0.02)));
    let efficient = |name| (name, adaptive(counted(name), SampleRule::Efficiency, None));
    let configs = [
        SCENES.map(uniform),
        SCENES.map(noisy),
        SCENES.map(efficient),
    ];
    for (name, config) in configs.into_iter().flatten() {
        let (.., film, attribution) = kept(&config, 2);
        for accounts in [&attribution.objects, &attribution.materials] {
            for charge in AttributionRule::ALL {
                let work = total(accounts, charge);
                assert_eq!(work.node_visits, film.totals.node_visits, "{name}");
                assert_eq!(work.primitive_tests, film.totals.primitive_tests);
                assert_eq!(work.time_ps, 0);
                for kind in RayKind::ALL {
                    let rays = accounts.iter().map(|a| a.work(charge, kind).rays);
                    assert_eq!(rays.sum::<u64>(), film.totals.rays_of(kind), "{name}");
                }
            }
            let samples: u64 = accounts.iter().map(AttributedCost::n_samples).sum();
            assert_eq!(samples, film.totals.rays_of(RayKind::Camera));
            let pixels: f64 = accounts.iter().map(AttributedCost::n_pixels).sum();
            assert!((pixels - 48.0 * 36.0).abs() < 1e-4, "{pixels}");
        }
    }
}

#[test]
fn costs_of_nodes_and_primitives_sum_to_the_film() {
    for name in SCENES {
        let (scene, film, attribution) = kept(&small(name, 2, CostMode::Counters), 2);
        let hierarchy = attribution.hierarchy.unwrap();
        let primitives = attribution.primitives.unwrap();
        let (mut visits, mut tests) = (0, 0);
        for (node, found) in hierarchy.nodes.iter().zip(&hierarchy.visits) {
            if node.is_leaf {
                tests += found.n * u64::from(node.n_primitives);
            } else {
                visits += found.n;
            }
            assert!(found.n_hits <= found.n);
        }
        assert_eq!(visits, film.totals.node_visits, "{name}");
        let n_of = |found: &Visits| found.n;
        let of_planes = scene.primitives.iter().zip(&primitives);
        let of_planes = of_planes.filter(|(primitive, _)| primitive.is_unbounded());
        tests += of_planes.map(|(_, found)| found.n).sum::<u64>();
        assert_eq!(tests, film.totals.primitive_tests, "{name}");
        assert_eq!(primitives.iter().map(n_of).sum::<u64>(), tests);
        assert!(primitives.iter().all(|found| found.n_hits <= found.n));

        // All that was entered below a node was entered by a ray in it.
        for (node, found) in hierarchy.nodes.iter().zip(&hierarchy.visits).skip(1) {
            let Some(parent) = node.parent else {
                assert!(node.mesh.is_some(), "{name}: the root of a mesh");
                continue;
            };
            let parent = hierarchy.nodes.iter().position(|n| n.id == parent);
            assert!(
                found.n <= hierarchy.visits[parent.unwrap()].n_hits,
                "{name}"
            );
        }
    }
}

/// An array of the film with the id of the object or material of each pixel.
type Ids = fn(&Strip) -> &Vec<i32>;

/// With one sample per pixel, the film gives the cost of each visible object.
#[test]
fn visible_objects_have_the_cost_of_their_pixels() {
    for name in SCENES {
        let (scene, film, attribution) = kept(&small(name, 1, CostMode::Counters), 2);
        let groups: [(_, Ids, _); 2] = [
            (
                &attribution.objects,
                |strip| &strip.object,
                scene.n_objects(),
            ),
            (
                &attribution.materials,
                |strip| &strip.material,
                scene.materials.len(),
            ),
        ];
        for (accounts, array, n_groups) in groups {
            assert_eq!(accounts.len(), n_groups + 1);
            for (i, account) in accounts.iter().enumerate() {
                let id = if i == n_groups { -1 } else { i as i32 };
                let sum_of = |counts: Vec<u32>| {
                    let pixels = film.values(array).zip(counts);
                    let seen = pixels.filter(|(seen, _)| *seen == id);
                    seen.map(|(_, count)| u64::from(count)).sum::<u64>()
                };
                let sum = |counter| sum_of(counts(&film, counter));
                let work = account.all(AttributionRule::Primary);
                assert_eq!(work.rays, sum_of(rays(&film)), "{name}, {i}");
                assert_eq!(work.node_visits, sum(Counter::NodeVisits));
                assert_eq!(work.primitive_tests, sum(Counter::PrimitiveTests));
                let n_pixels = film.values(array).filter(|seen| *seen == id).count();
                assert_eq!(account.n_samples(), n_pixels as u64);
                let shadow = account.work(AttributionRule::Primary, RayKind::Shadow);
                assert_eq!(shadow.rays, sum(Counter::ShadowRays));
            }
        }
    }
}

/// A mirror above a sphere that only the mirror shows.
#[test]
fn reflections_are_attributed_to_the_object_hit() {
    let scene = "
image: { width: 40, height: 30 }
camera:
  look_at: { eye: [0, 0, 8], target: [0, 0, 0], fov_y_deg: 20 }
shading: { max_depth: 1 }
materials:
  mirror: { color: 0, reflection: 1 }
  red: { color: [1, 0, 0] }
lights: []
objects:
  - disk: { center: [0, 0, 0], normal: [0, 0, 1], radius: 9 }
    material: mirror
  - sphere: { center: [0, 0, 20], radius: 10 }
    material: red
";
    let (_, film, attribution) = kept(&with_cost(parse(scene), CostMode::Counters), 1);
    let [mirror, sphere, nothing] = &attribution.objects[..] else {
        panic!("three accounts");
    };
    assert_eq!(mirror.n_samples(), 1200);
    assert_eq!([sphere.n_samples(), nothing.n_samples()], [0, 0]);
    assert_eq!(
        mirror.all(AttributionRule::Primary).rays,
        film.totals.n_rays()
    );
    assert_eq!(mirror.all(AttributionRule::Hit).rays, 1200);
    assert_eq!(sphere.all(AttributionRule::Primary), Work::default());
    assert_eq!(
        sphere.work(AttributionRule::Hit, RayKind::Reflection).rays,
        1200
    );
    assert_eq!(attribution.objects, attribution.materials);
}

#[test]
fn times_sum_to_those_of_the_film() {
    for name in SCENES {
        let (scene, film, attribution) = kept(&small(name, 2, CostMode::Time), 2);
        let expected = film.total_time_ns();
        // Each ray's time is rounded to whole picoseconds; sums are of f32.
        let rounding = 0.5e-3 * film.totals.n_rays() as f64 + 1e-6 * expected;
        let assert_all = |time_ps: u64, what: &str| {
            let found = time_ps as f64 / 1e3;
            assert!(
                (found - expected).abs() <= rounding,
                "{name}, {what}: {found}"
            );
        };
        for charge in AttributionRule::ALL {
            assert_all(total(&attribution.objects, charge).time_ps, "objects");
            assert_all(total(&attribution.materials, charge).time_ps, "materials");
        }
        let hierarchy = attribution.hierarchy.unwrap();
        let primitives = attribution.primitives.unwrap();
        let sum =
            |visits: &mut dyn Iterator<Item = &Visits>| visits.map(|v| v.time_ps).sum::<u64>();
        let planes = scene.primitives.iter().zip(&primitives);
        let planes = planes.filter(|(primitive, _)| primitive.is_unbounded());
        let of_planes = sum(&mut planes.map(|(_, visits)| visits));
        assert_all(of_planes + sum(&mut hierarchy.visits.iter()), "nodes");
        let nodes = hierarchy.nodes.iter().zip(&hierarchy.visits);
        let nodes = nodes.filter(|(node, _)| !node.is_leaf);
        let of_nodes = sum(&mut nodes.map(|(_, visits)| visits));
        assert_all(of_nodes + sum(&mut primitives.iter()), "primitives");
    }
}

#[test]
fn counts_do_not_depend_on_threads() {
    for name in ["hall_of_mirrors", "spot"] {
        let config = small(name, 2, CostMode::Counters);
        let (.., one) = kept(&config, 1);
        for n_threads in [2, 5] {
            let (.., many) = kept(&config, n_threads);
            assert!(one == many, "{name}, {n_threads} threads");
        }
    }
}

#[test]
fn brute_force_has_no_nodes_and_the_same_hits() {
    let mut config = small("hall_of_mirrors", 1, CostMode::Counters);
    let (.., bvh) = kept(&config, 2);
    config.acceleration = Acceleration::BruteForce;
    let (.., brute) = kept(&config, 2);
    assert!(brute.hierarchy.as_ref().unwrap().nodes.is_empty());
    let rays = |attribution: &CostAttribution, i: usize| {
        attribution.objects[i].all(AttributionRule::Primary).rays
    };
    for i in 0..bvh.objects.len() {
        assert_eq!(rays(&bvh, i), rays(&brute, i));
        assert_eq!(bvh.objects[i].n_samples(), brute.objects[i].n_samples());
    }
    let n_rays = total(&brute.objects, AttributionRule::Hit).rays;
    assert!(
        brute
            .primitives
            .unwrap()
            .iter()
            .all(|found| found.n == n_rays)
    );
}

#[test]
fn the_cost_of_the_root_is_that_of_all_rays() {
    let (.., film, attribution) = kept(&small("million_spheres", 1, CostMode::Counters), 2);
    let hierarchy = attribution.hierarchy.unwrap();
    let costs = hierarchy.costs();
    let steps = film.totals.node_visits + film.totals.primitive_tests;
    let per_ray = steps as f64 / hierarchy.visits[0].n as f64;
    assert!((f64::from(costs[0]) / per_ray - 1.0).abs() < 1e-6);
    // Each node's cost is its own and that of those below it.
    let children: f32 = hierarchy
        .nodes
        .iter()
        .zip(&costs)
        .filter(|(node, _)| node.parent == Some(0))
        .map(|(_, cost)| cost)
        .sum();
    assert!((costs[0] - 1.0 - children).abs() < 1e-3 * costs[0]);
}

#[test]
fn the_steps_of_pixels_sum_to_the_visits_of_nodes() {
    for name in SCENES {
        let (scene, film, attribution) = kept(&small(name, 2, CostMode::Counters), 2);
        let of = |counter| film.total_steps(counter);
        let Hierarchy { nodes, visits } = attribution.hierarchy.unwrap();
        let mut n_children: HashMap<u32, u64> = HashMap::new();
        for parent in nodes.iter().filter_map(|node| node.parent) {
            *n_children.entry(parent).or_default() += 1;
        }
        let (mut box_tests, mut entered, mut instance_visits) = (0, 0, 0);
        for (node, visits) in nodes.iter().zip(&visits) {
            box_tests += visits.n * n_children.get(&node.id).unwrap_or(&0);
            match (node.parent, node.mesh) {
                (Some(_), _) => entered += visits.n,
                (None, Some(_)) => instance_visits += visits.n,
                (None, None) => {}
            }
        }
        assert_eq!(of(StepCounter::BoxTests), box_tests, "{name}");
        assert_eq!(of(StepCounter::InstanceVisits), instance_visits, "{name}");
        assert_eq!(instance_visits > 0, scene.instances.is_some());
        // Children behind a hit are not visited.
        assert!(
            (entered..=box_tests).contains(&of(StepCounter::BoxHits)),
            "{name}"
        );
        // An instance is not hit itself, its triangles are.
        let is_instance = |primitive: u32| {
            let instances = scene.instances.as_ref();
            let is_one = |all: &Instances| {
                all.by_box(primitive).is_some() && primitive < all.first_triangle()
            };
            instances.is_some_and(is_one)
        };
        let visits = attribution.primitives.unwrap();
        let hit = (0..)
            .zip(visits)
            .filter(|(primitive, _)| !is_instance(*primitive));
        let n_hits: u64 = hit.map(|(_, found)| found.n_hits).sum();
        assert_eq!(of(StepCounter::PrimitiveHits), n_hits, "{name}");
    }
}
