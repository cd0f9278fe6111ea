//! Instances are hit, shaded and counted as meshes at their places.

use std::fmt::Write;

use crate::common::generators::{cases, ray, triple};
use crate::common::twins::{compare, compare_built};
use crate::common::{film, mean, parse, radiance, scene_in_world, with_cost};
use glam::Vec3;
use import::RadiusChoice;
use math::sampling::uniform;
use proptest::prelude::*;
use scene::build::Geometries;
use scene::config::{Acceleration, Config, CostMode};
use tracer::accel::{Accel, TraversalStep};
use tracer::cost::{Cost, NoProbe, RayKind};
use tracer::trace::{SurfacePoint, Tracer};
use world::geometry::{InstanceTransform, Ray};
use world::material::ArrayChoice;
use world::scene::{InstanceId, PlacedPrimitive, Scene};

const MESHES: [&str; 3] = [
    "{ file: ../tests/files/tile.obj }",
    "{ file: meshes/trellis.obj, normals: smooth }",
    "{ file: ../tests/files/vtk/curvilinear_raw.vts }",
];

/// The steps of a place, as YAML.
fn place() -> impl Strategy<Value = String> {
    let factor = || prop_oneof![0.2_f32..1.5, -1.5_f32..-0.2];
    let steps = ([factor(), factor(), factor()], 0.0_f32..360.0, triple());
    steps.prop_map(|([x, y, z], angle, by)| {
        format!(
            "[{{ scale: [{x}, {y}, {z}] }}, {{ rotate: {{ axis: [1, 2, 3], angle_deg: {angle} }} }}, {{ translate: {by:?} }}]"
        )
    })
}

/// A mesh, the places of its instances, and the transform of all of them.
#[derive(Debug, Clone)]
struct Group {
    mesh: &'static str,
    places: Vec<String>,
    transform: String,
}

impl Group {
    /// The object of all instances.
    fn placed(&self) -> String {
        let mut text = format!("  - instances:\n      mesh: {}\n      places:\n", self.mesh);
        for place in &self.places {
            writeln!(text, "        - {place}").unwrap();
        }
        text + &format!("    transform: {}\n    material: m\n", self.transform)
    }

    /// An object for each instance.
    fn written_out(&self) -> String {
        let rest = &self.transform[1..];
        let object = |place: &String| {
            let steps = &place[..place.len() - 1];
            let mesh = self.mesh;
            format!("  - mesh: {mesh}\n    material: m\n    transform: {steps}, {rest}\n")
        };
        self.places.iter().map(object).collect()
    }
}

fn groups() -> impl Strategy<Value = Vec<Group>> {
    let places = prop::collection::vec(place(), 1..12);
    let group = (prop::sample::select(&MESHES[..]), places, place());
    let group = group.prop_map(|(mesh, places, transform)| Group {
        mesh,
        places,
        transform,
    });
    prop::collection::vec(group, 1..4)
}

/// The config of a ball, a floor and these objects.
fn config(objects: &str) -> Config {
    parse(&format!(
        "image: {{ width: 24, height: 18 }}\n\
         camera: {{ look_at: {{ eye: [0, 0, 9], target: [0, 0, 0], fov_y_deg: 40 }} }}\n\
         materials: {{ m: {{ color: 1 }} }}\nlights: []\nobjects:\n\
         {objects}\
         \x20 - sphere: {{ center: [0, 0, 0], radius: 0.5 }}\n    material: m\n\
         \x20 - plane: {{ point: [0, -3, 0], normal: [0, 1, 0] }}\n    material: m\n"
    ))
}

fn placed(groups: &[Group]) -> Scene {
    scene_in_world(&config(
        &groups.iter().map(Group::placed).collect::<String>(),
    ))
}

