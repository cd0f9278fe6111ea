//! `image.png` is the light of the pixels, exposed and encoded.

use std::fs;

use image::DynamicImage;
use output::results::Results;

use crate::common::{assert_success, in_repository, raycost};

/// The function of IEC 61966-2-1, in double precision.
fn srgb(light: f64) -> f64 {
    let light = light.clamp(0.0, 1.0);
    if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * light.powf(1.0 / 2.4) - 0.055
    }
}

#[test]
fn both_depths_are_the_nearest_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let scene = fs::read_to_string(in_repository("configs/textures.yaml")).unwrap();
    for bits in [8, 16] {
        let film = format!("film: {{ exposure: 0.5, bits: {bits} }}\n");
        let path = folder.path().join("scene.yaml");
        fs::write(&path, scene.clone() + &film).unwrap();
        let out = folder.path().join("out");
        let mut command = raycost();
        command.arg("render").arg(path).arg("--out").arg(&out);
        command.args(["--width=61", "--height=43", "--also=radiance", "--quiet"]);
        assert_success(&command.output().unwrap());
        let most = 2_f64.powi(bits) - 1.0;
        let numbers: Vec<f64> = match image::open(out.join("image.png")).unwrap() {
            DynamicImage::ImageRgb8(picture) if bits == 8 => {
                picture.iter().map(|&number| number.into()).collect()
            }
            DynamicImage::ImageRgb16(picture) if bits == 16 => {
                picture.iter().map(|&number| number.into()).collect()
            }
            other => panic!("{:?}", other.color()),
        };
        let frame = Results::open(&out).unwrap().frame().unwrap();
        let radiance = frame.read("radiance").unwrap();
        assert_eq!(numbers.len(), radiance.values.len());
        for (number, light) in numbers.into_iter().zip(radiance.values.iter()) {
            let exact = most * srgb(light * 0.5_f64.exp2());
            // The gain is a number of 32 bits.
            assert!(
                (number - exact).abs() < 0.51,
                "{light}: {number}, not {exact}"
            );
        }
    }
}

#[test]
fn the_command_line_overrides_the_film() {
    let folder = tempfile::tempdir().unwrap();
    let scene = fs::read_to_string(in_repository("configs/blocks.yaml")).unwrap();
    let picture = |film: &str, flags: &[&str]| {
        let path = folder.path().join("scene.yaml");
        fs::write(&path, format!("{scene}film: {{ {film} }}\n")).unwrap();
        let out = folder.path().join("out");
        let mut command = raycost();
        command.arg("render").arg(path).arg("--out").arg(&out);
        command.args(["--width=40", "--height=30", "--cost=none", "--quiet"]);
        assert_success(&command.args(flags).output().unwrap());
        image::open(out.join("image.png")).unwrap()
    };
    let by_file = picture("exposure: -1.5, tone_curve: agx", &[]);
    let flags = ["--exposure", "-1.5", "--tone-curve", "agx"];
    assert_eq!(picture("exposure: 3, tone_curve: aces", &flags), by_file);
    assert_ne!(picture("exposure: -1.5", &[]), by_file);
    assert_ne!(picture("tone_curve: agx", &[]), by_file);
}
