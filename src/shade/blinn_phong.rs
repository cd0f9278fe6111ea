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

/// The least highlight that is not taken as zero: 2^-100. No picture shows less,
/// and its products with specular, radiance and weight of the path stay above
/// the subnormals, 2^-126, which cost a processor many times as much.
const LEAST_HIGHLIGHT: f64 = 1.0 / (1_u128 << 100) as f64;

/// `base`, at least 0, to the power of `exponent`, at least 0, computed in double
/// precision; 0 where that is below [`LEAST_HIGHLIGHT`]. The same bits on every
/// machine, and never a subnormal on the way.
fn power(base: f32, exponent: f32) -> f32 {
    let base = f64::from(base);
    let whole = exponent as u32;
    let power = if whole as f32 == exponent && whole <= MAX_SQUARED {
        whole_power(base, whole)
    } else {
        libm::pow(base, f64::from(exponent))
    };
    if power < LEAST_HIGHLIGHT {
        return 0.0;
    }
    power as f32
}

/// The power by repeated squaring, which takes a fraction of the time; about 0
/// where it is below [`LEAST_HIGHLIGHT`].
fn whole_power(base: f64, mut exponent: u32) -> f64 {
    let (mut power, mut square) = (1.0, base);
    while exponent > 0 {
        // The power is at most this square: `power` is at most 1 where the base
        // is below 1, and elsewhere nothing is small.
        if square < LEAST_HIGHLIGHT {
            return 0.0;
        }
        if exponent % 2 == 1 {
            power *= square;
        }
        square *= square;
        exponent /= 2;
    }
    power
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The slow twin: libm's power in single precision, which may be subnormal.
    fn expected(base: f32, exponent: f32) -> f32 {
        let power = libm::powf(base, exponent);
        if f64::from(power) < LEAST_HIGHLIGHT {
            return 0.0;
        }
        power
    }

    proptest! {
        #[test]
        fn squaring_is_libms_power(base in 0.0_f32..1.0, exponent in 0_u32..=MAX_SQUARED) {
            let exponent = exponent as f32;
            let [found, expected] = [power(base, exponent), expected(base, exponent)];
            let ulps = found.to_bits().abs_diff(expected.to_bits());
            prop_assert!(ulps <= 1, "{found} instead of {expected}");
        }

        #[test]
        fn no_highlight_is_subnormal(
            bits in -150.0_f64..0.0,
            exponent in prop_oneof![(1_u32..=MAX_SQUARED).prop_map(|n| n as f32), 0.1_f32..1e6],
        ) {
            // A base whose power has about this many bits below 1.
            let base = libm::exp2(bits / f64::from(exponent)) as f32;
            let found = power(base, exponent);
            let is_zero_or_far_from_subnormal =
                found == 0.0 || found >= 2.0_f32.powi(-100);
            prop_assert!(is_zero_or_far_from_subnormal, "{base} to {exponent} is {found}");
            if bits < -101.0 {
                prop_assert_eq!(found, 0.0);
            }
            if bits > -99.0 {
                prop_assert!(found > 0.0);
            }
        }
    }

    #[test]
    fn awkward_powers_are_libms() {
        for base in [0.0, 1.0, 1.0_f32.next_up(), 1e-30] {
            for exponent in [0.0, 1.0, 0.5, 7.25, 65_536.0, 65_537.0, 1e15] {
                let [found, expected] =
                    [power(base, exponent), expected(base, exponent)].map(f32::to_bits);
                assert!(found.abs_diff(expected) <= 1, "{base} to {exponent}");
            }
        }
    }

    /// On `seed_sphere` N.H^50 was subnormal on a crescent, whose pixels cost
    /// 40 % more.
    #[test]
    fn an_underflowing_highlight_is_none() {
        for n_dot_h in [0.13_f32, 0.15, 0.17, 0.2, 0.24] {
            for exponent in [50.0, 50.5] {
                assert_eq!(power(n_dot_h, exponent), 0.0, "{n_dot_h} to {exponent}");
            }
        }
        assert!(power(0.26, 50.0) > 0.0);
    }
}
