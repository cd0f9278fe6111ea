//! Fresnel's equations.

use glam::Vec3;

use crate::simd::{Real, Vector};

/// Returns the reflectance of a metal in vacuum at this cosine of the angle of incidence, from 0 to
/// 1; `index` and `extinction` are the real and imaginary part of the complex index of refraction
/// in each channel.
#[inline(always)]
pub fn reflectance_of_metal<R: Real>(index: Vec3, extinction: Vec3, cos: R) -> Vector<R> {
    Vector {
        x: reflectance(cos, index.x, extinction.x),
        y: reflectance(cos, index.y, extinction.y),
        z: reflectance(cos, index.z, extinction.z),
    }
}

/// Returns the reflectance of a metal in vacuum for unpolarized light at this cosine of the angle
/// of incidence.
///
/// Fresnel's equations with a complex index: Born and Wolf, "Principles of Optics", 14.2, in the
/// form of Lagarde, "Memo on Fresnel Equations", 2013.
#[inline(always)]
fn reflectance<R: Real>(cos: R, index: f32, extinction: f32) -> R {
    let (zero, half) = (cos.splat(0.0), cos.splat(0.5));
    let (index2, extinction2) = (index * index, extinction * extinction);
    let cos2 = cos * cos;
    let sin2 = cos.splat(1.0) - cos2;
    let difference = cos.splat(index2 - extinction2) - sin2;
    let length = (difference * difference + cos.splat(4.0 * index2 * extinction2)).sqrt();
    let root = (half * (length + difference)).max(zero).sqrt();
    let (sum, twice) = (length + cos2, cos.splat(2.0) * root * cos);
    let perpendicular = ratio(sum - twice, sum + twice);
    let (sum, twice) = (cos2 * length + sin2 * sin2, twice * sin2);
    let parallel = ratio(perpendicular * (sum - twice), sum + twice);
    half * (perpendicular + parallel)
}

/// Returns a ratio of at most 1, and 1 for two zeros: a medium like vacuum at grazing incidence, or
/// one without index and extinction at normal incidence.
#[inline(always)]
fn ratio<R: Real>(part: R, whole: R) -> R {
    let least = whole.splat(f32::MIN_POSITIVE);
    part.max(least) / whole.max(least)
}

/// The split of a ray at a smooth surface.
#[derive(Debug, Clone, Copy)]
pub struct Split<R> {
    /// The fraction of the light that is reflected, 0 to 1; the rest is refracted.
    pub reflectance: R,
    /// The direction of the refracted ray, a unit vector; without meaning if there is none.
    pub refracted: Vector<R>,
}

