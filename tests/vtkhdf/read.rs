//! VTKHDF files that are read: they hold what VTK's XML files hold.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use import::{
    DataFile, FileFault, IsosurfaceChoice, Mesh, RadiusChoice, Spheres, read_isosurface,
    read_mesh_with, read_points, time_steps,
};
use world::material::ArrayChoice;

use serde_json::json;

use crate::common::data_set::DataSet;
use crate::common::in_repository;
use crate::render;

fn array(name: &str) -> ArrayChoice {
    ArrayChoice {
        name: name.to_owned(),
        component: None,
        of: None,
        is_color: false,
    }
}

/// The points of a file with the numbers of an array.
fn points(file: DataFile, name: &str) -> Result<Spheres, FileFault> {
    read_points(file, &RadiusChoice::Same(0.1), Some(&array(name)))
}

/// The spheres without the names of the file's arrays, whose order is that of the format.
fn spheres_of(path: &Path, step: Option<usize>, name: &str) -> Spheres {
    let file = DataFile { path, step };
    let spheres = points(file, name).unwrap_or_else(|fault| panic!("{fault}"));
    Spheres {
        arrays: Vec::new(),
        ..spheres
    }
}

/// The numbers of a mesh by their bits, those that are no number included.
fn bits(mesh: &Mesh) -> (Vec<u32>, Vec<[u32; 3]>, Vec<u64>) {
    let positions = mesh.vertices.iter().flat_map(|vertex| vertex.to_array());
    let scalars = mesh
        .scalars
        .iter()
        .flat_map(|scalars| scalars.values.clone());
    (
        positions.map(f32::to_bits).collect(),
        mesh.triangles.clone(),
        scalars.map(f64::to_bits).collect(),
    )
}

/// The files that raycost itself writes, and what their XML files hold.
#[test]
fn what_was_written_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let animation = "
animation:
  frames: 3
  fps: 2
  keyframes:
    objects[0].sphere.radius: [{ frame: 0, value: 0.8 }, { frame: 2, value: 0.4 }]
";
    let output = render(folder.path(), animation, &["--format=vtkhdf"]);
    assert!(output.status.success());
    let out = folder.path().join("out");
    for step in 0..3 {
        let xml = out.join(format!("frames/{step:04}/hits.vtu"));
        let hdf = out.join("series_hits.vtkhdf");
        for name in ["distance", "node_visits", "Normals"] {
            let found = spheres_of(&hdf, Some(step), name);
            let expected = spheres_of(&xml, None, name);
            assert!(
                found == expected && !found.spheres.is_empty(),
                "{step} {name}"
            );
        }
        let [xml, hdf] = [
            spheres_of(
                &out.join(format!("frames/{step:04}/frame.vti")),
                None,
                "rays",
            ),
            spheres_of(&out.join("series_frame.vtkhdf"), Some(step), "rays"),
        ];
        assert!(xml == hdf, "{step}");
    }
    let file = DataFile {
        path: &out.join("series_hits.vtkhdf"),
        step: Some(3),
    };
    let fault = points(file, "rays").unwrap_err();
    let expected = "it has no time step 3, expected one of its 3, of which the first is 0";
    assert!(fault.to_string().ends_with(expected), "{fault}");
}

/// A file of all time steps gives the frames of a list of files, and their times.
#[test]
fn the_steps_of_a_file_are_frames() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let run = |added: &str, flags: &[&str], name: &str| {
        let output = render(folder.path(), added, flags);
        assert!(output.status.success(), "{output:?}");
        fs::rename(at("out"), at(name)).unwrap();
    };
    let animation = "
animation:
  frames: 3
  fps: 2
  keyframes:
    objects[0].sphere.radius: [{ frame: 0, value: 0.8 }, { frame: 2, value: 0.4 }]
";
    run(animation, &["--format=vtkhdf"], "first");
    let spheres = |file: &str| {
        format!("  - spheres: {{ file: first/{file}, radius: 0.05 }}\n    material: red\n")
    };
    run(&spheres("series_hits.pvd"), &[], "list");
    run(&spheres("series_hits.vtkhdf"), &[], "whole");
    let frame = |out: &str| {
        let text = fs::read_to_string(at(out).join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
        let pixels = DataSet::read(&at(out).join("frame.vti"));
        (
            pixels.array("RGB").bytes.clone(),
            summary["frame"]["time"].clone(),
        )
    };
    for number in 0..3 {
        let [list, whole] =
            ["list", "whole"].map(|out| frame(&format!("{out}/frames/000{number}")));
        assert!(list.0 == whole.0, "{number}");
        assert_eq!(
            (&list.1, &whole.1),
            (&json!(0.5 * f64::from(number)), &list.1)
        );
    }
    let of_step = spheres("series_hits.vtkhdf").replace(", radius", ", step: 2, radius");
    run(&of_step, &[], "still");
    assert!(frame("still").0 == frame("whole/frames/0002").0);
}

