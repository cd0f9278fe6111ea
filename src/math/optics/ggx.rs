//! Rough surfaces of microscopic facets with the GGX distribution.
//!
//! Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007. All
//! directions are in the space of the surface, whose normal is z, and point away from the surface.

use std::f32::consts::{FRAC_1_PI, PI};

use crate::sampling::disk;
use crate::simd::{Real, Vector};
use base::keywords;

/// The microfacets of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ggx<R = f32> {
    /// The width of the distribution, greater than 0.
    pub alpha: R,
    /// The masking-shadowing function.
    pub masking: Masking,
}

keywords! {
    /// How masking (facets that the viewer does not see) correlates with shadowing (facets that light
    /// does not reach), both by Smith's function.
    #[derive(Default)]
    pub enum Masking {
        /// As in pbrt and Blender's Cycles.
        #[default]
        HeightCorrelated = "height_correlated",
        /// Darker, as in Mitsuba.
        Separable = "separable",
    }
}

/// Reflection toward a direction.
pub struct Facets<R> {
    /// The cosine of the angle between a direction and the facets that reflect it.
    pub cos: R,
    /// Pi times the reflected radiance for white light of radiance 1 from one steradian, if the
    /// facets reflect all light.
    pub value: R,
    /// The probability density of the direction when [`Ggx::facet`] is sampled.
    pub density: R,
}

impl Ggx {
    /// The least width: narrower distributions exceed the range of `f32`.
    pub const MIN_ALPHA: f32 = 1e-4;

    /// Returns the facets of a surface of this roughness, from 0 to 1, whose square is the width so
    /// that steps look even: Burley, "Physically Based Shading at Disney", SIGGRAPH 2012; `None`
    /// for a smooth surface.
    pub fn from_roughness(roughness: f32, masking: Masking) -> Option<Self> {
        let alpha = roughness * roughness;
        (alpha >= Self::MIN_ALPHA).then_some(Self { alpha, masking })
    }
}

impl<R: Real> Ggx<R> {
    /// Returns the facets of a surface of this roughness, at least [`Ggx::MIN_ALPHA`] wide.
    #[inline(always)]
    pub fn never_smooth(roughness: R, masking: Masking) -> Self {
        let alpha = roughness * roughness;
        Self {
            alpha: alpha.max(alpha.splat(Ggx::MIN_ALPHA)),
            masking,
        }
    }

    /// Evaluates reflection between two directions above the surface.
    #[inline(always)]
    pub fn reflection(self, to_viewer: Vector<R>, to_light: Vector<R>) -> Facets<R> {
        let (zero, one, least) = (
            to_viewer.z.splat(0.0),
            to_viewer.z.splat(1.0),
            to_viewer.z.splat(1e-6),
        );
        let facet = (to_viewer + to_light).normalize();
        let cos = to_viewer.dot(facet).max(zero).min(one);
        let [viewer_z, light_z] = [to_viewer.z.max(least), to_light.z.max(least)];
        let distribution = self.distribution(facet);
        let [of_viewer, of_light] = [self.lambda(viewer_z), self.lambda(light_z)];
        let common = distribution / (one.splat(4.0) * viewer_z);
        Facets {
            cos,
            value: one.splat(PI) * common / self.hidden(of_viewer, of_light),
            density: common / (one + of_viewer),
        }
    }

    /// Returns the probability density of the direction `below` to which the sampled
    /// [`facet`](Self::facet) refracts light from `above`; `eta` is the ratio of the indices of
    /// refraction above and below the surface.
    #[inline(always)]
    pub fn refraction(self, [above, below]: [Vector<R>; 2], facet: Vector<R>, eta: R) -> R {
        let (zero, one) = (eta.splat(0.0), eta.splat(1.0));
        let cos_above = above.dot(facet).max(zero);
        let cos_below = (-below.dot(facet)).max(zero);
        let z = above.z.max(one.splat(1e-6));
        let of_facet = self.distribution(facet) * cos_above / (z * (one + self.lambda(z)));
        let root = eta * cos_above - cos_below;
        of_facet * cos_below / (root * root).max(one.splat(f32::MIN_POSITIVE))
    }

