//! Each rank reads the files of a scene.

use std::fs;

use crate::common::assert_success;
use crate::common::same_output::{assert_same_output, summary};
use crate::failures::assert_refused;
use crate::job::{Job, is_written};

const SMALL: [&str; 3] = ["--width=40", "--height=30", "--cost=counters"];

/// Takes the other ranks to another folder with the same scene, as on a machine that has a copy of
/// the files, after `change` has changed the copy.
fn elsewhere(change: &str) -> String {
    format!("mkdir -p elsewhere; cp -r linked elsewhere; cd elsewhere; {change}")
}

/// A job whose scene includes a file, and has a mesh with a texture.
fn linked_job() -> Job {
    let mut job = Job::new("seed_sphere", &SMALL);
    let folder = job.path("linked");
    fs::create_dir(&folder).unwrap();
    let pixel = image::RgbImage::from_pixel(4, 4, image::Rgb([200, 80, 40]));
    pixel.save(folder.join("brick.png")).unwrap();
    let wall = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    fs::write(folder.join("wall.obj"), wall).unwrap();
    let matte = "materials: { matte: { color: { image: { file: brick.png } } } }\n";
    fs::write(folder.join("matte.yaml"), matte).unwrap();
    let scene = "include: [matte.yaml]
image: { width: 40, height: 30 }
camera: { look_at: { eye: [0, 0, 6], target: [0, 0, 0], fov_y_deg: 40 } }
lights: [{ point: { position: [2, 3, 5], intensity: 30 } }]
objects: [{ material: matte, mesh: { file: wall.obj } }]
";
    fs::write(folder.join("scene.yaml"), scene).unwrap();
    job.arguments[1] = "linked/scene.yaml".to_owned();
    job
}

#[test]
fn each_rank_may_have_its_own_copy_of_the_files() {
    let job = linked_job();
    job.render_alone("alone");
    let output = job.ranks(3, "out", &[], &elsewhere("")).output().unwrap();
    assert_success(&output);
    assert_same_output(&job.path("alone"), &job.path("out"));
    assert_eq!(summary(&job.path("out"))["ranks"]["n"], 3);
}

#[test]
fn a_copy_that_differs_is_refused() {
    for (change, expected) in [
        (
            "echo '# other' >> linked/wall.obj",
            "the files of the scene differ from the files of rank 0",
        ),
        (
            "echo 'max_memory: 3' >> linked/matte.yaml",
            "unknown key `max_memory`",
        ),
        ("rm linked/brick.png", "brick.png"),
        ("rm linked/wall.obj", "`linked/wall.obj`: cannot read it"),
    ] {
        let job = linked_job();
        let output = job
            .ranks(2, "out", &[], &elsewhere(change))
            .output()
            .unwrap();
        assert_refused(&output, 2, "rank 1 ");
        assert_refused(&output, 2, expected);
        assert!(!is_written(&job.path("out")));
    }
}

#[test]
fn a_file_that_no_rank_can_read_is_one_message() {
    for (file, contents, expected) in [
        ("wall.obj", None, "`linked/wall.obj`: cannot read it"),
        (
            "brick.png",
            Some("no picture"),
            "brick.png`: it is not a picture",
        ),
        ("matte.yaml", Some("materials: 3"), "linked/matte.yaml"),
    ] {
        let job = linked_job();
        let path = job.path("linked").join(file);
        match contents {
            None => fs::remove_file(path).unwrap(),
            Some(contents) => fs::write(path, contents).unwrap(),
        }
        let output = job.ranks(3, "out", &[], "").output().unwrap();
        assert_refused(&output, 2, expected);
        assert!(!is_written(&job.path("out")));
    }
}

#[test]
fn a_rank_with_too_little_memory_is_named() {
    let mut job = linked_job();
    // Reading it may take 60 bytes for each of its bytes.
    let filler = format!("# {}\n", "x".repeat(1 << 20)).repeat(40);
    let path = job.path("linked/wall.obj");
    let wall = fs::read_to_string(&path).unwrap();
    fs::write(path, format!("{filler}{wall}")).unwrap();
    job.arguments.push("--quiet".to_owned());
    let output = job
        .ranks(2, "out", &[], "ulimit -v 2000000")
        .output()
        .unwrap();
    assert_refused(&output, 2, "rank 1 ");
    assert_refused(&output, 2, "`linked/wall.obj` is too large");
}