/// The surface point that a ray hits.
fn surface_point(scene: &Scene, accel: &Accel, ray: &Ray) -> Option<SurfacePoint> {
    Tracer::new(scene, accel).trace(ray, RayKind::Camera, &mut NoProbe)
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn all_find_the_same_hits(groups in groups(), rays in prop::collection::vec(ray(), 40)) {
        compare(&placed(&groups), &rays)?;
    }

    #[test]
    fn all_find_the_same_hits_of_moved_instances(
        groups in groups(),
        moved in place(),
        rays in prop::collection::vec(ray(), 40),
    ) {
        let mut later = groups.clone();
        later[0].transform = moved;
        let [first, later] = [&groups, &later].map(|groups| placed(groups));
        compare_built(&later, &rays, |quality| {
            let first = Accel::new(&first, Acceleration::Bvh(quality));
            first.refitted(&later).expect("they are as many, of the same meshes")
        })?;
    }

    #[test]
    fn the_steps_are_those_that_are_counted(groups in groups(), ray in ray()) {
        let scene = placed(&groups);
        for kind in [Acceleration::default(), Acceleration::BruteForce] {
            let accel = Accel::new(&scene, kind);
            let (mut cost, mut steps) = (Cost::default(), Vec::new());
            let hit = accel.nearest(&ray, &mut cost);
            prop_assert_eq!(accel.record_nearest(&ray, &mut steps), hit);
            let n_of = |is_one: fn(&&TraversalStep) -> bool| steps.iter().filter(is_one).count() as u64;
            prop_assert_eq!(n_of(|step| matches!(step, TraversalStep::Node { .. })), cost.node_visits);
            prop_assert_eq!(n_of(|step| matches!(step, TraversalStep::Test { .. })), cost.primitive_tests);
            let Some(hit) = hit else { continue };
            let was_hit = |primitive| steps.contains(&TraversalStep::Test { primitive, hit: true });
            prop_assert!(was_hit(hit.primitive));
            let instances = scene.instances.as_ref().unwrap();
            prop_assert!(hit.instance.is_none_or(|id| was_hit(instances.box_of(id))));
        }
    }

    /// Rounding moves edges by a little: few rays may pass on their other side.
    #[test]
    fn instances_are_hit_as_meshes_at_their_places(groups in groups(), seed in 0_u64..1000) {
        let (scene, texts) = (placed(&groups), groups.iter().map(Group::written_out));
        let written_out = scene_in_world(&config(&texts.collect::<String>()));
        let n_placed = written_out.n_objects() - 2;
        let (accel, other) = (Accel::new(&scene, Default::default()), Accel::new(&written_out, Default::default()));
        let mut n_different = 0;
        for i in 0..400 {
            let [x, y, u, v] = uniform([seed, i, 0]).map(|number| 2.0 * number - 1.0);
            let origin = 8.0 * Vec3::new(x, y, 1.5);
            let direction = (4.0 * Vec3::new(u, v, u * v) - origin).normalize();
            let ray = Ray { origin, direction };
            let found = [surface_point(&scene, &accel, &ray), surface_point(&written_out, &other, &ray)];
            let [Some(found), Some(expected)] = found else {
                n_different += usize::from(found[0].is_some() != found[1].is_some());
                continue;
            };
            let place = found.instance.map(|id| id.0 as usize);
            let expected_place = Some(expected.object.0 as usize).filter(|object| *object < n_placed);
            if place != expected_place || (found.distance - expected.distance).abs() > 1e-3 {
                n_different += 1;
                continue;
            }
            prop_assert!(found.position.abs_diff_eq(expected.position, 1e-3));
            // At the edges of facets they differ.
            if !found.geometric_normal.abs_diff_eq(expected.geometric_normal, 1e-3) {
                n_different += 1;
                continue;
            }
            prop_assert!(found.normal.abs_diff_eq(expected.normal, 2e-2), "{:?} {:?}", found, expected);
        }
        prop_assert!(n_different <= 8, "{n_different}");
    }
}

#[test]
fn brute_force_tests_the_boxes_and_all_triangles_of_all_instances() {
    let group = |mesh, n: usize| Group {
        mesh,
        places: (0..n)
            .map(|i| format!("[{{ translate: [{i}, 0, 0] }}]"))
            .collect(),
        transform: "[]".to_owned(),
    };
    let scene = placed(&[group(MESHES[0], 5), group(MESHES[1], 3)]);
    let instances = scene.instances.as_ref().unwrap();
    let [tile, trellis] = [0, 1].map(|mesh| instances.meshes()[mesh].triangles.len() as u64);
    assert_eq!(instances.n_placed(), 5 * tile + 3 * trellis);
    assert_eq!(scene.world().n_primitives() as u64, 2 + tile + trellis);
    let accel = Accel::new(&scene, Acceleration::BruteForce);
    let mut cost = Cost::default();
    let ray = Ray {
        origin: Vec3::Z,
        direction: Vec3::X,
    };
    accel.nearest(&ray, &mut cost);
    assert_eq!(cost.primitive_tests, 2 + 8 + 5 * tile + 3 * trellis);
}

