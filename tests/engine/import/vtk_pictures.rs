//! Pictures of data sets in flat colors are those that VTK draws.

use std::process::Command;

use crate::common::{film, in_repository, parse};

const SIZE: [usize; 2] = [320, 240];

/// What is shown: the file, what VTK makes of it, the object that shows the same, the array
/// of the colors and its range, and the camera.
struct View {
    file: &'static str,
    how: &'static str,
    object: &'static str,
    array: &'static str,
    range: [f64; 2],
    eye: &'static str,
    target: &'static str,
}

const PIPE: View = View {
    file: "elbow.vtu",
    how: "surface",
    object: "mesh: { file: data/elbow.vtu }",
    array: "",
    range: [0.0; 2],
    eye: "3.4,3.6,8.6",
    target: "1,0.7,0",
};

const VIEWS: [View; 5] = [
    View {
        array: "temperature",
        range: [290.0, 345.0],
        ..PIPE
    },
    View {
        array: "displacement",
        range: [0.0, 1.2],
        ..PIPE
    },
    View {
        array: "stress",
        range: [0.0, 60.0],
        ..PIPE
    },
    View {
        file: "abc_streamlines.vtp",
        how: "tubes=0.2",
        object: "tubes: { file: data/abc_streamlines.vtp, radius: 0.2 }",
        array: "velocity",
        range: [0.0, 3.5],
        eye: "11,8,12",
        target: "3.2,3.2,3.1",
    },
    View {
        file: "abc_flow.vti",
        how: "isosurface=2.8",
        object: "mesh: { file: data/abc_flow.vti, isosurface: { array: velocity, value: 2.8 } }",
        array: "velocity, component: 1",
        range: [-3.0, 3.0],
        eye: "11,8,12",
        target: "3.2,3.2,3.1",
    },
];

impl View {
    /// The scene in white light, which shows the colors of an array alone.
    fn scene(&self) -> scene::config::Config {
        let Self {
            object,
            array,
            range: [low, high],
            eye,
            target,
            ..
        } = self;
        let [width, height] = SIZE;
        parse(&format!(
            "
image: {{ width: {width}, height: {height} }}
camera: {{ look_at: {{ eye: [{eye}], target: [{target}], fov_y_deg: 36 }} }}
background: 0
shading: {{ ambient: 1 }}
materials:
  field: {{ color: {{ array: {{ name: {array}, range: [{low}, {high}] }} }}, diffuse: 0 }}
objects:
  - {object}
    material: field
lights: []
"
        ))
    }

    /// The pixels that VTK draws.
    fn by_vtk(&self) -> Vec<[u8; 3]> {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("picture");
        let [low, high] = self.range.map(|end| end.to_string());
        let [width, height] = SIZE.map(|side| side.to_string());
        let python = std::env::var("RAYCOST_PYTHON").expect("run tests/with-paraview");
        let output = Command::new(python)
            .arg(in_repository("tests/vtk/picture.py"))
            .arg(in_repository("configs/data").join(self.file))
            .args([self.how, self.array, &low, &high, &width, &height, "36"])
            .args([self.eye, self.target])
            .arg(&out)
            .output()
            .unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{errors}");
        let pixels = std::fs::read(&out).unwrap();
        pixels.as_chunks().0.to_vec()
    }
}

/// Whether a pixel shows another part of the surface than its neighbors.
fn is_edge(distances: &[f32], at: usize) -> bool {
    let [width, height] = SIZE;
    let (x, y) = (at % width, at / width);
    let neighbors = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [dx, dy]));
    let distance = |[dx, dy]: [isize; 2]| {
        let (x, y) = (x.checked_add_signed(dx), y.checked_add_signed(dy));
        let inside = x.zip(y).filter(|(x, y)| *x < width && *y < height);
        inside.map_or(0.0, |(x, y)| distances[width * y + x])
    };
    let here = distances[at];
    !neighbors
        .map(distance)
        .all(|there| (there - here).abs() < 0.3)
}

#[test]
#[ignore = "needs VTK: tests/with-paraview"]
fn pictures_of_arrays_are_those_of_vtk() {
    for view in VIEWS {
        let film = film(&view.scene(), 2);
        let expected = view.by_vtk();
        let found: Vec<[u8; 3]> = film.values(|strip| &strip.rgb).collect();
        let distances: Vec<f32> = film.values(|strip| &strip.distance).collect();
        let is_shown = |i: &usize| distances[*i] > 0.0 && distances[*i].is_finite();
        let shown = (0..found.len()).filter(is_shown);
        let inner: Vec<usize> = shown.filter(|i| !is_edge(&distances, *i)).collect();
        let is_near = |i: &&usize| {
            let mut channels = found[**i].iter().zip(expected[**i]);
            channels.all(|(a, b)| a.abs_diff(b) <= 3)
        };
        let n_near = inner.iter().filter(is_near).count();
        let (n, what) = (inner.len(), format!("{}, {}", view.how, view.array));
        assert!(n > 10_000, "{what}: {n} pixels");
        assert!(100 * n_near >= 99 * n, "{what}: {n_near} of {n}");
    }
}
