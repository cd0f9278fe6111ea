//! `raycost trace` prints trees of rays and writes all rays to `rays.vtp`.

mod hottest;

use std::fs;
use std::path::Path;

use crate::common::data_set::DataSet;
use crate::common::{assert_success, config, counts, film, in_repository, raycost, with_cost};
use base::numbers::count;
use scene::config::CostMode;
use tracer::cost::Counter;

/// Traces pixels of a scene of `configs/` into a folder and returns the printed text.
fn trace(scene: &str, out: &Path, arguments: &[&str]) -> String {
    let output = raycost()
        .arg("trace")
        .arg(in_repository("configs").join(scene).with_extension("yaml"))
        .arg("--out")
        .arg(out)
        .args(arguments)
        .output()
        .unwrap();
    assert_success(&output);
    assert!(output.stderr.is_empty() && !output.stdout.contains(&0x1b));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn the_tree_of_a_pixel_is_printed() {
    let out = tempfile::tempdir().unwrap();
    let flags = ["--pixel=290,190", "--cost=counters"];
    let printed = trace("seed_extended", out.path(), &flags);
    let expected = "\
pixel 290,190     meets                   distance  nodes  tests      red    green     blue
camera            sphere 0 (blue)             1.64      1      4   0.050    0.050    0.654
├─ shadow         light 0                               1      4  (0.050)  (0.050)  (0.654)
└─ reflection     plane 3 (checkerboard)      0.54      1      4   0.025    0.025    0.025
   ├─ shadow      light 0                               1      1  (0.025)  (0.025)  (0.025)
   └─ reflection  background                            1      1   0.000    0.000    0.000
5 rays                                                  5     14   0.075    0.075    0.679
#1313ad in the picture

traced  5 rays of 1 pixel
";
    assert!(printed.starts_with(expected), "{printed}");
    // The folder may have a blank in its name: then the path is quoted.
    let path = printed.trim_end().trim_end_matches('\'');
    assert!(path.ends_with("rays.pvsm"), "{printed}");
    let mut names: Vec<_> = fs::read_dir(out.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(names, ["rays.pvsm", "rays.vtp", "rays_cloud.vtu"]);
}

#[test]
fn times_are_printed_if_measured() {
    let out = tempfile::tempdir().unwrap();
    let printed = trace("seed_extended", out.path(), &["--pixel=290,190"]);
    let header = printed.lines().next().unwrap();
    assert!(header.split_whitespace().any(|word| word == "time"));
    // Fast machines take nanoseconds, slow or busy ones seconds.
    let is_time = |pair: &[&str]| {
        pair[0].parse::<f64>().is_ok() && ["ns", "µs", "ms", "s"].contains(&pair[1])
    };
    let has_time = |line: &&str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        words.windows(2).any(is_time)
    };
    // Five rays and their sum.
    assert_eq!(printed.lines().filter(has_time).count(), 6, "{printed}");
}

#[test]
fn all_pixels_are_written_and_a_few_printed() {
    let out = tempfile::tempdir().unwrap();
    let flags = ["--pixel=280..299,190..199", "--pixel=290,195", "--spp=3"];
    let printed = trace("seed_extended", out.path(), &flags);
    assert_eq!(printed.matches("\npixel ").count() + 1, 3, "{printed}");
    assert!(printed.contains("camera, sample 2 "), "{printed}");
    assert!(
        printed.contains("\nand 197 more pixels in rays.vtp\n"),
        "{printed}"
    );
    let rays = DataSet::read(&out.path().join("rays.vtp"));
    let mut pixels: Vec<i32> = rays.array("pixel").i32s().collect();
    let n_rays = count(pixels.len() as u64);
    assert!(printed.contains(&format!("\ntraced  {n_rays} rays of 200 pixels\n")));
    pixels.dedup();
    let expected = (190..200).flat_map(|y| (280..300).map(move |x| y * 400 + x));
    assert_eq!(pixels, expected.collect::<Vec<_>>());
}

#[test]
fn a_few_of_many_rays_are_printed() {
    let out = tempfile::tempdir().unwrap();
    let printed = trace(
        "seed_extended",
        out.path(),
        &["--pixel=290,190", "--spp=100"],
    );
    assert_eq!(printed.lines().count(), 1 + 40 + 1 + 2 + 1 + 3, "{printed}");
    assert!(printed.contains(" more rays in rays.vtp\n"), "{printed}");
}

#[test]
fn a_color_above_1_is_limited_in_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let scene = fs::read_to_string(in_repository("configs/seed_sphere.yaml")).unwrap();
    let bright = scene.replace("ambient: 0.05", "ambient: [3, 0, 0]");
    assert_ne!(bright, scene);
    fs::write(folder.path().join("bright.yaml"), bright).unwrap();
    let output = raycost()
        .args(["trace", "bright.yaml", "--pixel", "200,200"])
        .current_dir(folder.path())
        .output();
    let output = output.unwrap();
    assert_success(&output);
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("\n#ff"), "{printed}");
    assert!(
        printed.contains(" in the picture, each sample limited to 1\n"),
        "{printed}"
    );
}

#[test]
fn quiet_prints_nothing() {
    let out = tempfile::tempdir().unwrap();
    let printed = trace("seed_extended", out.path(), &["--pixel=3,4", "--quiet"]);
    assert_eq!(printed, "");
    assert!(out.path().join("rays.vtp").exists());
}

