//! The examples do what their first lines say, and a session does what a program
//! expects of it.

use std::fs;
use std::sync::atomic::{AtomicU64, Ordering};

use ::render::film::Film;
use output::results::Results;
use raycost::session::{Cancellation, Event, Options, RenderError, Session, Stopped};
use scene::config::{Config, CostMode};
use tracer::cost::{Counter, Metric};
use world::geometry::{Shape, Triangle};
use world::scene::MaterialId;

use glam::Vec3;
use serde_json::json;

use crate::common::{counts, in_repository, names};

#[allow(dead_code, reason = "`main` is for cargo")]
#[path = "../../examples/cost_histogram.rs"]
mod cost_histogram;
#[allow(dead_code, reason = "`main` is for cargo")]
#[path = "../../examples/rays.rs"]
mod rays;
#[allow(dead_code, reason = "`main` is for cargo")]
#[path = "../../examples/render.rs"]
mod render;
#[allow(dead_code, reason = "`main` is for cargo")]
#[path = "../../examples/scene_in_code.rs"]
mod scene_in_code;
#[allow(dead_code, reason = "`main` is for cargo")]
#[path = "../../examples/two_spheres.rs"]
mod two_spheres;

#[test]
fn the_example_of_ten_lines_writes_every_file() {
    let folder = tempfile::tempdir().unwrap();
    render::run(&in_repository("configs/seed_sphere.yaml"), folder.path()).unwrap();
    let written = names(folder.path());
    for file in [
        "image.png",
        "cost.png",
        "hits.vtu",
        "frame.vti",
        "summary.json",
    ] {
        assert!(written.iter().any(|name| name == file), "{written:?}");
    }
}

#[test]
fn the_histogram_counts_every_pixel_once() {
    let text = cost_histogram::histogram(&in_repository("configs/trellis.yaml")).unwrap();
    let counts = text.lines().map(|line| line.rsplit(' ').next().unwrap());
    let n_pixels: usize = counts.map(|count| count.parse::<usize>().unwrap()).sum();
    let config = crate::common::config("trellis");
    assert_eq!(n_pixels, config.image.n_pixels());
}

#[test]
fn a_scene_in_code_is_rendered_and_written() {
    let folder = tempfile::tempdir().unwrap();
    scene_in_code::run(folder.path()).unwrap();
    let results = Results::open(folder.path()).unwrap();
    assert_eq!(results.summary.scene.name, "helix");
    assert!(fs::metadata(folder.path().join("image.png")).unwrap().len() > 1000);
}

#[test]
fn a_mistake_in_a_scene_in_code_is_shown_in_its_yaml() {
    let scene = json!({ "image": { "width": 0, "height": 10 } });
    let error = Session::from_value("tiny", &scene).unwrap_err().to_string();
    assert!(error.contains("image: { width: 0, height: 10 }"), "{error}");
    assert!(error.contains("tiny:"), "{error}");
}

#[test]
fn a_config_that_a_program_has_changed_is_a_scene() {
    let mut config = crate::common::config("hall_of_mirrors");
    config.shading.max_depth = 3;
    let session = Session::from_value("mirrors", &config).unwrap();
    assert!(session.config().filled() == config.filled());
}

/// A session of a scene file with counters alone: its results never vary.
fn counted(name: &str) -> Session {
    let path = in_repository(&format!("configs/{name}.yaml"));
    Session::open_with(path, |config| config.cost = CostMode::Counters).unwrap()
}

#[test]
fn a_size_that_a_program_sets_out_of_range_is_refused() {
    let changes: [fn(&mut Config); 3] = [
        |config| config.image.width = 0,
        |config| config.image.samples_per_pixel = 0,
        |config| config.tiles.size = 1,
    ];
    for change in changes {
        let path = in_repository("configs/seed_sphere.yaml");
        let error = Session::open_with(path, change).unwrap_err().to_string();
        assert!(error.contains("cannot be"), "{error}");
    }
}

