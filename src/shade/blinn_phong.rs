//! The light that a surface sends on from one light source.

use glam::Vec3;

use crate::light::Illumination;
use crate::material::Material;

/// The two parts of the light that a surface reflects, for white light of
/// strength 1.
pub(super) struct Reflected {
    /// The diffuse part, which has the surface's color.
    pub(super) diffuse: Vec3,
    /// The highlight, which has none.
    pub(super) highlight: f32,
}

/// Diffuse and specular light toward `to_viewer` (V) at a point of `color`
/// with unit normal `normal` (N), lit along L; all three unit vectors.
///
/// Blinn, "Models of Light Reflection for Computer Synthesized Pictures",
/// SIGGRAPH 1977: the highlight goes by the angle of N and the half vector of
/// L and V.
pub(super) fn reflected(
    material: &Material,
    color: Vec3,
    normal: Vec3,
    light: &Illumination,
    to_viewer: Vec3,
) -> Reflected {
    let diffuse = material.diffuse * normal.dot(light.direction).max(0.0) * color;
    if material.specular == 0.0 {
        return Reflected {
            diffuse,
            highlight: 0.0,
        };
    }
    let half_vector = (light.direction + to_viewer).normalize_or_zero();
    let cos = normal.dot(half_vector).max(0.0);
    Reflected {
        diffuse,
        highlight: material.specular * power(cos, material.exponent),
    }
}

/// Up to this exponent the roundings of squaring, 2^-53 each, stay far below
/// an f32's, 2^-24.
const MAX_SQUARED: u32 = 1 << 16;

/// `base`, at least 0, to the power of `exponent`, at least 0: the same bits on
/// every machine.
fn power(base: f32, exponent: f32) -> f32 {
    let mut rest = exponent as u32;
    if rest as f32 != exponent || rest > MAX_SQUARED {
        return libm::powf(base, exponent);
    }
    // Whole exponents, which people write, take a fraction of the time by
    // repeated squaring.
    let (mut power, mut square) = (1.0, f64::from(base));
    while rest > 0 {
        if rest % 2 == 1 {
            power *= square;
        }
        square *= square;
        rest /= 2;
    }
    power as f32
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn squaring_is_libms_power(base in 0.0_f32..1.0, exponent in 0_u32..=MAX_SQUARED) {
            let found = power(base, exponent as f32);
            let expected = libm::powf(base, exponent as f32);
            let ulps = found.to_bits().abs_diff(expected.to_bits());
            prop_assert!(ulps <= 1, "{found} instead of {expected}");
        }
    }

    #[test]
    fn awkward_powers_are_libms() {
        for base in [0.0, 1.0, 1.0_f32.next_up(), 1e-30] {
            for exponent in [0.0, 1.0, 0.5, 7.25, 65_536.0, 65_537.0, 1e15] {
                let [found, expected] =
                    [power(base, exponent), libm::powf(base, exponent)].map(f32::to_bits);
                assert!(found.abs_diff(expected) <= 1, "{base} to {exponent}");
            }
        }
    }
}
