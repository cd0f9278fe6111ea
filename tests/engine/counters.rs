//! The counters are exact.

use crate::common::{config, counts, film, parse, rays, scene_of, sum, tiles_and_threads, total};
use scene::config::Acceleration;
use tracer::cost::Counter;

const SCENE: &str = "
image: { width: 60, height: 45, samples_per_pixel: 3, seed: 9 }
camera:
  look_at: { eye: [0, 2, 8], target: [0, 0, 0], fov_y_deg: 40 }
shading: { max_depth: 3 }
materials:
  mirror: { color: 0.8, reflection: 0.5 }
lights:
  - point: { position: [5, 5, 5] }
  - directional: { direction: [1, -1, 0] }
objects:
  - sphere_cloud: { count: 200, min: [-3, -1, -3], max: [3, 2, 3], radius: [0.1, 0.4], seed: 2 }
    material: mirror
  - box: { min: [-1, -1, -1], max: [1, 0, 1] }
    material: mirror
    transform: [{ rotate: { axis: [0, 1, 0], angle_deg: 30 } }]
  - plane: { point: [0, -1, 0], normal: [0, 1, 0] }
    material: mirror
";

#[test]
fn brute_force_tests_every_primitive_with_every_ray() {
    for mut config in [parse(SCENE), config("seed_extended"), config("blocks")] {
        config.acceleration = Acceleration::BruteForce;
        (config.image.width, config.image.height) = (60, 45);
        let film = film(&config, 2);
        let n_primitives = scene_of(&config).primitives.len() as u64;
        let n_rays = total(&rays(&film));
        assert_eq!(sum(&film, Counter::PrimitiveTests), n_rays * n_primitives);
        assert_eq!(sum(&film, Counter::NodeVisits), 0);
        // Pixel by pixel as well.
        let tests = counts(&film, Counter::PrimitiveTests);
        for (tests, rays) in tests.into_iter().zip(rays(&film)) {
            assert_eq!(u64::from(tests), u64::from(rays) * n_primitives);
        }
    }
}

#[test]
fn the_sums_over_the_pixels_are_the_totals() {
    let film = film(&parse(SCENE), 2);
    let totals = film.totals;
    let [camera, shadow, reflection, refraction, diffuse] = totals.rays;
    assert_eq!(sum(&film, Counter::NodeVisits), totals.node_visits);
    assert_eq!(sum(&film, Counter::PrimitiveTests), totals.primitive_tests);
    assert_eq!(total(&rays(&film)), totals.n_rays());
    assert_eq!(sum(&film, Counter::ShadowRays), shadow);
    assert_eq!(sum(&film, Counter::ReflectionRays), reflection);
    assert_eq!(sum(&film, Counter::RefractionRays), refraction);
    assert_eq!(sum(&film, Counter::DiffuseRays), diffuse);
    assert_eq!(camera, 60 * 45 * 3);
    let deepest = counts(&film, Counter::Depth).into_iter().max().unwrap();
    assert_eq!(u64::from(deepest), totals.depth);
    assert_eq!(totals.depth, 3);
    assert!(shadow > 0 && reflection > 0 && totals.node_visits > 0);
}

#[test]
fn brute_force_traces_the_same_rays_and_finds_the_same_hits() {
    let mut config = parse(SCENE);
    let bvh = film(&config, 2);
    config.acceleration = Acceleration::BruteForce;
    let brute = film(&config, 2);
    assert_eq!(bvh.totals.rays, brute.totals.rays);
    assert!(
        bvh.values(|strip| &strip.rgb)
            .eq(brute.values(|strip| &strip.rgb))
    );
    let bits = |film: &render::film::Film| -> Vec<u32> {
        film.values(|strip| &strip.distance)
            .map(f32::to_bits)
            .collect()
    };
    assert_eq!(bits(&bvh), bits(&brute));
    assert!(bvh.totals.primitive_tests < brute.totals.primitive_tests / 10);
}

#[test]
fn every_pixel_has_a_time_and_a_thread() {
    let film = film(&parse(SCENE), 2);
    assert!(
        film.values(|strip| &strip.time_ns)
            .all(|ns| ns >= 1.0 && ns.is_finite())
    );
    let [tiles, threads] = tiles_and_threads(&film);
    assert!(threads.iter().all(|thread| (0..2).contains(thread)));
    assert_eq!(
        (tiles[0], tiles[16], tiles[59], tiles[60 * 16]),
        (0, 1, 3, 4)
    );
}