#[test]
fn a_session_renders_again_with_the_same_result() {
    let session = counted("blocks");
    let options = |threads| Options {
        threads: Some(threads),
        ..Options::default()
    };
    let [one, two] = [1, 2].map(|threads| session.render(&options(threads)).unwrap());
    for metric in Metric::ALL {
        assert_eq!(one.film().metric(metric), two.film().metric(metric));
    }
    let built = |rendering: &raycost::session::Rendering| {
        let mut stages = rendering.stages().ended.iter();
        stages.any(|stage| stage.name == "build")
    };
    assert!(built(&one) && !built(&two), "the second one builds nothing");
}

#[test]
fn events_report_every_pixel() {
    let session = counted("seed_sphere");
    let (expected, rendered) = (AtomicU64::new(0), AtomicU64::new(0));
    let on_event = |event| match event {
        Event::Begin { n_pixels, .. } => {
            expected.fetch_add(n_pixels, Ordering::Relaxed);
        }
        Event::Rendered(progress) => {
            rendered.fetch_add(progress.n_pixels, Ordering::Relaxed);
        }
        Event::Built { .. } | Event::End => {}
    };
    let options = Options {
        on_event: Some(&on_event),
        ..Options::default()
    };
    session.render(&options).unwrap();
    let n_pixels = session.config().image.n_pixels() as u64;
    assert_eq!(expected.into_inner(), n_pixels);
    assert_eq!(rendered.into_inner(), n_pixels);
}

#[test]
fn a_canceled_rendering_ends_and_another_one_goes_on() {
    let session = counted("seed_sphere");
    let cancellation = Cancellation::default();
    let options = Options {
        cancellation: cancellation.clone(),
        // In the middle of the picture.
        on_event: Some(&|event| {
            if matches!(event, Event::Rendered(_)) {
                cancellation.cancel();
            }
        }),
        ..Options::default()
    };
    match session.render(&options) {
        Err(RenderError::Stopped(stopped, _)) => assert_eq!(stopped, Stopped::Canceled),
        other => panic!("{other:?}"),
    }
    assert!(session.render(&Options::default()).is_ok());
}

#[test]
fn rays_of_a_program_measure_the_height_of_its_terrain() {
    let scene = rays::terrain(100).unwrap();
    let (mean, cost) = rays::mean_height(&scene, 150);
    // The sine is odd, so that the terrain is as deep as it is high.
    assert!(mean.abs() < 1e-4, "{mean}");
    let n = 150.0 * 150.0;
    let [tests, visits] = [cost.primitive_tests, cost.node_visits].map(|n_all| n_all as f64 / n);
    assert!((1.0..20.0).contains(&tests), "{tests}");
    assert!((1.0..20.0).contains(&visits), "{visits}");
}

#[test]
fn a_scene_is_unchanged_by_shapes_that_it_refuses() {
    let mut scene = rays::terrain(2).unwrap();
    let n = scene.primitives.len();
    let sound = scene.primitives[0].world_shape().unwrap().clone();
    let point = Shape::Triangle(Triangle {
        vertices: [Vec3::ONE; 3],
    });
    assert!(scene.add_shapes([sound, point], MaterialId(0)).is_none());
    assert_eq!((scene.primitives.len(), scene.n_objects()), (n, 1));
}

/// The same scene as a file.
const TWO_SPHERES: &str = "
image: { width: 40, height: 30 }
camera: { look_at: { eye: [0, 1, 6], target: [0, 0, 0], fov_y_deg: 30 } }
cost: counters
materials: { clay: { color: [0.8, 0.4, 0.3] } }
lights: [{ point: { position: [3, 5, 4] } }]
objects:
  - sphere: { center: [-0.5, 0, 0], radius: 1 }
    material: clay
  - sphere: { center: [1, 0, 0], radius: 0.5 }
    material: clay
";

#[test]
fn a_scene_of_types_is_that_of_a_file() {
    let (film, cost) = two_spheres::picture(40, 30).unwrap();
    let expected = crate::common::film(&crate::common::parse(TWO_SPHERES), 1);
    let pixels = |film: &Film| film.values(|strip| &strip.rgb).collect::<Vec<_>>();
    assert!(film.n_hits() > 200 && pixels(&film) == pixels(&expected));
    let counts = [film, expected].map(|film| counts(&film, Counter::NodeVisits));
    assert_eq!(counts[0], counts[1]);
    assert!(cost.node_visits > 0 && cost.primitive_tests > 0);
}
