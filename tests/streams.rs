//! Rays in streams see and count what rays do that are traced one by one.

mod common;

use std::fmt::Write;

use common::{film, film_on, lasting, parse, with_cost};
use proptest::prelude::*;
use raycost::accel::Simd;
use raycost::config::{Config, CostMode};
use raycost::film::{Film, Strip};

/// Some spheres and a box above a plane, of materials that mirror more or less.
#[derive(Debug, Clone)]
struct Scene {
    model: &'static str,
    size: [u32; 2],
    samples: u32,
    max_depth: u32,
    seed: u64,
    reflections: [f32; 3],
    specular: f32,
    /// Whether each light is at a point.
    lights: Vec<bool>,
    acceleration: &'static str,
}

impl Scene {
    fn config(&self) -> Config {
        let Self {
            model,
            size: [width, height],
            samples,
            max_depth,
            seed,
            reflections: [floor, ball, cloud],
            specular,
            lights,
            acceleration,
        } = self;
        let mut text = format!(
            "
image: {{ width: {width}, height: {height}, samples_per_pixel: {samples}, seed: {seed} }}
camera:
  look_at: {{ eye: [0, 1, 6], target: [0, 0, 0], fov_y_deg: 50 }}
background:
  gradient: {{ bottom: 0.2, top: [0.3, 0.5, 0.9] }}
shading: {{ model: {model}, max_depth: {max_depth}, ambient: 0.1 }}
acceleration: {acceleration}
materials:
  floor: {{ color: {{ checker: {{ even: 1, odd: 0.1, size: 0.5, axes: xz }} }}, reflection: {floor} }}
  ball: {{ color: [0.9, 0.2, 0.1], specular: {specular}, reflection: {ball} }}
  cloud: {{ color: 0.6, specular: 0.3, exponent: 7.5, reflection: {cloud} }}
objects:
  - plane: {{ point: [0, -1, 0], normal: [0, 1, 0] }}
    material: floor
  - sphere: {{ center: [0, 0, 0], radius: 0.9 }}
    material: ball
  - box: {{ min: [1, -1, -1], max: [2, 0.5, 0] }}
    material: ball
  - sphere_cloud: {{ count: 40, min: [-3, -1, -3], max: [3, 2, 3], radius: [0.1, 0.4], seed: {seed} }}
    material: cloud
lights:"
        );
        for (i, at_point) in lights.iter().enumerate() {
            let x = 3 * i as i32 - 4;
            let light = match at_point {
                true => format!("point: {{ position: [{x}, 4, 3], intensity: 0.6 }}"),
                false => {
                    format!("directional: {{ direction: [{x}, -2, -1], color: [0.5, 0.4, 0.3] }}")
                }
            };
            write!(text, "\n  - {light}").unwrap();
        }
        if lights.is_empty() {
            text.push_str(" []");
        }
        parse(&text)
    }
}

prop_compose! {
    fn scenes()(
        model in prop_oneof![Just("blinn_phong"), Just("seed")],
        size in [1_u32..40, 1_u32..40],
        samples in 1_u32..=9,
        max_depth in 0_u32..6,
        seed in 0_u64..1000,
        reflections in [0.0_f32..1.0, 0.0_f32..1.0, 0.0_f32..1.0]
            .prop_map(|shares| shares.map(|share| if share < 0.3 { 0.0 } else { share })),
        specular in prop_oneof![Just(0.0_f32), 0.0_f32..1.0],
        lights in prop::collection::vec(any::<bool>(), 0..4),
        acceleration in prop_oneof![4 => Just("bvh"), 1 => Just("brute_force")],
    ) -> Scene {
        Scene {
            model, size, samples, max_depth, seed, reflections, specular, lights, acceleration,
        }
    }
}

/// What a film without cost has of a film with it.
fn picture(film: Film) -> Vec<Strip> {
    let strip = |strip: Strip| Strip {
        node_visits: Vec::new(),
        primitive_tests: Vec::new(),
        rays: Vec::new(),
        shadow_rays: Vec::new(),
        reflection_rays: Vec::new(),
        refraction_rays: Vec::new(),
        depth: Vec::new(),
        tile: Vec::new(),
        ..strip
    };
    lasting(film).into_iter().map(strip).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn all_modes_give_the_same_picture_and_the_same_counters(scene in scenes()) {
        let config = scene.config();
        let in_mode = |mode| film(&with_cost(config.clone(), mode), 2);
        let [none, counters, time] =
            [CostMode::None, CostMode::Counters, CostMode::Time].map(in_mode);
        prop_assert_eq!(counters.totals, time.totals);
        prop_assert!(picture(none) == picture(time.clone()));
        prop_assert!(lasting(counters) == lasting(time));
    }

    #[test]
    fn all_instruction_sets_give_the_same_streams(scene in scenes()) {
        let config = with_cost(scene.config(), CostMode::Counters);
        let [first, others @ ..] = &Simd::available()[..] else { unreachable!("portable code runs anywhere") };
        let expected = film_on(&config, 2, *first);
        for simd in others {
            let found = film_on(&config, 2, *simd);
            prop_assert_eq!(found.totals, expected.totals);
            prop_assert!(lasting(found) == lasting(expected.clone()));
        }
    }
}

#[test]
fn more_samples_than_fit_into_a_wave_are_the_same() {
    for samples in [100, 3000] {
        let mut config = Scene {
            model: "blinn_phong",
            size: [17, 16],
            samples,
            max_depth: 2,
            seed: 3,
            reflections: [0.3, 0.5, 0.0],
            specular: 0.5,
            lights: vec![true, false],
            acceleration: "bvh",
        }
        .config();
        if samples > 1000 {
            (config.image.width, config.image.height) = (2, 1);
        }
        let counters = film(&with_cost(config.clone(), CostMode::Counters), 2);
        assert!(lasting(counters) == lasting(film(&config, 2)));
    }
}
