//! Lines of files become tubes.

use std::path::Path;

use glam::Vec3;
use import::{RadiusChoice, Tubes, read_lines, read_tubes};
use world::geometry::{Capsule, Shape};
use world::material::{ArrayChoice, ArrayOf};

use super::{message, reading};
use crate::common::in_repository;

fn choice(name: &str, of: Option<ArrayOf>) -> ArrayChoice {
    ArrayChoice {
        is_color: false,
        name: name.to_owned(),
        component: None,
        of,
    }
}

fn thickness() -> RadiusChoice {
    RadiusChoice::Array {
        array: choice("thickness", Some(ArrayOf::Points)),
        factor: 2.0,
    }
}

fn lines(name: &str, array: Option<&ArrayChoice>) -> Tubes {
    let path = in_repository("tests/files/vtk").join(name);
    read_lines(&path, &thickness(), array).unwrap_or_else(|fault| panic!("{fault}"))
}

/// The ends and the radii of a capsule.
pub fn numbers(capsule: Capsule) -> [f32; 9] {
    Shape::Capsule(capsule).parameters()
}

#[test]
fn lines_of_all_kinds_of_cells_are_tubes() {
    let speed = choice("speed", None);
    let (a, b) = (
        lines("lines_zlib.vtp", Some(&speed)),
        lines("lines_ascii.vtu", Some(&speed)),
    );
    // Polylines of 9, 2 and 6 points; the unstructured grid has the last one as a curve
    // with its middle behind its ends, and another polyline.
    assert_eq!((a.capsules().len(), b.capsules().len()), (14, 14));
    for (a, b) in a.capsules().zip(b.capsules()) {
        assert_eq!(numbers(a), numbers(b));
    }
    let [of_a, of_b] = [&a, &b].map(|lines| lines.scalars.as_ref().unwrap().as_flattened());
    // Text has all digits of the numbers, which 32 bits round.
    let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-7 * a.abs();
    assert!(of_a.iter().zip(of_b).all(is_near), "{of_a:?} {of_b:?}");
    let first = numbers(a.capsules().next().unwrap());
    let (x, z) = (0.7_f32.cos(), 0.7_f32.sin());
    let expected = [
        1.0,
        0.0,
        0.0,
        x,
        0.25,
        z,
        0.3,
        0.2 + 0.1 * 1.4_f32.cos(),
        0.0,
    ];
    for (found, expected) in first.into_iter().zip(expected) {
        assert!((found - expected).abs() < 3e-3, "{first:?}");
    }
    let speeds = a.scalars.unwrap()[0];
    let second = f64::from(Vec3::new(z, 0.25, 0.5).length());
    assert!((speeds[0] - 0.5).abs() < 1e-3 && (speeds[1] - second).abs() < 1e-3);
    let numbers = lines("lines_zlib.vtp", Some(&choice("number", None)));
    let of_segments = [[0.0; 2]; 8]
        .into_iter()
        .chain([[1.0; 2]])
        .chain([[2.0; 2]; 5]);
    assert_eq!(numbers.scalars.unwrap(), of_segments.collect::<Vec<_>>());
}

#[test]
fn a_table_has_lines_by_their_names() {
    let read = |text: &str| {
        reading("a.csv", text.as_bytes(), |path: &Path| {
            read_tubes(path, Some(&RadiusChoice::Same(0.5)), None)
        })
    };
    let ends = |text: &str| {
        let tubes = read(text).unwrap_or_else(|fault| panic!("{fault}"));
        let capsules = tubes.capsules().map(numbers);
        capsules
            .map(|n| [n[0], n[3], n[6], n[7]])
            .collect::<Vec<_>>()
    };
    assert_eq!(
        ends(
            "x,y,z,r,line\n0,0,0,1,a\n1,0,0,2,a\n1,0,0,9,a\n2,0,0,1,a\n5,0,0,1,b\n7,0,0,1,c\n8,0,0,1,c\n"
        ),
        [
            [0.0, 1.0, 1.0, 2.0],
            [1.0, 2.0, 2.0, 1.0],
            [7.0, 8.0, 1.0, 1.0]
        ]
    );
    assert_eq!(ends("z,y,x\n0,0,0\n0,0,1\n"), [[0.0, 1.0, 0.5, 0.5]]);
    let expected = "a first line such as `x,y,z,r,line`, or another name";
    for (text, expected) in [
        (
            "x,y,z,lin\n",
            format!(", line 1: unknown column `lin`, did you mean `line`?, expected {expected}"),
        ),
        (
            "x,y,z\n1,2,3\n",
            ": no line in the file, expected lines through at least two different points"
                .to_owned(),
        ),
        (
            "x,y,z\n1,2\n",
            ", line 2: 2 fields, expected 3, as in line 1".to_owned(),
        ),
        (
            "x,y,z,r\n1,2,3,0\n",
            ", line 2: a radius is 0, expected a number greater than 0".to_owned(),
        ),
        (
            "x,y,z,r\n1,2,inf,1\n",
            ", line 2: a coordinate is inf, expected finite numbers".to_owned(),
        ),
    ] {
        assert_eq!(message(read(text)), expected);
    }
}

/// Neither a file that ends early nor one with a wrong byte causes a panic.
#[test]
fn damaged_lines_are_refused_or_tubes() {
    for name in ["lines_zlib.vtp", "lines_ascii.vtu"] {
        let whole = std::fs::read(in_repository("tests/files/vtk").join(name)).unwrap();
        for place in 0..300 {
            let at = whole.len() * place / 300;
            let mut wrong = [whole.clone(), whole.clone(), whole.clone()];
            wrong[0].truncate(at);
            wrong[1][at] ^= 0xff;
            wrong[2][at] = b'9';
            for bytes in wrong {
                let array = choice(["speed", "number"][place % 2], None);
                let read = |path: &Path| read_lines(path, &thickness(), Some(&array));
                if let Ok(tubes) = reading(name, &bytes, read) {
                    let numbers = tubes.capsules().flat_map(numbers);
                    assert!(numbers.into_iter().all(f32::is_finite));
                    assert_eq!(
                        tubes.scalars.as_ref().unwrap().len(),
                        tubes.capsules().len()
                    );
                }
            }
        }
    }
}
