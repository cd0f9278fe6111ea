//! Streams of rays have the hits and the counters of single rays.

use crate::common::generators::cases;
use crate::common::scenes::{BACKGROUNDS, CAMERAS, CHECKER, RandomScene, scenes};
use crate::common::{config, film, film_on, lasting, parse, rays, scene_of, sum, with_cost};
use math::simd::Simd;
use proptest::prelude::*;
use render::film::Film;
use render::tiles::{TilePlan, render};
use scene::build::Sensor;
use scene::config::{Config, CostMode, OptionalOutput, Traversal};
use tracer::accel::Accel;
use tracer::cost::{Counter, Meter};
use tracer::trace::Tracer;

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn all_cost_modes_give_the_same_image_and_counters(scene in scenes()) {
        let mut config = scene.config();
        config.output.add(OptionalOutput::Bounces);
        let in_mode = |mode| film(&with_cost(config.clone(), mode), 2);
        let [none, counters, time, single_ray_time] = [
            CostMode::None,
            CostMode::Counters,
            CostMode::Time,
            CostMode::SingleRayTime,
        ]
        .map(in_mode);
        prop_assert_eq!(counters.totals, time.totals);
        prop_assert!(lasting(single_ray_time) == lasting(time.clone()));
        prop_assert!(lasting(none).0 == lasting(time.clone()).0);
        let n_rays: Vec<u32> = rays(&time);
        let by_bounce = time.values(|strip| &strip.bounces);
        prop_assert!(by_bounce.map(|rays| rays.iter().sum::<u32>()).eq(n_rays));
        prop_assert!(lasting(counters) == lasting(time));
    }

    #[test]
    fn all_instruction_sets_give_the_same_film(scene in scenes()) {
        let mut config = with_cost(scene.config(), CostMode::Counters);
        config.output.add(OptionalOutput::Bounces);
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
fn every_kernel_gives_the_same_film() {
    for name in ["seed_extended", "herd"] {
        let mut config = config(name);
        (config.image.width, config.image.height) = (40, 30);
        let scene = scene_of(&config);
        let mut films = Vec::new();
        for simd in Simd::available() {
            for traversal in [Traversal::Single, Traversal::Stream] {
                let accel = Accel::new(&scene, config.acceleration);
                let accel = accel.with_simd(simd).with_traversal(traversal);
                let tracer = Tracer::new(&scene, &accel);
                let plan = TilePlan::new(tracer, &Sensor::new(&scene, &config), config.tiles);
                let meter = Meter::new(CostMode::Time);
                films.push(lasting(render(tracer, &plan, &meter, &|_| {}).0));
            }
        }
        assert!(films.iter().all(|film| *film == films[0]), "{name}");
    }
}

#[test]
fn pixels_with_more_samples_than_a_wave_are_the_same() {
    for samples in [100, 3000] {
        let mut config = RandomScene {
            model: "blinn_phong",
            size: [17, 16],
            samples,
            max_depth: 2,
            seed: 3,
            has_media: true,
            has_lamps: false,
            openings: 0,
            has_instances: true,
            colors: [CHECKER, "0.6", "0.8"],
            bumps: [""; 3],
            arrays: ["0.5", "0.7", "0.4"],
            wire_scale: "0.4",
            reflections: [0.3, 0.5, 0.0],
            specular: 0.5,
            lights: vec![true, false],
            acceleration: "bvh",
            camera: CAMERAS[1],
            sampling: "",
            background: BACKGROUNDS[0],
            fog: [""; 2],
        }
        .config();
        if samples > 1000 {
            (config.image.width, config.image.height) = (2, 1);
        }
        let counters = film(&with_cost(config.clone(), CostMode::Counters), 2);
        assert!(lasting(counters) == lasting(film(&config, 2)));
    }
}

#[test]
fn without_shadows_all_lights_reach_what_faces_them() {
    let scene = |shadows: bool, blocker: &str| {
        let text = format!(
            "
image: {{ width: 32, height: 24 }}
camera: {{ look_at: {{ eye: [0, 2, 5], target: [0, 0, 0], fov_y_deg: 40 }} }}
background: 0
shading: {{ shadows: {shadows}, max_depth: 2 }}
materials: {{ floor: {{ color: 0.7, specular: 0.2, reflection: 0.1 }} }}
lights: [{{ directional: {{ direction: [0, -1, 0] }} }}, {{ point: {{ position: [3, 4, 0] }} }}]
objects:
  - rectangle: {{ corner: [-2, 0, 2], edges: [[4, 0, 0], [0, 0, -4]] }}
    material: floor
{blocker}"
        );
        parse(&text)
    };
    // Above the picture.
    let blocker =
        "  - disk: { center: [0, 3.5, 0], normal: [0, -1, 0], radius: 1.5 }\n    material: floor";
    let in_mode = |mode| film(&with_cost(scene(false, blocker), mode), 2);
    let [streams, single] = [CostMode::Counters, CostMode::SingleRayTime].map(in_mode);
    assert_eq!(sum(&streams, Counter::ShadowRays), 0);
    assert!(lasting(streams.clone()) == lasting(single));
    let picture = |film: &Film| film.values(|strip| &strip.rgb).collect::<Vec<[u8; 3]>>();
    let light = |config: &Config| picture(&film(&with_cost(config.clone(), CostMode::None), 1));
    assert!(light(&scene(false, blocker)) == light(&scene(false, "")));
    assert!(light(&scene(true, blocker)) != light(&scene(true, "")));
}