/// The outside of a closed mesh stays outside where its place mirrors it.
#[test]
fn mirrored_instances_keep_their_outside() {
    let group = Group {
        mesh: "{ file: meshes/spot.obj }",
        places: vec![
            "[{ translate: [-1.5, 0, 0] }]".to_owned(),
            "[{ scale: [-1, 1, 1] }, { translate: [1.5, 0, 0] }]".to_owned(),
        ],
        transform: "[]".to_owned(),
    };
    let scene = placed(&[group]);
    let accel = Accel::new(&scene, Default::default());
    let mut n_hits = [0, 0];
    for i in 0..4000 {
        let [x, y, u, v] = uniform([1, i, 0]).map(|number| 2.0 * number - 1.0);
        let origin = Vec3::new(9.0 * x, 9.0 * y, 9.0);
        let direction = (Vec3::new(2.5 * u, v, 0.0) - origin).normalize();
        let ray = Ray { origin, direction };
        let point = surface_point(&scene, &accel, &ray);
        let Some((point, id)) = point.and_then(|point| Some((point, point.instance?))) else {
            continue;
        };
        assert!(!point.is_flipped, "{point:?}");
        n_hits[id.0 as usize] += 1;
    }
    assert!(n_hits.iter().all(|&n| n > 200), "{n_hits:?}");
}

#[test]
fn the_film_knows_the_instance_of_each_pixel() {
    let group = Group {
        mesh: MESHES[1],
        places: vec![
            "[{ translate: [-1.5, 0, 0] }]".to_owned(),
            "[{ translate: [1.5, 0, 0] }]".to_owned(),
        ],
        transform: "[]".to_owned(),
    };
    let config = config(&group.placed());
    for cost in [CostMode::Counters, CostMode::Time, CostMode::SingleRayTime] {
        let film = film(&with_cost(config.clone(), cost), 2);
        let objects = film.values(|strip| &strip.object);
        let pixels: Vec<(i32, i32)> = objects.zip(film.values(|strip| &strip.instance)).collect();
        for (object, instance) in &pixels {
            assert_eq!(*instance >= 0, *object == 0);
        }
        for expected in [-1, 0, 1] {
            assert!(pixels.iter().any(|(_, instance)| *instance == expected));
        }
    }
}

/// A room that a lamp of instances lights.
fn lit(lamps: &str) -> String {
    format!(
        "image: {{ width: 24, height: 18, samples_per_pixel: 64 }}\n\
         camera: {{ look_at: {{ eye: [0, 1, 6], target: [0, 1, 0], fov_y_deg: 60 }} }}\n\
         shading: {{ model: path, max_depth: 3 }}\n\
         materials: {{ m: {{ color: 0.2, emission: [6, 5, 4], two_sided: false }}, floor: {{ color: 0.8 }} }}\n\
         lights: []\nobjects:\n{lamps}\
         \x20 - plane: {{ point: [0, -1, 0], normal: [0, 1, 0] }}\n    material: floor\n"
    )
}

#[test]
fn instances_emit_the_light_of_meshes_at_their_places() {
    let group = Group {
        mesh: "{ file: ../tests/files/tile.obj }",
        places: vec![
            "[{ scale: 0.5 }, { rotate: { axis: [1, 0, 0], angle_deg: 70 } }, { translate: [-2, 3, 0] }]"
                .to_owned(),
            "[{ scale: [0.4, 0.3, 0.8] }, { rotate: { axis: [1, 0, 0], angle_deg: 80 } }, { translate: [2, 3, 0] }]"
                .to_owned(),
        ],
        transform: "[]".to_owned(),
    };
    let [found, expected] =
        [group.placed(), group.written_out()].map(|lamps| radiance(&lit(&lamps)));
    let [found, expected] = [mean(&found), mean(&expected)];
    assert!(expected.min_element() > 0.05, "{expected}");
    assert!(
        found.abs_diff_eq(expected, 0.03 * expected.max_element()),
        "{found} {expected}"
    );
}

#[test]
fn too_many_lights_are_refused() {
    let group = Group {
        mesh: "{ file: meshes/spot.obj }",
        places: (0..200)
            .map(|i| format!("[{{ translate: [{i}, 0, 0] }}]"))
            .collect(),
        transform: "[]".to_owned(),
    };
    let mut config = parse(&lit(&group.placed()));
    let folder = crate::common::in_repository("configs");
    let geometries = Geometries::read(&mut config, folder.as_path(), u64::MAX).unwrap();
    let fault = scene::build::scene(&config, geometries).unwrap_err();
    assert!(
        fault.message.contains("emit light from 1171200 triangles"),
        "{fault:?}"
    );
}

/// The scene of a mesh whose places are given in another way.
fn placed_by(places: &str, material: &str) -> Scene {
    let mesh = "{ file: ../tests/files/tile.obj }";
    let object = format!("  - instances: {{ mesh: {mesh}, {places} }}\n    material: {material}\n");
    let mut text = String::from(
        "image: { width: 24, height: 18 }\n\
         camera: { look_at: { eye: [0, 0, 9], target: [0, 0, 0], fov_y_deg: 40 } }\n\
         materials: { m: { color: 1 }, speed: { color: { array: { name: speed, component: 2 } } } }\n\
         lights: []\nobjects:\n",
    );
    text.push_str(&object);
    scene_in_world(&parse(&text))
}

