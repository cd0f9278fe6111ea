//! VTKHDF: with the feature `hdf5`, `raycost render --format vtkhdf` also writes cloud and
//! frame so, and scenes may name such files; without, it says so.

#[path = "../common/mod.rs"]
mod common;

use std::path::Path;
use std::process::Output;

/// A ball on a floor.
const BALL: &str = "
image: { width: 48, height: 36 }
camera: { look_at: { eye: [0, 1.5, 6], target: [0, 0.5, 0], fov_y_deg: 40 } }
cost: counters
materials:
  red: { color: [0.8, 0.2, 0.1], reflection: 0.3 }
lights: [{ point: { position: [5, 8, 6], intensity: 0.9 } }]
objects:
  - sphere: { center: [0, 0.8, 0], radius: 0.8 }
    material: red
  - plane: { point: [0, 0, 0], normal: [0, 1, 0] }
    material: red
";

/// Renders the ball and what is added to it into the folder `out`, with flags.
fn render(folder: &Path, added: &str, flags: &[&str]) -> Output {
    std::fs::write(folder.join("ball.yaml"), format!("{BALL}{added}")).unwrap();
    let mut raycost = common::raycost();
    raycost.args(["render", "ball.yaml", "--out=out", "--threads=1", "--quiet"]);
    raycost.args(flags).current_dir(folder).output().unwrap()
}

#[cfg(not(feature = "hdf5"))]
#[test]
fn without_hdf5_it_says_how_to_build_it() {
    let folder = tempfile::tempdir().unwrap();
    let output = render(folder.path(), "", &["--format=vtkhdf"]);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8(output.stderr).unwrap();
    let expected = "error: this raycost was built without HDF5";
    assert!(message.starts_with(expected), "{message}");
    assert!(message.contains("--features hdf5"), "{message}");
    assert!(output.stdout.is_empty() && !folder.path().join("out").exists());
}

#[cfg(not(feature = "hdf5"))]
#[test]
fn without_hdf5_files_of_a_scene_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("flow.vtkhdf");
    std::fs::write(&file, b"\x89HDF\r\n\x1a\n").unwrap();
    let fault = import::read_mesh(&file).unwrap_err().to_string();
    assert!(fault.contains("--features hdf5"), "{fault}");
    assert!(fault.contains("flow.vtkhdf"), "{fault}");
}

#[cfg(feature = "hdf5")]
mod read;

#[cfg(feature = "hdf5")]
mod built {
    use std::fs;
    use std::process::Command;

    use super::*;
    use common::{assert_success, in_repository};

    const FILES: [&str; 2] = ["hits.vtkhdf", "frame.vtkhdf"];
    const ANIMATION: &str = "
animation:
  frames: 3
  fps: 2
  keyframes:
    objects[0].sphere.radius: [{ frame: 0, value: 0.8 }, { frame: 2, value: 0.4 }]
";

    fn rendered(folder: &Path, added: &str, flags: &[&str]) {
        assert_success(&render(folder, added, flags));
    }

    /// Compares a file with VTK's XML files, as VTK reads them.
    fn compare(folder: &Path, file: &str, steps: &[String]) {
        let python = std::env::var("RAYCOST_PYTHON").expect("run tests/with-hdf5");
        let mut compare = Command::new(python);
        compare.arg(in_repository("tests/vtk/compare_hdf.py"));
        let out = folder.join("out");
        let output = compare.arg(file).args(steps).current_dir(out).output();
        assert_success(&output.unwrap());
    }

    #[test]
    fn equal_runs_write_equal_bytes_and_the_summary_lists_them() {
        let folder = tempfile::tempdir().unwrap();
        let read = || FILES.map(|file| fs::read(folder.path().join("out").join(file)).unwrap());
        rendered(folder.path(), "", &["--format=vtkhdf"]);
        let first = read();
        assert!(first[0].starts_with(b"\x89HDF\r\n\x1a\n"));
        let xml = fs::metadata(folder.path().join("out/frame.vti")).unwrap();
        assert!((first[1].len() as u64) < xml.len());
        rendered(folder.path(), "", &["--format=vtkhdf"]);
        assert!(first == read());
        let check = common::raycost()
            .arg("check")
            .arg(folder.path().join("out"))
            .output();
        let check = check.unwrap();
        assert_success(&check);
        let text = String::from_utf8_lossy(&check.stdout).into_owned();
        // Without the format, they go with the other old files.
        rendered(folder.path(), "", &[]);
        for file in FILES {
            assert!(!folder.path().join("out").join(file).exists(), "{text}");
        }
    }

    #[test]
    fn an_animation_has_one_file_of_all_steps_which_goes_with_the_format() {
        let folder = tempfile::tempdir().unwrap();
        rendered(folder.path(), ANIMATION, &["--format=vtkhdf"]);
        let of_series = FILES.map(|file| folder.path().join("out").join(format!("series_{file}")));
        assert!(of_series.iter().all(|file| file.exists()));
        assert!(!folder.path().join("out/frames/0000/hits.vtkhdf").exists());
        let before = of_series.clone().map(|file| fs::read(file).unwrap());
        rendered(folder.path(), ANIMATION, &["--format=vtkhdf"]);
        assert!(before == of_series.clone().map(|file| fs::read(file).unwrap()));
        rendered(folder.path(), ANIMATION, &[]);
        assert!(!of_series.iter().any(|file| file.exists()));
    }

    #[test]
    #[ignore = "needs PyPI's vtk: run tests/with-hdf5"]
    fn vtk_reads_what_is_in_the_xml_files() {
        let looks_away = "--set=camera.look_at.target=[0, 9, 6.1]";
        let many = [
            "--format=vtkhdf",
            "--width=640",
            "--height=480",
            "--cost=time",
        ];
        for flags in [
            &many[..],
            &["--format=vtkhdf"],
            &["--format=vtkhdf", looks_away],
        ] {
            let folder = tempfile::tempdir().unwrap();
            rendered(folder.path(), "", flags);
            compare(folder.path(), "hits.vtkhdf", &["hits.vtu".to_owned()]);
            compare(folder.path(), "frame.vtkhdf", &["frame.vti".to_owned()]);
        }
    }

    #[test]
    #[ignore = "needs PyPI's vtk: run tests/with-hdf5"]
    fn vtk_reads_each_step_of_an_animation() {
        let folder = tempfile::tempdir().unwrap();
        rendered(folder.path(), ANIMATION, &["--format=vtkhdf"]);
        for (file, of_frame) in [("hits", "hits.vtu"), ("frame", "frame.vti")] {
            let steps = [0, 1, 2].map(|n| format!("{}=frames/{n:04}/{of_frame}", 0.5 * n as f32));
            compare(folder.path(), &format!("series_{file}.vtkhdf"), &steps);
        }
    }
}
