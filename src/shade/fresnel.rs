//! Light at the smooth surface between two clear media.

use crate::simd::{Real, Vector};
use crate::trace::ShadingPoint;

/// The split of a ray at a smooth surface.
pub(super) struct Split<R> {
    /// The fraction of the light that is reflected, 0 to 1; the rest is refracted.
    pub(super) reflectance: R,
    /// The direction of the refracted ray, a unit vector, where there is one.
    pub(super) refracted: Vector<R>,
}

/// Splits a ray in `direction` at a point; where the surface is not visible, the ray goes
/// straight on. By the shading normal, unless the ray comes from behind it; a ray that it
/// would refract away from the surface is reflected.
#[inline(always)]
pub(super) fn split_at<R: Real>(
    point: &ShadingPoint<R>,
    direction: Vector<R>,
    eta: R,
    is_visible: R::Mask,
) -> Split<R> {
    let (zero, one) = (eta.splat(0.0), eta.splat(1.0));
    let is_faced = direction.dot(point.normal).lt(zero);
    let normal = Vector::select(is_faced, point.normal, point.geometric_normal);
    let Split {
        reflectance,
        refracted,
    } = split(direction, normal, eta);
    let enters = refracted.dot(point.geometric_normal).lt(zero);
    let reflectance = R::select(enters, reflectance, one);
    Split {
        reflectance: R::select(is_visible, reflectance, zero),
        refracted: Vector::select(is_visible, refracted, direction),
    }
}

/// Splits a ray in `direction` at a surface with this normal on its side; both are unit
/// vectors. `eta` is the index of refraction before the surface over that behind it.
///
/// The reflectance is that of unpolarized light by Fresnel's equations, 1 beyond the
/// critical angle; the refracted direction is that of Snell's law: Pharr, Jakob and
/// Humphreys, "Physically Based Rendering", 4th edition, section 9.3.
#[inline(always)]
fn split<R: Real>(direction: Vector<R>, normal: Vector<R>, eta: R) -> Split<R> {
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

    /// The split of a ray at this angle of incidence, in the plane of x and y.
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
    fn special_angles_are_those_of_the_textbooks() {
        let straight = split_of(0.0, 1.0 / 1.5);
        assert!((straight.reflectance - 0.04).abs() < 1e-7);
        // At Brewster's angle only light that is polarized perpendicularly is reflected.
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
