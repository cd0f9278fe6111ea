//! AgX by Troy Sobotka (2022), in the Rec. 2020 form used by Blender, Filament and three.js: the
//! inset matrix moves saturated colors toward gray, so that they fade to white where they are
//! bright; the curve is a sigmoid over the logarithm of the light; and the outset matrix restores
//! part of the saturation.

use glam::{Mat3, Vec3, vec3};

/// Linear sRGB to linear Rec. 2020 (ITU-R BT.2407).
const REC2020: Mat3 = Mat3::from_cols(
    vec3(0.6274, 0.0691, 0.0164),
    vec3(0.3293, 0.9195, 0.0880),
    vec3(0.0433, 0.0113, 0.8956),
);

/// Linear Rec. 2020 to linear sRGB.
const SRGB: Mat3 = Mat3::from_cols(
    vec3(1.6605, -0.1246, -0.0182),
    vec3(-0.5876, 1.1329, -0.1006),
    vec3(-0.0728, -0.0083, 1.1187),
);

const INSET: Mat3 = Mat3::from_cols(
    vec3(0.856_627_15, 0.137_318_97, 0.111_898_21),
    vec3(0.095_121_24, 0.761_242, 0.076_799_42),
    vec3(0.048_251_606, 0.101_439_04, 0.811_302_4),
);

const OUTSET: Mat3 = Mat3::from_cols(
    vec3(1.127_100_6, -0.141_329_76, -0.141_329_76),
    vec3(-0.110_606_64, 1.157_823_7, -0.110_606_64),
    vec3(-0.016_493_94, -0.016_493_94, 1.251_936_4),
);

/// The binary logarithms of the darkest and the brightest light of the curve: 10 stops below middle
/// gray, 0.18, and 6.5 above.
const EXPONENTS: [f32; 2] = [-12.473_931, 4.026_069];

/// The position where the sigmoid has the value 0.5 and the slope 2: middle gray.
const PIVOT: f32 = 10.0 / 16.5;

/// Returns the light that the display shows.
pub(super) fn displayed(light: Vec3) -> Vec3 {
    let [least, most] = EXPONENTS;
    let position = |light: f32| {
        let exponent = libm::log2f(light.max(1e-10));
        ((exponent - least) / (most - least)).clamp(0.0, 1.0)
    };
    let curved = (INSET * (REC2020 * light)).map(|light| sigmoid(position(light)));
    // The curve's output is encoded for a display with a gamma of 2.2.
    SRGB * (OUTSET * curved).map(|number| libm::powf(number.max(0.0), 2.2))
}

/// Maps 0..1 to 0..1. The toe's power is 3, the shoulder's 3.25; the factors make the curve end at
/// 0 and at 1.
fn sigmoid(x: f32) -> f32 {
    let offset = x - PIVOT;
    let (factor, power) = if offset < 0.0 {
        (59.507_875, 3.0)
    } else {
        (69.862_79, 3.25)
    };
    let bend = 1.0 + factor * libm::powf(offset.abs(), power);
    0.5 + 2.0 * offset * libm::powf(bend, -1.0 / power)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The polynomial fit of Wrensch, "Minimal AgX Implementation", 2023.
    fn polynomial(x: f32) -> f32 {
        let terms = [-0.002_32, 0.1191, 0.4298, -6.868, 31.96, -40.14, 15.5];
        terms.iter().rev().fold(0.0, |sum, term| sum * x + term)
    }

    #[test]
    fn the_sigmoid_is_that_of_the_published_fit() {
        let mut squares = 0.0;
        for i in 0..=1000 {
            let x = i as f32 / 1000.0;
            squares += (sigmoid(x) - polynomial(x)).powi(2) / 1001.0;
        }
        assert!(squares < 1e-5, "{squares}");
        assert!(sigmoid(0.0).abs() < 1e-6 && (sigmoid(1.0) - 1.0).abs() < 1e-6);
        assert!((sigmoid(PIVOT) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn matrices_are_inverse_and_keep_gray() {
        for matrix in [REC2020, SRGB, INSET, OUTSET] {
            assert!((matrix * Vec3::ONE).abs_diff_eq(Vec3::ONE, 2e-4));
        }
        assert!((REC2020 * SRGB).abs_diff_eq(Mat3::IDENTITY, 3e-4));
    }

    #[test]
    fn bright_colors_fade_to_white() {
        let saturation = |light: Vec3| 1.0 - light.min_element() / light.max_element();
        let blue = vec3(0.1, 0.1, 1.0);
        let [dim, bright] = [0.1, 50.0].map(|light| saturation(displayed(light * blue)));
        assert!(bright < 0.4 * dim, "{bright} and {dim}");
    }
}