/// Splits a ray in `direction` at a surface with this normal on its side; both are unit vectors.
/// `eta` is the ratio of the indices of refraction before and past the surface.
///
/// The reflectance follows Fresnel's equations for unpolarized light, 1 beyond the critical angle;
/// the refracted direction follows Snell's law: Pharr, Jakob and Humphreys, "Physically Based
/// Rendering", 4th edition, section 9.3.
#[inline(always)]
pub fn split<R: Real>(direction: Vector<R>, normal: Vector<R>, eta: R) -> Split<R> {
    let (zero, one) = (eta.splat(0.0), eta.splat(1.0));
    let cos = (-direction.dot(normal)).max(zero).min(one);
    let sin2_behind = eta * eta * (one - cos * cos);
    let is_total = one.le(sin2_behind);
    let cos_behind = (one - sin2_behind).max(zero).sqrt();
    let parallel = (cos - eta * cos_behind) / (cos + eta * cos_behind);
    let perpendicular = (eta * cos - cos_behind) / (eta * cos + cos_behind);
    let mean = (parallel * parallel + perpendicular * perpendicular) * eta.splat(0.5);
    let refracted = direction * eta + normal * (eta * cos - cos_behind);
    Split {
        reflectance: R::select(is_total, one, mean),
        refracted: Vector::select(is_total, direction, refracted.normalize()),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// Splits a ray at this angle of incidence, in the xy plane.
    fn split_of(angle: f64, eta: f32) -> Split<f32> {
        let direction = Vec3::new(angle.sin() as f32, -angle.cos() as f32, 0.0);
        split(direction.into(), Vec3::Y.into(), eta)
    }

    #[test]
    fn angles_are_snells_and_reflectances_fresnels() {
        for eta in [1.0 / 1.5, 1.0 / 1.33, 1.0 / 2.42, 1.33 / 1.5, 1.5, 2.42] {
            for i in 1..=20 {
                let angle = f64::from(i) * 89.0_f64.to_radians() / 20.0;
                let Split {
                    reflectance,
                    refracted,
                } = split_of(angle, eta);
                let sin_behind = f64::from(eta) * angle.sin();
                if sin_behind >= 1.0 {
                    assert_eq!(reflectance, 1.0, "beyond the critical angle");
                    continue;
                }
                // In terms of angles: Born and Wolf, "Principles of Optics", 1.5.2.
                let behind = sin_behind.asin();
                let (sum, difference) = (angle + behind, angle - behind);
                let perpendicular = (difference.sin() / sum.sin()).powi(2);
                let parallel = (difference.tan() / sum.tan()).powi(2);
                let expected = 0.5 * (perpendicular + parallel);
                assert!((f64::from(reflectance) - expected).abs() < 1e-5);
                let found = f64::from(refracted.x).atan2(-f64::from(refracted.y));
                assert!((found - behind).abs() < 1e-5, "{found} {behind}");
            }
        }
    }

    #[test]
    fn metals_reflect_what_complex_amplitudes_say() {
        // The amplitudes by complex arithmetic: (real, imaginary).
        type Complex = (f64, f64);
        let times = |a: Complex, b: Complex| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
        let minus = |a: Complex, b: Complex| (a.0 - b.0, a.1 - b.1);
        let plus = |a: Complex, b: Complex| (a.0 + b.0, a.1 + b.1);
        let root = |a: Complex| {
            let length = a.0.hypot(a.1);
            (
                ((length + a.0) / 2.0).sqrt(),
                ((length - a.0) / 2.0).sqrt().copysign(a.1),
            )
        };
        let power = |a: Complex| a.0 * a.0 + a.1 * a.1;
        for (n, k) in [
            (0.143, 3.983),
            (1.442, 1.603),
            (0.2, 3.9),
            (1.5, 0.0),
            (2.0, 7.5),
            (0.0, 1.0),
        ] {
            for i in 0..20 {
                let cos = f64::from(89 * i / 19).to_radians().cos();
                let index2 = times((n, k), (n, k));
                let behind = root(minus(index2, (1.0 - cos * cos, 0.0)));
                let before = (cos, 0.0);
                let perpendicular = power(minus(before, behind)) / power(plus(before, behind));
                let bent = times(index2, before);
                let parallel = power(minus(bent, behind)) / power(plus(bent, behind));
                let expected = 0.5 * (perpendicular + parallel);
                let found = f64::from(reflectance(cos as f32, n as f32, k as f32));
                assert!(
                    (found - expected).abs() < 2e-5,
                    "{n} {k} {cos}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn metals_at_the_ends_of_their_ranges_reflect_a_fraction() {
        let ends = [0.0, f32::MIN_POSITIVE, 1e-9, 1e-3, 1.0, 1000.0];
        for (n, k) in ends.into_iter().flat_map(|n| ends.map(|k| (n, k))) {
            for cos in [0.0, f32::MIN_POSITIVE, 1e-9, 1e-3, 0.5, 1.0 - 6e-8, 1.0] {
                let found = reflectance(cos, n, k);
                assert!(
                    (0.0..=1.0 + 1e-6).contains(&found),
                    "{n} {k} {cos}: {found}"
                );
            }
        }
        assert_eq!(reflectance(1.0, 0.0, 0.0), 1.0);
    }

    #[test]
    fn special_angles_are_those_of_the_textbooks() {
        let straight = split_of(0.0, 1.0 / 1.5);
        assert!((straight.reflectance - 0.04).abs() < 1e-7);
        // At Brewster's angle only light polarized perpendicularly is reflected.
        let brewster = split_of(1.5_f64.atan(), 1.0 / 1.5);
        assert!((brewster.reflectance - 0.5 * (5.0_f32 / 13.0).powi(2)).abs() < 1e-6);
        let same_medium = split_of(0.7, 1.0);
        assert!(same_medium.reflectance < 1e-12);
        assert!(
            (Vec3::from(same_medium.refracted) - Vec3::new(0.644_217_7, -0.764_842_2, 0.0))
                .length()
                < 1e-6
        );
        assert_eq!(
            split_of(std::f64::consts::FRAC_PI_2, 1.0 / 1.5).reflectance,
            1.0
        );
    }
}
