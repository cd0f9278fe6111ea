//! Phase functions of fog.

use std::f32::consts::FRAC_1_PI;

use math::simd::{Real, Vector, cos_sin};

/// The phase function of Henyey and Greenstein: "Diffuse Radiation in the Galaxy",
/// Astrophysical Journal 93, 1941.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HenyeyGreenstein {
    /// The mean cosine of the scattering angle.
    pub anisotropy: f32,
}

/// Below this magnitude, directions are sampled as for an anisotropy of 0.
const MIN_ANISOTROPY: f32 = 1e-3;

impl HenyeyGreenstein {
    /// Returns the density of directions at this cosine of the scattering angle, per steradian; it
    /// is also the fraction of the light scattered there.
    #[inline(always)]
    pub fn density<R: Real>(self, cos: R) -> R {
        let g = self.effective();
        let square = cos.splat(1.0 + g * g) - cos.splat(2.0 * g) * cos;
        let scale = cos.splat(0.25 * FRAC_1_PI * (1.0 - g * g));
        scale / (square * square.sqrt())
    }

    /// Samples a direction after `before`, both unit vectors, with this density and two numbers in
    /// [0, 1); also returns the cosine of the scattering angle.
    #[inline(always)]
    pub fn sample<R: Real>(self, before: Vector<R>, [u, v]: [R; 2]) -> (Vector<R>, R) {
        let (zero, one) = (u.splat(0.0), u.splat(1.0));
        let g = self.effective();
        let cos = if g == 0.0 {
            one - u.splat(2.0) * u
        } else {
            let root = u.splat(1.0 - g * g) / (u.splat(1.0 - g) + u.splat(2.0 * g) * u);
            (u.splat(1.0 + g * g) - root * root) * u.splat(0.5 / g)
        };
        let cos = cos.max(-one).min(one);
        let sin = (one - cos * cos).max(zero).sqrt();
        let [x, y] = cos_sin(v);
        (before.around([sin * x, sin * y, cos]).normalize(), cos)
    }

    fn effective(self) -> f32 {
        if self.anisotropy.abs() < MIN_ANISOTROPY {
            0.0
        } else {
            self.anisotropy
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use glam::Vec3;

    use super::*;

    #[test]
    fn all_directions_are_chosen_with_their_density() {
        let before = Vec3::new(0.48, -0.6, 0.64);
        for anisotropy in [0.0, 5e-4, 0.3, -0.6, 0.9] {
            let phase = HenyeyGreenstein { anisotropy };
            let n = 500_u16;
            let step = 1.0 / f32::from(n);
            let (mut mean_cos, mut over_density) = (0.0, 0.0);
            for i in 0..n * 20 {
                let numbers = [i % n, i / n].map(|k| f32::from(k) + 0.5);
                let numbers = [numbers[0] * step, numbers[1] * 0.05];
                let (after, cos) = phase.sample(Vector::from(before), numbers);
                let after = Vec3::from(after);
                assert!((after.dot(before) - cos).abs() < 1e-5, "{anisotropy} {cos}");
                mean_cos += cos * 0.05 * step;
                over_density += 0.05 * step / phase.density(cos);
            }
            assert!(
                (mean_cos - anisotropy).abs() < 2e-3,
                "{anisotropy} {mean_cos}"
            );
            // The solid angle of all directions.
            assert!(
                (over_density / (2.0 * TAU) - 1.0).abs() < 0.02,
                "{anisotropy} {over_density}"
            );
        }
    }
}
