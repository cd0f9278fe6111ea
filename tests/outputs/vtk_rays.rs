//! `rays.vtp` holds the rays, bit for bit, and VTK reads it as the format says.

use scene::build::Sensor;
use std::fs::File;
use std::path::Path;

use crate::common::data_set::{DataSet, assert_same, integers};
use crate::common::{config, scene_in_world};
use output::writers::{Traced, write_rays};
use render::attribution::{PathObserver, TracedRay};
use render::film::Film;
use render::schedule::TileGrid;
use scene::config::{Config, CostMode};
use tracer::accel::Accel;
use tracer::cost::Clock;
use tracer::trace::Tracer;
use vtk::Codec;
use world::scene::Primitive;

/// Two tests of the rays of some pixels.
macro_rules! rays {
    ($($name:ident: $config:expr, $places:expr, $clock:expr;)*) => {$(
        mod $name {
            use super::*;

            #[test]
            fn as_the_format_says() {
                with_rays(&$config, $places, $clock, compare_rays);
            }

            #[test]
            #[ignore = "needs PyPI's vtk: run tests/with-paraview"]
            fn by_vtk() {
                with_rays(&$config, $places, $clock, compare_readers);
            }
        }
    )*};
}

rays! {
    rays_of_mirrors: config("hall_of_mirrors"), &[(400, 240), (0, 499), (799, 0)], None;
    rays_with_a_time: config("seed_extended"), &[(290, 190)], Some(&Clock::calibrated());
    // Pixels have 64-bit numbers.
    rays_of_a_huge_picture: sphere(65_535), &[(32_000, 40_000)], None;
    no_rays: sphere(33), &[], None;
}

/// The course's first scene in a square picture.
fn sphere(side: u32) -> Config {
    let mut config = config("seed_sphere");
    (config.image.width, config.image.height) = (side, side);
    config
}

/// Writes the rays of these pixels; checks the trees and the file.
fn with_rays(
    config: &Config,
    places: &[(u32, u32)],
    clock: Option<&Clock>,
    check: fn(&Traced, &Path),
) {
    let scene = scene_in_world(config);
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let observer = PathObserver::new(tracer, &Sensor::new(&scene, config), clock);
    let pixels = observer.observe_many(places.iter().copied(), u64::MAX, |_| {});
    let traced = Traced {
        name: "scene",
        time: None,
        scene: &scene,
        plane: &Sensor::new(&scene, config).plane,
        pixels: &pixels.unwrap(),
        is_timed: clock.is_some(),
        cloud: &Film::new(TileGrid::new(1, 1, 16), 1, CostMode::None),
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("rays.vtp");
    write_rays(&traced, Codec::None, &mut File::create(&file).unwrap()).unwrap();
    check(&traced, &file);
}

/// VTK finds what the format says.
fn compare_readers(_: &Traced, file: &Path) {
    assert_same(DataSet::read_with_vtk(file), DataSet::read(file));
}

/// The file has the rays, pixel after pixel; how they are drawn is tested in
/// `trace`.
fn compare_rays(traced: &Traced, file: &Path) {
    let found = DataSet::read(file);
    let rays: Vec<&TracedRay> = traced.pixels.iter().flat_map(|p| &p.tree.rays).collect();
    assert_eq!(
        [found.n_points, found.n_cells.unwrap()],
        [2 * rays.len(), rays.len()]
    );
    let n = rays.len() as i32;
    let int = |name: &str, value: &dyn Fn(&TracedRay) -> i32| {
        assert_eq!(
            found.array(name),
            &integers(name, rays.iter().map(|ray| value(ray)))
        );
    };
    let met = |ray: &TracedRay, id: fn(&Primitive) -> u32| {
        let met = ray
            .hit
            .map(|hit| &traced.scene.primitives[hit.primitive as usize]);
        met.map_or(-1, |primitive| id(primitive) as i32)
    };
    int("kind", &|ray| ray.kind as i32);
    int("sample", &|ray| ray.sample as i32);
    int("bounce", &|ray| ray.bounce as i32);
    int("light", &|ray| ray.light.map_or(-1, |light| light as i32));
    int("object", &|ray| met(ray, |primitive| primitive.object.0));
    int("material", &|ray| {
        met(ray, |primitive| primitive.material.0)
    });
    int("primitive", &|ray| {
        ray.hit.map_or(-1, |hit| hit.primitive as i32)
    });
    let count = |name: &str, value: fn(&TracedRay) -> u32| {
        assert!(
            found
                .array(name)
                .u32s()
                .eq(rays.iter().map(|ray| value(ray))),
            "{name}"
        );
    };
    count("node_visits", |ray| ray.node_visits);
    count("primitive_tests", |ray| ray.primitive_tests);
    if traced.is_timed {
        let times = rays.iter().map(|ray| ray.time_ns);
        assert!(found.array("time_ns").f32s().eq(times));
    }
    let contributions = rays.iter().map(|ray| ray.contribution.to_array());
    assert!(found.array("contribution").triples().eq(contributions));
    let directions = rays.iter().map(|ray| ray.ray.direction.to_array());
    assert!(found.array("direction").triples().eq(directions));
    assert_eq!(
        found.array("connectivity"),
        &integers("connectivity", 0..2 * n)
    );
    assert_eq!(
        found.array("offsets"),
        &integers("offsets", (1..=n).map(|i| 2 * i))
    );
    compare_parents(traced, &found);
}

/// Parents and pixels count over the whole file and picture.
fn compare_parents(traced: &Traced, found: &DataSet) {
    let wide = found.array("pixel");
    let pixels: Vec<i64> = match wide.scalar.as_str() {
        "Int64" => bytemuck::pod_collect_to_vec(&wide.bytes),
        _ => wide.i32s().map(i64::from).collect(),
    };
    let mut parents = found.array("parent").i32s();
    let mut first = 0;
    for pixel in traced.pixels {
        let (x, y) = pixel.place;
        let number = i64::from(y) * i64::from(traced.plane.size[0]) + i64::from(x);
        for ray in &pixel.tree.rays {
            let parent = ray
                .parent
                .map_or(-1, |parent| (first + parent as usize) as i32);
            assert_eq!(parents.next(), Some(parent));
        }
        let end = first + pixel.tree.rays.len();
        assert!(pixels[first..end].iter().all(|&found| found == number));
        first = end;
    }
    assert_eq!(first, pixels.len());
}