/// The counters in `rays.vtp` sum to those of the film.
#[test]
fn the_rays_of_the_file_add_up_to_the_pixels_of_the_film() {
    let mut config = with_cost(config("hall_of_mirrors"), CostMode::Counters);
    (config.image.width, config.image.height) = (60, 40);
    let out = tempfile::tempdir().unwrap();
    let size = [
        "--width=60",
        "--height=40",
        "--pixel=0..59,0..39",
        "--quiet",
    ];
    trace("hall_of_mirrors", out.path(), &size);
    let film = film(&config, 2);
    let rays = DataSet::read(&out.path().join("rays.vtp"));
    let pixels: Vec<i32> = rays.array("pixel").i32s().collect();
    let kinds: Vec<i32> = rays.array("kind").i32s().collect();
    let sums = |counts: &mut dyn Iterator<Item = u32>| {
        let mut sums = vec![0; 60 * 40];
        for (count, pixel) in counts.zip(&pixels) {
            sums[*pixel as usize] += count;
        }
        sums
    };
    let of = |counter| counts(&film, counter);
    for (name, counter) in [
        ("node_visits", Counter::NodeVisits),
        ("primitive_tests", Counter::PrimitiveTests),
    ] {
        assert_eq!(sums(&mut rays.array(name).u32s()), of(counter), "{name}");
    }
    let of_kind = |kind| kinds.iter().map(move |&found| u32::from(found == kind));
    assert_eq!(sums(&mut of_kind(1)), of(Counter::ShadowRays));
    assert_eq!(sums(&mut of_kind(2)), of(Counter::ReflectionRays));
    assert_eq!(
        sums(&mut kinds.iter().map(|_| 1)),
        crate::common::rays(&film)
    );
    assert_eq!(rays.n_cells, Some(film.totals.n_rays() as usize));
    // A ray's parent precedes it.
    let parents = rays.array("parent").i32s();
    assert!(
        (0..)
            .zip(parents)
            .all(|(number, parent)| (-1..number).contains(&parent))
    );
}

#[test]
fn lines_run_from_the_origins_of_rays_to_their_hits() {
    let out = tempfile::tempdir().unwrap();
    trace(
        "seed_extended",
        out.path(),
        &["--pixel=0..399,150..155", "--quiet"],
    );
    let rays = DataSet::read(&out.path().join("rays.vtp"));
    let points: Vec<[f32; 3]> = rays.array("Points").triples().collect();
    let objects = rays.array("object").i32s();
    let distances: Vec<f32> = rays.array("distance").f32s().collect();
    let lengths: Vec<f32> = rays.array("length").f32s().collect();
    let mut n_misses = 0;
    for (number, object) in objects.enumerate() {
        let [start, end] = [0, 1].map(|i| glam::Vec3::from(points[2 * number + i]));
        let [length, distance] = [lengths[number], distances[number]];
        let drawn = start.distance(end);
        // The floor has hits up to the horizon, with few digits left.
        let rounding = 1e-4 + 1e-6 * start.length().max(length);
        assert!(
            (drawn - length).abs() <= rounding,
            "{start} to {end}: {length}"
        );
        match object {
            -1 => {
                assert!(
                    distance.is_nan() && length > 0.5 && length < 20.0,
                    "{length}"
                );
                n_misses += 1;
            }
            _ => assert_eq!(distance, length),
        }
    }
    assert!(n_misses > 100 && n_misses + 100 < lengths.len());
}

#[test]
fn invalid_pixels_are_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let scene = in_repository("configs/seed_extended.yaml");
    let cases = [
        (
            "--pixel=400,3",
            "there is no pixel 400,3 in the picture",
            "400 x 300 pixels",
        ),
        (
            "--pixel=0..9,300..301",
            "there is no pixel 0..9,300..301 in the picture",
            "to 399,299",
        ),
        (
            "--pixel=3",
            "invalid value '3' for '--pixel <X,Y>'",
            "such as 120,80",
        ),
        (
            "--pixel=9..3,4",
            "invalid value '9..3,4' for '--pixel <X,Y>'",
            "such as 120,80",
        ),
        (
            "--pixel=-1,4",
            "invalid value '-1,4' for '--pixel <X,Y>'",
            "such as 120,80",
        ),
        (
            "--quiet",
            "required arguments were not provided",
            "--pixel <X,Y>",
        ),
    ];
    for (flag, message, help) in cases {
        let output = raycost()
            .arg("trace")
            .arg(&scene)
            .arg(flag)
            .current_dir(folder.path())
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(
            said.starts_with("error: ") && said.contains(message) && said.contains(help),
            "{said}"
        );
        assert!(output.stdout.is_empty());
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_trace_leaves_the_files_of_a_rendering() {
    let out = tempfile::tempdir().unwrap();
    fs::write(out.path().join("image.png"), "of another command").unwrap();
    trace("seed_sphere", out.path(), &["--pixel=3,4"]);
    assert_eq!(
        fs::read(out.path().join("image.png")).unwrap(),
        b"of another command"
    );
}

#[test]
fn optional_outputs_are_refused() {
    let scene = in_repository("configs/seed_sphere.yaml");
    let output = raycost()
        .arg("trace")
        .arg(scene)
        .args(["--pixel=3,4", "--also=bvh"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("give `--also` to `raycost render`"), "{said}");
}
