//! Ranks render the frames of an animation, one after the other.

use std::fs;

use crate::common::assert_success;
use crate::common::same_output::{assert_same_output, summary};
use crate::failures::assert_refused;
use crate::job::Job;

/// A cloud that spreads; hierarchies are refitted from the first frame's.
fn spreading() -> Job {
    let mut job = Job::new("seed_sphere", &["--cost=counters"]);
    let scene = "image: { width: 60, height: 40 }
camera: { look_at: { eye: [3, 3, 6], target: [0, 1, 0], fov_y_deg: 40 } }
lights: [{ point: { position: [2, 3, 5], intensity: 30 } }]
materials: { red: { color: [0.8, 0.2, 0.2] } }
objects:
  - sphere_cloud: { count: 400, min: [-1, 0, -1], max: [1, 2, 1], radius: [0.02, 0.1], seed: 3 }
    material: red
animation:
  frames: 4
  hierarchy: refit
  keyframes:
    objects[0].sphere_cloud.max: [{ frame: 1, value: [1, 2, 1] }, { frame: 3, value: [9, 2, 1] }]
";
    fs::write(job.path("spreading.yaml"), scene).unwrap();
    job.arguments[1] = "spreading.yaml".to_owned();
    job
}

#[test]
fn ranks_render_the_same_frames_as_one_process() {
    let small = [
        "--width=40",
        "--height=40",
        "--cost=counters",
        "--frames=3..5",
    ];
    for job in [spreading(), Job::new("hopper", &small)] {
        job.render_alone("alone");
        let output = job.render(3, "out", &[]);
        let text = String::from_utf8(output.stdout).unwrap();
        let lines = || text.lines().filter(|line| line.starts_with("frame "));
        assert!(lines().count() >= 3, "{text}");
        let refitted = lines().filter(|line| line.contains("refitted from frame 0"));
        assert_eq!(
            refitted.count() > 0,
            job.arguments[1] == "spreading.yaml",
            "{text}"
        );
        for frame in fs::read_dir(job.path("alone/frames")).unwrap() {
            let name = frame.unwrap().file_name();
            let [alone, by_ranks] =
                ["alone", "out"].map(|out| job.path(out).join("frames").join(&name));
            assert_same_output(&alone, &by_ranks);
            assert_eq!(summary(&by_ranks)["ranks"]["n"], 3);
        }
        let [alone, by_ranks] = ["alone/series.pvd", "out/series.pvd"]
            .map(|file| fs::read_to_string(job.path(file)).unwrap());
        assert_eq!(alone, by_ranks);
    }
}

#[test]
fn complete_frames_are_kept_by_any_number_of_ranks() {
    let job = spreading();
    job.render(2, "out", &["--frames=1..2"]);
    let text = String::from_utf8(job.render(3, "out", &[]).stdout).unwrap();
    assert!(text.contains("2 frames rendered"), "{text}");
    assert!(text.contains("2 complete from an earlier run"), "{text}");
    assert_eq!(summary(&job.path("out/frames/0001"))["ranks"]["n"], 2);
    assert_eq!(summary(&job.path("out/frames/0003"))["ranks"]["n"], 3);
}

#[test]
fn ranks_render_the_picture_of_one_frame() {
    let job = spreading();
    let output = job.ranks(2, "unused", &["--quiet"], "").output().unwrap();
    assert_success(&output);
    let mut one = job.launch();
    let program = env!("CARGO_BIN_EXE_raycost");
    one.args([
        "-n",
        "2",
        program,
        "render",
        "spreading.yaml",
        "--cost=counters",
    ]);
    one.args(["--threads=1", "--frames=3", "-o", "three.png"]);
    assert_success(&one.output().unwrap());
    let pixels = |file: &str| image::open(job.path(file)).unwrap().into_rgb8();
    assert!(pixels("three.png") == pixels("unused/frames/0003/image.png"));
}

#[test]
fn a_rank_whose_files_differ_at_a_later_frame_is_named() {
    let job = Job::new(
        "seed_sphere",
        &["--cost=counters", "--width=20", "--height=20"],
    );
    fs::create_dir(job.path("moving")).unwrap();
    for step in 0..2 {
        let triangle = format!(
            "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n\
             0 0 0 1 0 0 {step} 1 0\nPOLYGONS 1 4\n3 0 1 2\n"
        );
        fs::write(job.path(&format!("moving/{step}.vtk")), triangle).unwrap();
    }
    let series = "<VTKFile type=\"Collection\"><Collection>\
                  <DataSet timestep=\"0\" file=\"0.vtk\"/><DataSet timestep=\"1\" file=\"1.vtk\"/>\
                  </Collection></VTKFile>";
    fs::write(job.path("moving/steps.pvd"), series).unwrap();
    let scene = "image: { width: 20, height: 20 }
camera: { look_at: { eye: [0, 0, 6], target: [0, 0, 0], fov_y_deg: 40 } }
lights: [{ point: { position: [2, 3, 5], intensity: 30 } }]
materials: { red: { color: [0.8, 0.2, 0.2] } }
objects: [{ mesh: { file: steps.pvd }, material: red }]
animation: { fps: 2 }
";
    fs::write(job.path("moving/scene.yaml"), scene).unwrap();
    let mut job = job;
    job.arguments[1] = "moving/scene.yaml".to_owned();
    let other = "mkdir elsewhere; cp -r moving elsewhere; cd elsewhere; sed -i 's/1 1 0/1 2 0/' moving/1.vtk";
    let output = job.ranks(2, "out", &["--quiet"], other).output().unwrap();
    assert_refused(
        &output,
        2,
        "the files of the scene differ from the files of rank 0",
    );
    assert!(job.path("out/frames/0000/summary.json").exists());
    assert!(!job.path("out/frames/0001/summary.json").exists());
}