    /// Samples a facet visible from a direction with two numbers in [0, 1), and returns its normal.
    ///
    /// Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4), 2018.
    #[inline(always)]
    pub fn facet(self, to_viewer: Vector<R>, numbers: [R; 2]) -> Vector<R> {
        let (zero, one, half) = (
            to_viewer.z.splat(0.0),
            to_viewer.z.splat(1.0),
            to_viewer.z.splat(0.5),
        );
        let alpha = self.alpha;
        // Stretch the surface so that its facets form a hemisphere.
        let stretched = Vector {
            x: alpha * to_viewer.x,
            y: alpha * to_viewer.y,
            z: to_viewer.z.max(one.splat(1e-6)),
        }
        .normalize();
        // Sample the part of the disk that is visible from there.
        let [x, y] = disk(numbers);
        let height = (one - x * x).max(zero).sqrt();
        let share = half * (one + stretched.z);
        let y = (one - share) * height + share * y;
        let z = (one - x * x - y * y).max(zero).sqrt();
        // Build a basis around the stretched direction to the viewer.
        let across2 = stretched.x * stretched.x + stretched.y * stretched.y;
        let across = across2.max(one.splat(1e-20)).sqrt();
        let is_steep = across2.lt(one.splat(1e-12));
        let first = Vector {
            x: R::select(is_steep, one, -stretched.y / across),
            y: R::select(is_steep, zero, stretched.x / across),
            z: zero,
        };
        let second = stretched.cross(first);
        // Project the point onto the hemisphere, and unstretch it.
        let hemisphere = first * x + second * y + stretched * z;
        Vector {
            x: alpha * hemisphere.x,
            y: alpha * hemisphere.y,
            z: hemisphere.z.max(one.splat(1e-6)),
        }
        .normalize()
    }

    /// Returns the fraction of light that other facets let pass from a visible facet toward
    /// `to_light`.
    #[inline(always)]
    pub fn visibility(self, to_viewer: Vector<R>, to_light: Vector<R>) -> R {
        let one = to_viewer.z.splat(1.0);
        let of_viewer = self.lambda(to_viewer.z.abs().max(one.splat(1e-6)));
        let of_light = self.lambda(to_light.z.abs().max(one.splat(1e-6)));
        (one + of_viewer) / self.hidden(of_viewer, of_light)
    }

    /// Returns the reciprocal of the share of facets that are visible from both directions, given
    /// their [`lambda`](Self::lambda).
    #[inline(always)]
    fn hidden(self, of_viewer: R, of_light: R) -> R {
        let one = of_viewer.splat(1.0);
        match self.masking {
            Masking::HeightCorrelated => one + of_viewer + of_light,
            Masking::Separable => (one + of_viewer) * (one + of_light),
        }
    }

    /// Returns the density of facet normals, per steradian.
    #[inline(always)]
    fn distribution(self, facet: Vector<R>) -> R {
        let alpha2 = self.alpha * self.alpha;
        // sin² from x and y, which avoids cancellation near the normal.
        let sin2 = facet.x * facet.x + facet.y * facet.y;
        let root = sin2 + facet.z * facet.z * alpha2;
        alpha2 * alpha2.splat(FRAC_1_PI) / (root * root)
    }