/// A file that ends early or has wrong bytes is refused, or gives finite numbers: neither
/// raycost nor HDF5 crashes.
#[test]
fn damaged_files_are_refused_or_read() {
    let folder = tempfile::tempdir().unwrap();
    assert!(
        render(folder.path(), "", &["--format=vtkhdf"])
            .status
            .success()
    );
    let whole = fs::read(folder.path().join("out/hits.vtkhdf")).unwrap();
    damage(&whole, 400, |path| {
        let spheres = points(path.into(), "distance")?;
        assert!(
            spheres
                .spheres
                .iter()
                .all(|sphere| sphere.center.is_finite())
        );
        Ok(())
    });
}

/// Reads a file that is cut, and that has a wrong byte, at `n` places each.
fn damage(whole: &[u8], n: usize, read: impl Fn(&Path) -> Result<(), FileFault>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.vtkhdf");
    for place in 0..n {
        let at = whole.len() * place / n;
        let mut wrong = [whole.to_vec(), whole.to_vec(), whole.to_vec()];
        wrong[0].truncate(at);
        wrong[1][at] ^= 0xff;
        wrong[2][at] ^= 1;
        for (i, bytes) in wrong.iter().enumerate() {
            fs::write(&path, bytes).unwrap();
            let found = read(&path);
            assert!(i > 0 || found.is_err(), "cut at {at}");
            if let Err(fault) = found {
                assert!(fault.message().contains("damaged.vtkhdf"), "{fault}");
            }
        }
    }
}

/// Writes files by VTK: the VTKHDF file, the step and the XML file of each.
fn written_by_vtk(folder: &Path) -> Vec<(PathBuf, Option<usize>, PathBuf)> {
    let python = std::env::var("RAYCOST_PYTHON").expect("run tests/with-hdf5");
    let script = in_repository("tests/vtk/hdf_data_sets.py");
    let output = Command::new(python).arg(script).arg(folder).output();
    let output = output.unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let text = String::from_utf8(output.stdout).unwrap();
    let lines = text.lines().map(|line| {
        let line: serde_json::Value = serde_json::from_str(line).unwrap();
        let path = |key: &str| folder.join(line[key].as_str().unwrap());
        let step = line["step"].as_u64().map(|step| step as usize);
        (path("file"), step, path("xml"))
    });
    lines.collect()
}

#[test]
#[ignore = "needs PyPI's vtk: run tests/with-hdf5"]
fn files_of_vtk_hold_what_its_xml_files_hold() {
    let folder = tempfile::tempdir().unwrap();
    let files = written_by_vtk(folder.path());
    assert_eq!(files.len(), 20);
    for (path, step, xml) in &files {
        let file = DataFile { path, step: *step };
        for name in ["height of it", "speed", "number"] {
            if xml.ends_with("ball.vtp") {
                continue;
            }
            let choice = array(name);
            let [found, expected] = [file, xml.into()].map(|file| {
                let mesh = read_mesh_with(file, Some(&choice));
                mesh.unwrap_or_else(|fault| panic!("{fault}"))
            });
            assert!(bits(&found) == bits(&expected), "{path:?} {step:?} {name}");
            assert_eq!(found.arrays, expected.arrays);
        }
        let [found, expected] = [file, xml.into()].map(|file| {
            let mesh = read_mesh_with(file, None);
            mesh.unwrap_or_else(|fault| panic!("{fault}"))
        });
        assert!(found.normals == expected.normals, "{path:?}");
        let choice = IsosurfaceChoice {
            array: array("height of it"),
            values: vec![0.6, 2.25],
        };
        let [found, expected] = [file, xml.into()].map(|file| {
            let surface = read_isosurface(file, &choice, None);
            surface
                .map(|mesh| bits(&mesh))
                .map_err(|fault| fault.problem)
        });
        assert!(found == expected, "{path:?} {step:?}: {found:?}");
    }
    for (path, step, _) in &files {
        let file = DataFile { path, step: None };
        let steps = time_steps(Path::new(""), file).unwrap();
        let times = steps.map(|steps| steps.0.iter().map(|step| step.time).collect::<Vec<_>>());
        let n_steps = files.iter().filter(|(other, ..)| other == path).count();
        let expected = (0..n_steps).map(|step| 0.5 * step as f64).collect();
        assert_eq!(times, step.map(|_| expected), "{path:?}");
    }
    for (path, step, _) in files {
        let whole = fs::read(&path).unwrap();
        damage(&whole, 100, |path| {
            let file = DataFile { path, step };
            let mesh = read_mesh_with(file, Some(&array("speed")))?;
            assert!(mesh.vertices.iter().all(|vertex| vertex.is_finite()));
            Ok(())
        });
    }
}
