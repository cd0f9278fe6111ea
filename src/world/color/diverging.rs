//! The diverging color map of ParaView, Cool to Warm (Moreland, "Diverging Color Maps for
//! Scientific Visualization", ISVC 2009).
//!
//! Colors are interpolated in Msh, the polar form of CIELAB: magnitude, saturation and hue.

use super::srgb::{decoded, encoded};

/// Colors in Msh.
type Msh = [f64; 3];

/// The colors at the ends, as sRGB in 255ths.
const COOL: [f64; 3] = [59.0, 76.0, 192.0];
const WARM: [f64; 3] = [180.0, 4.0, 38.0];
/// The magnitude of the gray in the middle.
const GRAY: f64 = 88.0;
/// CIE XYZ of the white of sRGB.
const WHITE: [f64; 3] = [0.9505, 1.0, 1.089];

/// Returns the color at a position from 0 to 1, as sRGB.
pub(super) fn cool_to_warm(position: f64) -> [f64; 3] {
    let end = from_srgb((if position < 0.5 { COOL } else { WARM }).map(|x| x / 255.0));
    let gray = [GRAY, 0.0, hue_beside(end)];
    let share = (2.0 * position - 1.0).abs().min(1.0);
    to_srgb([0, 1, 2].map(|i| gray[i] + share * (end[i] - gray[i])))
}

/// Returns the hue of the gray next to a color, with which the interpolated lightness and
/// saturation change evenly.
fn hue_beside([magnitude, saturation, hue]: Msh) -> f64 {
    if magnitude >= GRAY {
        return hue;
    }
    let root = (GRAY * GRAY - magnitude * magnitude).sqrt();
    let spin = saturation * root / (magnitude * libm::sin(saturation));
    // Away from purple.
    if hue > -0.3 * std::f64::consts::PI {
        hue + spin
    } else {
        hue - spin
    }
}

fn from_srgb(color: [f64; 3]) -> Msh {
    let [r, g, b] = color.map(decoded);
    let xyz = [
        0.4124 * r + 0.3576 * g + 0.1805 * b,
        0.2126 * r + 0.7152 * g + 0.0722 * b,
        0.0193 * r + 0.1192 * g + 0.9505 * b,
    ];
    let [x, y, z] = [0, 1, 2].map(|i| compressed(xyz[i] / WHITE[i]));
    let [lightness, a, b] = [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)];
    let magnitude = (lightness * lightness + a * a + b * b).sqrt();
    [
        magnitude,
        libm::acos(lightness / magnitude),
        libm::atan2(b, a),
    ]
}

fn to_srgb([magnitude, saturation, hue]: Msh) -> [f64; 3] {
    let chroma = magnitude * libm::sin(saturation);
    let y = (magnitude * libm::cos(saturation) + 16.0) / 116.0;
    let x = y + chroma * libm::cos(hue) / 500.0;
    let z = y - chroma * libm::sin(hue) / 200.0;
    let [x, y, z] = [x, y, z].map(expanded);
    let [x, y, z] = [x * WHITE[0], y * WHITE[1], z * WHITE[2]];
    let linear = [
        3.2406 * x - 1.5372 * y - 0.4986 * z,
        -0.9689 * x + 1.8758 * y + 0.0415 * z,
        0.0557 * x - 0.2040 * y + 1.0570 * z,
    ];
    linear.map(|light| encoded(light.clamp(0.0, 1.0)))
}

/// Returns CIELAB's cube root, which is linear near 0.
fn compressed(share: f64) -> f64 {
    if share > 0.008_856 {
        libm::cbrt(share)
    } else {
        7.787 * share + 16.0 / 116.0
    }
}

/// Inverts [`compressed`].
fn expanded(root: f64) -> f64 {
    if root > 0.206_893 {
        root * root * root
    } else {
        (root - 16.0 / 116.0) / 7.787
    }
}
