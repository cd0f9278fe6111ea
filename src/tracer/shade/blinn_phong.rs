//! Blinn-Phong reflection of one light.

use math::simd::{DeviceTable, Double, LookupTable, Real, Vector};
use world::light::Illumination;
use world::material::Material;

/// The two components of the reflected light, for white light of radiance 1.
pub(super) struct Reflected<R> {
    /// The diffuse component, which has the surface's color.
    pub(super) diffuse: Vector<R>,
    /// The specular highlight, which is white.
    pub(super) highlight: R,
}

/// Returns the diffuse and specular light reflected toward `to_viewer` (V) at a point of `color`
/// with normal `normal` (N), lit from L; all three are unit vectors.
///
/// Blinn, "Models of Light Reflection for Computer Synthesized Pictures", SIGGRAPH 1977: the
/// highlight depends on the angle between N and the half vector of L and V.
#[inline(always)]
pub(super) fn reflected<R: Real>(
    material: &Material,
    color: Vector<R>,
    normal: Vector<R>,
    light: &Illumination<R>,
    to_viewer: Vector<R>,
) -> Reflected<R> {
    let zero = color.x.splat(0.0);
    let cos = normal.dot(light.direction).max(zero);
    let diffuse = color * (zero.splat(material.diffuse) * cos);
    if material.specular == 0.0 {
        return Reflected {
            diffuse,
            highlight: zero,
        };
    }
    let none = Vector {
        x: zero,
        y: zero,
        z: zero,
    };
    let half_vector = (light.direction + to_viewer).normalize_or(none);
    let cos = normal.dot(half_vector).max(zero);
    Reflected {
        diffuse,
        highlight: zero.splat(material.specular) * power(cos, material.exponent),
    }
}

/// Largest exponent that is computed by squaring: its rounding errors, 2^-53 each, then stay far
/// below the 2^-24 of f32.
const MAX_SQUARED: u32 = 1 << 16;

/// Smallest highlight that is not flushed to zero: 2^-100. No picture shows less, and its products
/// with specular, radiance and path weight stay above 2^-126: arithmetic on subnormal numbers is
/// many times slower.
const MIN_HIGHLIGHT: f64 = 1.0 / (1_u128 << 100) as f64;

/// Returns `base`, at least 0, to the power of `exponent`, at least 0, computed in double
/// precision; 0 if the result is below [`MIN_HIGHLIGHT`]. All machines return the same bits, and no
/// intermediate result is subnormal.
#[inline(always)]
fn power<R: Real>(base: R, exponent: f32) -> R {
    let whole = exponent as u32;
    if whole as f32 == exponent && whole <= MAX_SQUARED {
        let power = whole_power(base.to_double(), whole);
        return R::from_double(power.zero_below(MIN_HIGHLIGHT));
    }
    let [power] = R::look_up(&Power(exponent), [base]);
    power
}

/// The powers with an exponent.
struct Power(f32);

/// Returns the power of a base.
impl LookupTable<1, 1> for Power {
    #[inline]
    fn values_at(&self, [base]: [f32; 1]) -> [f32; 1] {
        let power = libm::pow(base.into(), self.0.into());
        [power.zero_below(MIN_HIGHLIGHT) as f32]
    }

    /// The exponent, then the limit in two halves.
    fn on_device(&self) -> Result<DeviceTable, &'static str> {
        let limit = MIN_HIGHLIGHT.to_bits();
        if self.0 > MAX_EXPONENT {
            return Err("an exponent above 2^31");
        }
        Ok(DeviceTable {
            function: "power_of_base",
            words: vec![self.0.to_bits(), limit as u32, (limit >> 32) as u32],
        })
    }
}

/// Largest exponent of the powers of devices: libm computes greater ones otherwise.
const MAX_EXPONENT: f32 = (1_u32 << 31) as f32;

/// Computes the power by repeated squaring, in a fraction of the time of `pow`; may return 0 if the
/// result is below [`MIN_HIGHLIGHT`].
#[inline(always)]
fn whole_power<D: Double>(base: D, mut exponent: u32) -> D {
    let (mut power, mut square) = (base.splat(1.0), base);
    while exponent > 0 {
        // The result is at most this square: if the base is below 1, `power` is at most 1;
        // otherwise no square is small.
        square = square.zero_below(MIN_HIGHLIGHT);
        if exponent % 2 == 1 {
            power = power * square;
        }
        square = square * square;
        exponent /= 2;
    }
    power
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Returns the reference: libm's power in single precision, which may be subnormal.
    fn expected(base: f32, exponent: f32) -> f32 {
        let power = libm::powf(base, exponent);
        if f64::from(power) < MIN_HIGHLIGHT {
            return 0.0;
        }
        power
    }

    proptest! {
            #[test]
    fn squaring_agrees_with_libm(base in 0.0_f32..1.0, exponent in 0_u32..=MAX_SQUARED) {
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
    fn special_powers_agree_with_libm() {
        for base in [0.0, 1.0, 1.0_f32.next_up(), 1e-30] {
            for exponent in [0.0, 1.0, 0.5, 7.25, 65_536.0, 65_537.0, 1e15] {
                let [found, expected] =
                    [power(base, exponent), expected(base, exponent)].map(f32::to_bits);
                assert!(found.abs_diff(expected) <= 1, "{base} to {exponent}");
            }
        }
    }

    /// On `seed_sphere` N.H^50 was subnormal on a crescent, whose pixels cost 40 % more.
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
