//! A sphere of fog that attenuates and scatters light.

use glam::Vec3;

use super::HenyeyGreenstein;
use math::simd::{DeviceTable, LookupTable, Real, Vector};

/// A sphere filled with fog.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FogSphere {
    /// The center in render space.
    pub center: Vec3,
    /// The radius in world units; may be infinite.
    pub radius: f32,
    /// The extinction coefficient: the reciprocal of the mean free path, per world unit.
    pub extinction: f32,
    /// See [`Fog::color`](super::Fog::color).
    pub color: Vec3,
    /// The phase function of the particles.
    pub phase: HenyeyGreenstein,
}

impl FogSphere {
    /// Returns the fraction of light that reaches a point through the fog from a direction, a unit
    /// vector, and a distance, possibly infinite.
    #[inline(always)]
    pub fn transmittance<R: Real>(&self, [point, direction]: [Vector<R>; 2], distance: R) -> R {
        let [start, end] = self.extent([point, direction], distance);
        let [transmittance] = R::look_up(self, [(end - start).max(start.splat(0.0))]);
        transmittance
    }

    /// Attenuates light along a ray up to its hit, without scattering: returns the fraction that is
    /// left, and the light that the fog adds.
    pub fn fade<R: Real>(&self, ray: [Vector<R>; 2], distance: R) -> (R, Vector<R>) {
        let transmittance = self.transmittance(ray, distance);
        let added = distance.splat(1.0) - transmittance;
        (transmittance, Vector::splat(added, self.color) * added)
    }

    /// Samples the distance along a ray, with an origin and a direction, at which it meets a
    /// particle, with a number in [0, 1). Returns true if that is before its hit, and the distance.
    #[inline(always)]
    pub fn flight<R: Real>(&self, ray: [Vector<R>; 2], hit: R, number: R) -> (R::Mask, R) {
        let [start, end] = self.extent(ray, hit);
        let [length] = R::look_up(&FreeFlight(self.extinction), [number]);
        let t = start + length;
        // Also past the origin, or the path would not advance.
        (t.lt(end) & t.splat(0.0).lt(t), t)
    }

    /// Returns the first and the last distance along a ray, up to the given one, that lie in the
    /// sphere; the last is less than the first if there are none.
    #[inline(always)]
    fn extent<R: Real>(&self, [origin, direction]: [Vector<R>; 2], distance: R) -> [R; 2] {
        let zero = distance.splat(0.0);
        if self.radius == f32::INFINITY {
            return [zero, distance];
        }
        let to_center = Vector::splat(distance, self.center) - origin;
        let nearest = to_center.dot(direction);
        // Not the difference of the squares of distance and radius, which would cancel.
        let across = to_center - direction * nearest;
        let square = zero.splat(self.radius * self.radius) - across.dot(across);
        let half = square.max(zero).sqrt();
        let is_missed = square.lt(zero);
        [
            (nearest - half).max(zero),
            R::select(is_missed, -half, (nearest + half).min(distance)),
        ]
    }
}

/// Returns the transmittance of a length.
impl LookupTable<1, 1> for FogSphere {
    #[inline]
    fn values_at(&self, [length]: [f32; 1]) -> [f32; 1] {
        [libm::expf(-self.extinction * length)]
    }

    fn on_device(&self) -> Result<DeviceTable, &'static str> {
        Ok(DeviceTable {
            function: "fog_transmittance",
            words: vec![self.extinction.to_bits()],
        })
    }
}

/// The lengths of flights between particles, for an extinction coefficient.
struct FreeFlight(f32);

/// Returns the length for a number in [0, 1).
impl LookupTable<1, 1> for FreeFlight {
    #[inline]
    fn values_at(&self, [number]: [f32; 1]) -> [f32; 1] {
        [-libm::log1pf(-number) / self.0]
    }

    fn on_device(&self) -> Result<DeviceTable, &'static str> {
        Ok(DeviceTable {
            function: "free_flight",
            words: vec![self.0.to_bits()],
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::Ray;

    fn fog(radius: f32) -> FogSphere {
        FogSphere {
            center: Vec3::new(1.0, 2.0, 3.0),
            radius,
            extinction: 0.25,
            color: Vec3::ONE,
            phase: HenyeyGreenstein { anisotropy: 0.0 },
        }
    }

    proptest! {
        #[test]
        fn light_is_weakened_by_the_fog_that_it_crosses(
            origin in prop::array::uniform3(-6.0_f32..6.0),
            to in prop::array::uniform3(-1.0_f32..1.0),
            distance in prop_oneof![0.0_f32..20.0, Just(f32::INFINITY)],
            radius in prop_oneof![0.5_f32..8.0, Just(1e4), Just(1e25), Just(f32::INFINITY)],
        ) {
            let (fog, origin) = (fog(radius), Vec3::from(origin));
            let direction = Vec3::from(to).normalize_or(Vec3::X);
            // The reference: small steps along the ray.
            let is_inside = |t: f32| (origin + t * direction).distance(fog.center) < radius;
            let steps = (0..40_000_u16).map(|i| 1e-3 * (f32::from(i) + 0.5));
            let n_inside = steps.take_while(|t| *t < distance).filter(|t| is_inside(*t)).count();
            let expected = (-0.25e-3 * n_inside as f32).exp();
            let ray = [origin, direction].map(Vector::from);
            let found = fog.transmittance(ray, distance);
            prop_assert!((found - expected).abs() < 1e-3, "{} {}", found, expected);
        }

        #[test]
        fn as_many_rays_meet_a_particle_as_light_is_lost(
            origin in prop::array::uniform3(-6.0_f32..6.0),
            to in prop::array::uniform3(-1.0_f32..1.0),
            hit in prop_oneof![0.1_f32..20.0, Just(f32::INFINITY)],
            radius in prop_oneof![0.5_f32..8.0, Just(f32::INFINITY)],
        ) {
            let fog = fog(radius);
            let ray = Ray {
                origin: origin.into(),
                direction: Vec3::from(to).normalize_or(Vec3::X),
            };
            let n = 2000_u16;
            let flights = (0..n).filter_map(|i| {
                let vectors = [ray.origin, ray.direction].map(Vector::from);
                let number = (f32::from(i) + 0.5) / f32::from(n);
                let (is_met, t) = fog.flight(vectors, hit, number);
                is_met.then_some(t)
            });
            let (mut n_met, center) = (0, fog.center);
            for t in flights {
                prop_assert!(t > 0.0 && t < hit);
                prop_assert!(ray.at(t).distance(center) < radius + 1e-4);
                n_met += 1;
            }
            let passed = 1.0 - n_met as f32 / f32::from(n);
            let expected = fog.transmittance([ray.origin, ray.direction].map(Vector::from), hit);
            prop_assert!((passed - expected).abs() < 2e-3, "{} {}", passed, expected);
        }
    }
}
