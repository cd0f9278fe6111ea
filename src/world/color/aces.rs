//! Stephen Hill's fit of ACES, from the BakingLab of Pettineo and Neubelt (2016): the reference
//! rendering transform and the output transform for sRGB displays, with the desaturation of both.

use glam::{Mat3, Vec3, vec3};

/// From sRGB to the primaries to which the curve is applied.
const INPUT: Mat3 = Mat3::from_cols(
    vec3(0.59719, 0.07600, 0.02840),
    vec3(0.35458, 0.90834, 0.13383),
    vec3(0.04823, 0.01566, 0.83777),
);

/// From these primaries back to sRGB.
const OUTPUT: Mat3 = Mat3::from_cols(
    vec3(1.60475, -0.10208, -0.00327),
    vec3(-0.53108, 1.10813, -0.07276),
    vec3(-0.07367, -0.00605, 1.07602),
);

/// Returns the light that the display shows.
pub(super) fn displayed(light: Vec3) -> Vec3 {
    // At this light the curve has reached its end, and squares are still finite.
    OUTPUT * (INPUT * light.min(Vec3::splat(1e6))).map(curve)
}

fn curve(v: f32) -> f32 {
    (v * (v + 0.024_578_6) - 0.000_090_537) / (v * (0.983_729 * v + 0.432_951) + 0.238_081)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Academy Color Encoding System 1.0: for a display of 48 cd/m2, the transforms show 18 % gray
    /// at 4.8 cd/m2, and 16.3 times white at nearly the full luminance.
    #[test]
    fn gray_and_highlights_are_where_the_academy_puts_them() {
        let shown = |light| displayed(Vec3::splat(light));
        assert!(shown(0.18).abs_diff_eq(Vec3::splat(0.1), 0.01));
        assert!(shown(16.3).abs_diff_eq(Vec3::splat(0.99), 0.01));
        assert!(shown(0.0).abs_diff_eq(Vec3::ZERO, 1e-3));
    }
}