    /// Returns Smith's auxiliary function of the cosine of a direction's angle.
    #[inline(always)]
    fn lambda(self, cos: R) -> R {
        let (one, half) = (cos.splat(1.0), cos.splat(0.5));
        let cos2 = cos * cos;
        let tan2 = (one - cos2).max(cos.splat(0.0)) / cos2;
        half * ((one + self.alpha * self.alpha * tan2).sqrt() - one)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::{Split, split};

    const N: u32 = 256;

    fn facets(alpha: f32) -> Ggx {
        Ggx {
            alpha,
            masking: Masking::default(),
        }
    }

    fn grid() -> impl Iterator<Item = [f32; 2]> {
        (0..N * N).map(|i| [i / N, i % N].map(|k| (k as f32 + 0.5) / N as f32))
    }

    fn direction(cos: f32, turn: f32) -> Vector<f32> {
        let sin = (1.0 - cos * cos).sqrt();
        let angle = turn * std::f32::consts::TAU;
        Vector {
            x: sin * angle.cos(),
            y: sin * angle.sin(),
            z: cos,
        }
    }

    #[test]
    fn the_facets_seen_from_above_cover_the_surface() {
        for alpha in [0.1, 0.4, 1.0] {
            let ggx = facets(alpha);
            // The integral of the projected facets over the hemisphere, in cos² of the
            // angle to resolve the peak.
            let sum: f64 = grid()
                .map(|[u, v]| {
                    let t = u * u;
                    let facet = direction(1.0 - t, v);
                    f64::from(ggx.distribution(facet) * facet.z * 2.0 * u)
                })
                .sum();
            let integral = sum * std::f64::consts::TAU / f64::from(N * N);
            assert!((integral - 1.0).abs() < 2e-3, "{alpha}: {integral}");
        }
    }

    #[test]
    fn refracted_samples_have_the_mean_of_quadrature() {
        for (alpha, eta) in [(0.3, 1.0 / 1.5), (0.6, 1.0 / 1.3), (0.3, 1.5), (0.8, 1.3)] {
            for cos in [0.3, 0.9] {
                let ggx = facets(alpha);
                let viewer = direction(cos, 0.1);
                let by_samples: f64 = grid()
                    .map(|numbers| {
                        let facet = ggx.facet(viewer, numbers);
                        let Split {
                            reflectance,
                            refracted,
                        } = split(-viewer, facet, eta);
                        let is_below = reflectance < 1.0 && refracted.z < 0.0;
                        if is_below {
                            f64::from(1.0 + refracted.x)
                        } else {
                            0.0
                        }
                    })
                    .sum::<f64>()
                    / f64::from(N * N);
                let by_quadrature: f64 = grid()
                    .map(|[u, v]| {
                        let light = direction(-u, v);
                        let sum = viewer * eta + light;
                        let facet = if eta < 1.0 { -sum } else { sum }.normalize();
                        if facet.z <= 0.0 {
                            return 0.0;
                        }
                        let density = ggx.refraction([viewer, light], facet, eta);
                        f64::from(density * (1.0 + light.x))
                    })
                    .sum::<f64>()
                    * std::f64::consts::TAU
                    / f64::from(N * N);
                assert!(
                    (by_samples / by_quadrature - 1.0).abs() < 0.01,
                    "{alpha} {eta} {cos}: {by_samples} {by_quadrature}"
                );
            }
        }
    }

    #[test]
    fn samples_have_the_mean_of_quadrature() {
        for (alpha, masking) in [
            (0.2, Masking::HeightCorrelated),
            (0.5, Masking::Separable),
            (1.0, Masking::HeightCorrelated),
            (1.0, Masking::Separable),
        ] {
            for cos in [0.1, 0.5, 0.95] {
                let ggx = Ggx { alpha, masking };
                let viewer = direction(cos, 0.1);
                let by_samples: f64 = grid()
                    .map(|numbers| {
                        let facet = ggx.facet(viewer, numbers);
                        let light = facet * (2.0 * viewer.dot(facet)) - viewer;
                        if light.z <= 0.0 {
                            return 0.0;
                        }
                        let Facets { value, density, .. } = ggx.reflection(viewer, light);
                        let weight = value / (PI * density);
                        assert!((weight / ggx.visibility(viewer, light) - 1.0).abs() < 1e-3);
                        f64::from(weight * (1.0 + light.x))
                    })
                    .sum::<f64>()
                    / f64::from(N * N);
                let by_quadrature: f64 = grid()
                    .map(|[u, v]| {
                        let light = direction(u, v);
                        f64::from(ggx.reflection(viewer, light).value * (1.0 + light.x))
                    })
                    .sum::<f64>()
                    * 2.0
                    / f64::from(N * N);
                assert!(
                    (by_samples / by_quadrature - 1.0).abs() < 0.01,
                    "{alpha} {cos}: {by_samples} {by_quadrature}"
                );
            }
        }
    }
}
