//! Rank 0 alone reads the files of a scene.

use std::fs;
use std::path::Path;

use crate::common::assert_success;
use crate::common::same_output::{assert_same_output, summary};
use crate::failures::assert_refused;
use crate::job::{Job, is_written};

const SMALL: [&str; 3] = ["--width=40", "--height=30", "--cost=counters"];

/// Takes the other ranks to an empty folder, as one of a machine without the files.
const ELSEWHERE: &str = "mkdir -p elsewhere; cd elsewhere; test ! -e configs || exit 7";

/// Checks that ranks without files render the picture of one process that has them.
fn assert_rendered_without_files(job: &Job) {
    job.render_alone("alone");
    let output = job
        .ranks(3, "out", &["--quiet"], ELSEWHERE)
        .output()
        .unwrap();
    assert_success(&output);
    assert_same_output(&job.path("alone"), &job.path("out"));
    assert_eq!(summary(&job.path("out"))["ranks"]["n"], 3);
}

#[test]
fn only_rank_0_needs_the_files() {
    // OBJ, PNG, glTF, tables and VTK's files.
    for scene in ["spot_under_a_sky", "lamp", "trellis", "isosurface", "elbow"] {
        assert_rendered_without_files(&Job::new(scene, &SMALL));
    }
}

/// A scene of files that name others.
fn write_linked_scene(folder: &Path) {
    let pixel = image::RgbImage::from_pixel(4, 4, image::Rgb([200, 80, 40]));
    pixel.save(folder.join("brick.png")).unwrap();
    fs::write(
        folder.join("red bricks.mtl"),
        "newmtl brick\nmap_Kd brick.png\n",
    )
    .unwrap();
    let wall = "mtllib red bricks.mtl\nusemtl brick\nv -1 -1 0\nv 1 -1 0\nv 0 1 0\n\
                vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    fs::write(folder.join("wall.obj"), wall).unwrap();
    let piece = |x: f32| {
        format!(
            "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\"><PolyData><Piece \
             NumberOfPoints=\"3\" NumberOfPolys=\"1\"><Points><DataArray type=\"Float32\" \
             NumberOfComponents=\"3\" format=\"ascii\">{x} 0 1 {} 0 1 {x} 1 1</DataArray></Points>\
             <Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2\
             </DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray>\
             </Polys></Piece></PolyData></VTKFile>",
            x + 1.0
        )
    };
    fs::write(folder.join("left.vtp"), piece(-1.0)).unwrap();
    fs::write(folder.join("right.vtp"), piece(0.5)).unwrap();
    let both = "<VTKFile type=\"PPolyData\"><PPolyData><Piece Source=\"left.vtp\"/>\
                <Piece Source=\"right.vtp\"/></PPolyData></VTKFile>";
    fs::write(folder.join("both.pvtp"), both).unwrap();
    fs::write(
        folder.join("matte.yaml"),
        "materials: { matte: { color: [0.5, 0.6, 0.7] } }\n",
    )
    .unwrap();
    let scene = "include: [matte.yaml]
image: { width: 40, height: 30 }
camera: { look_at: { eye: [0, 0, 6], target: [0, 0, 0], fov_y_deg: 40 } }
lights: [{ point: { position: [2, 3, 5], intensity: 30 } }]
objects:
  - mesh: { file: wall.obj }
  - { material: matte, mesh: { file: both.pvtp } }
";
    fs::write(folder.join("scene.yaml"), scene).unwrap();
}

/// A job with that scene.
fn linked_job() -> Job {
    let mut job = Job::new("seed_sphere", &SMALL);
    fs::create_dir(job.path("linked")).unwrap();
    write_linked_scene(&job.path("linked"));
    job.arguments[1] = "linked/scene.yaml".to_owned();
    job
}

#[test]
fn files_that_files_name_are_those_of_rank_0() {
    assert_rendered_without_files(&linked_job());
    // A mesh is a scene, too.
    let mut job = linked_job();
    job.arguments[1] = "linked/wall.obj".to_owned();
    assert_rendered_without_files(&job);
}

#[test]
fn a_file_that_rank_0_cannot_read_is_one_message() {
    for (file, contents, expected) in [
        ("both.pvtp", None, "`linked/both.pvtp`: cannot read it"),
        ("right.vtp", None, "`linked/right.vtp`: cannot read it"),
        ("right.vtp", Some("<VTKFile>"), "`linked/right.vtp`"),
        (
            "brick.png",
            Some("no picture"),
            "brick.png`: it is not a picture",
        ),
        ("red bricks.mtl", None, "there is no such file"),
        ("matte.yaml", Some("materials: 3"), "linked/matte.yaml"),
    ] {
        let job = linked_job();
        let path = job.path("linked").join(file);
        match contents {
            None => fs::remove_file(path).unwrap(),
            Some(contents) => fs::write(path, contents).unwrap(),
        }
        let output = job.ranks(3, "out", &[], ELSEWHERE).output().unwrap();
        assert_refused(&output, 2, expected);
        assert!(!is_written(&job.path("out")));
    }
}

#[test]
fn a_rank_with_too_little_memory_is_named() {
    let mut job = linked_job();
    // Reading it may take 60 bytes for each of its bytes, which come in more than one message.
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