/// The transforms of all instances.
fn transforms(scene: &Scene) -> Vec<InstanceTransform> {
    let instances = scene.instances.as_ref().unwrap();
    let ids = (0..instances.n_instances() as u32).map(InstanceId);
    ids.map(|id| instances.get(id).transform).collect()
}

/// Whether two instances have the same place, up to rounding.
fn is_close(a: &InstanceTransform, b: &InstanceTransform) -> bool {
    let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    points
        .iter()
        .all(|&point| a.world_point(point).abs_diff_eq(b.world_point(point), 1e-4))
}

#[test]
fn a_table_places_as_the_steps_do() {
    let of_table = placed_by("points: { file: ../tests/files/places.csv, scale: 2 }", "m");
    let listed = placed_by(
        "places: [\
         [{ scale: 1 }, { rotate: { axis: [0, 1, 0], angle_deg: 90 } }, { translate: [1, 2, 3] }], \
         [{ scale: 4 }, { translate: [-1, 0, 2] }], \
         [{ scale: 3 }, { translate: [0, 0, -1] }]]",
        "m",
    );
    let (found, expected) = (transforms(&of_table), transforms(&listed));
    assert_eq!(found.len(), 3);
    assert!(
        found.iter().zip(&expected).all(|(a, b)| is_close(a, b)),
        "{found:?} {expected:?}"
    );
}

/// Against the spheres of the same points, whose numbers are read by themselves.
#[test]
fn points_of_a_vtk_file_scale_turn_and_color() {
    let file = "../tests/files/vtk/block_zlib.vtu";
    let places = format!(
        "points: {{ file: {file}, scale: {{ array: height of it, factor: 0.5 }}, orient: {{ array: speed }} }}"
    );
    let scene = placed_by(&places, "speed");
    let path = crate::common::in_repository("tests/files/vtk/block_zlib.vtu");
    let numbers = |name: &str, component| {
        let array = ArrayChoice::point_array(name, component);
        let points = import::read_points(&path, &RadiusChoice::Same(1.0), Some(&array)).unwrap();
        let numbers = points.scalars.unwrap().into_iter();
        (
            points.spheres,
            numbers.map(|number| number as f32).collect::<Vec<f32>>(),
        )
    };
    let (points, heights) = numbers("height of it", None);
    let [x, y, z] = [0, 1, 2].map(|component| numbers("speed", Some(component)).1);
    let kept: Vec<usize> = (0..points.len()).filter(|&i| heights[i] != 0.0).collect();
    assert!(kept.len() < points.len(), "a scale of 0 leaves points out");
    let found = transforms(&scene);
    assert_eq!(found.len(), kept.len());
    let instances = scene.instances.as_ref().unwrap();
    let mut units = Vec::new();
    for (i, (transform, &point)) in found.iter().zip(&kept).enumerate() {
        let along = transform.world_point(Vec3::X) - transform.world_point(Vec3::ZERO);
        let expected = Vec3::new(x[point], y[point], z[point]).normalize_or(Vec3::X);
        let expected = 0.5 * heights[point] * expected;
        // The mesh was scaled to size one by a power of two.
        let unit = (along.length() / expected.length()).log2().round().exp2();
        assert!(
            along.abs_diff_eq(unit * expected, 1e-4),
            "{i}: {along} {expected}"
        );
        units.push(unit);
        let placed = PlacedPrimitive {
            primitive: instances.meshes()[0].triangles.start,
            instance: Some(InstanceId(i as u32)),
        };
        assert_eq!(scene.vertex_scalars(placed), Some([z[point]; 3]));
    }
    assert!(units.iter().all(|unit| *unit == units[0]));
}

#[test]
fn a_cloud_of_instances_stays_in_its_box() {
    let text = "cloud: { count: 500, min: [-4, 1, -2], max: [4, 1, 2], scale: [0.5, 2], turn: [0, 1, 0], seed: 3 }";
    let found = transforms(&placed_by(text, "m"));
    assert_eq!(found.len(), 500);
    assert_eq!(found, transforms(&placed_by(text, "m")));
    let (mut n_backward, mut sizes) = (0, Vec::new());
    for transform in &found {
        let [origin, x, y] = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|at| transform.world_point(at));
        let size = (x - origin).length();
        sizes.push(size);
        assert!((y - origin).abs_diff_eq(size * Vec3::Y, 1e-4));
        n_backward += usize::from(x.x < origin.x);
    }
    assert!((150..350).contains(&n_backward), "{n_backward}");
    // In units of the size of the mesh.
    let [least, most] = [f32::min, f32::max].map(|of| sizes.iter().copied().reduce(of).unwrap());
    assert!((3.9..4.01).contains(&(most / least)), "{least} {most}");
}
