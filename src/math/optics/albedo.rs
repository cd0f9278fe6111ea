//! Directional albedo of rough surfaces: the share of light that a surface returns toward a viewer.
//! Single scattering loses the light that facets reflect onto each other; dividing by the albedo
//! restores it.
//!
//! Turquin, "Practical Multiple Scattering Compensation for Microfacet Models", 2019.

use std::sync::LazyLock;

use super::fresnel::{Split, split};
use super::ggx::{Ggx, Masking};
use crate::simd::{DeviceTable, LookupTable, Real, Vector};

/// A table of two functions of the cosine between the normal and the direction to the viewer.
#[derive(Debug, Clone, PartialEq)]
pub struct Albedo {
    /// Both functions, and their differences to the next row, at equal steps of the square root of
    /// the cosine from 0 to 1.
    rows: Vec<[f32; 4]>,
}

/// Number of steps from a cosine of 0 to 1.
const N_STEPS: usize = 32;

/// Number of points of each integral.
const N_POINTS: u32 = 1 << 12;

impl Albedo {
    /// Tabulates a mirror of facets: the albedo if they reflect all light, and if they reflect the
    /// share (1 - cos)⁵ of it (Schlick, "An Inexpensive BRDF Model for Physically-Based Rendering",
    /// 1994).
    pub fn tabulate_mirror(facets: Ggx) -> Self {
        Self::new(facets, |to_viewer, facet| {
            let to_light = (-to_viewer).reflect(facet);
            if to_light.z <= 0.0 {
                return [0.0; 2];
            }
            let returned = facets.visibility(to_viewer, to_light);
            [returned, returned * schlick(to_viewer.dot(facet))]
        })
    }

    /// Tabulates the surface of a clear medium with this index of refraction, reflection and
    /// refraction together: seen from outside and from inside.
    pub fn tabulate_medium(facets: Ggx, index: f32) -> Self {
        Self::new(facets, |to_viewer, facet| {
            [1.0 / index, index].map(|eta| {
                let Split {
                    reflectance,
                    refracted,
                } = split(-to_viewer, facet, eta);
                let mirrored = (-to_viewer).reflect(facet);
                let [reflected, transmitted] = [mirrored, -refracted].map(|to_light| {
                    if to_light.z > 0.0 {
                        facets.visibility(to_viewer, to_light)
                    } else {
                        0.0
                    }
                });
                reflectance * reflected + (1.0 - reflectance) * transmitted
            })
        })
    }

    /// Averages `seen`, the light that a viewer sees of one facet, over the visible facets.
    fn new(facets: Ggx, seen: impl Fn(Vector<f32>, Vector<f32>) -> [f32; 2]) -> Self {
        // Integrate over the visible facets at each cosine.
        let mean = |step: usize| {
            let cos = (step as f32 / N_STEPS as f32).powi(2);
            let to_viewer = Vector {
                x: (1.0 - cos * cos).sqrt(),
                y: 0.0,
                z: cos,
            };
            let (mut sums, mut weights) = ([0.0; 2], 0.0);
            for point in hammersley(N_POINTS) {
                // Densest at the edges, where the facets are steepest.
                let numbers = point.map(|t| (t * t * (3.0 - 2.0 * t)) as f32);
                let weight = point.map(|t| t * (1.0 - t)).iter().product::<f64>();
                let found = seen(to_viewer, facets.facet(to_viewer, numbers));
                for (sum, found) in sums.iter_mut().zip(found) {
                    *sum += weight * f64::from(found);
                }
                weights += weight;
            }
            sums.map(|sum| (sum / weights) as f32)
        };
        let means: Vec<[f32; 2]> = (0..=N_STEPS).map(mean).collect();
        // Store each value with its difference to the next.
        let row = |pair: &[[f32; 2]]| {
            let ([a, b], [next_a, next_b]) = (pair[0], pair[1]);
            [a, b, next_a - a, next_b - b]
        };
        Self {
            rows: means.windows(2).map(row).collect(),
        }
    }

    /// Returns both functions at a cosine from 0 to 1.
    #[inline(always)]
    pub fn at<R: Real>(&self, cos: R) -> [R; 2] {
        let (zero, steps) = (cos.splat(0.0), cos.splat(N_STEPS as f32));
        let place = cos.max(zero).sqrt() * steps;
        let row = place.floor().min(cos.splat((N_STEPS - 1) as f32));
        let along = place - row;
        let [a, b, to_next_a, to_next_b] = R::look_up(&self.rows[..], [row]);
        [a + along * to_next_a, b + along * to_next_b]
    }
}

/// The functions of [`Albedo::tabulate_mirror`] for facets of each roughness from 0 to 1, at equal steps;
/// looked up by cosine and roughness.
#[derive(Debug, PartialEq)]
pub struct AlbedoByRoughness([Albedo; N_ROUGHNESSES]);

/// Number of roughnesses in the table.
const N_ROUGHNESSES: usize = 12;

impl AlbedoByRoughness {
    /// Returns the table, computed once per masking.
    pub fn with_masking(masking: Masking) -> &'static Self {
        static CORRELATED: LazyLock<AlbedoByRoughness> =
            LazyLock::new(|| AlbedoByRoughness::new(Masking::HeightCorrelated));
        static SEPARABLE: LazyLock<AlbedoByRoughness> =
            LazyLock::new(|| AlbedoByRoughness::new(Masking::Separable));
        match masking {
            Masking::HeightCorrelated => &CORRELATED,
            Masking::Separable => &SEPARABLE,
        }
    }

    fn new(masking: Masking) -> Self {
        Self(std::array::from_fn(|i| {
            let roughness = i as f32 / (N_ROUGHNESSES - 1) as f32;
            Albedo::tabulate_mirror(Ggx::never_smooth(roughness, masking))
        }))
    }
}

impl LookupTable<2, 2> for AlbedoByRoughness {
    #[inline]
    fn values_at(&self, [cos, roughness]: [f32; 2]) -> [f32; 2] {
        let place = roughness.clamp(0.0, 1.0) * (N_ROUGHNESSES - 1) as f32;
        let below = (place as usize).min(N_ROUGHNESSES - 2);
        let along = place - below as f32;
        let [[a, b], [next_a, next_b]] = [below, below + 1].map(|i| self.0[i].at(cos));
        [a + along * (next_a - a), b + along * (next_b - b)]
    }

    fn on_device(&self) -> Result<DeviceTable, &'static str> {
        Err("a picture of roughness with multiple scattering")
    }
}

/// Returns the points of Hammersley's set in the unit square.
fn hammersley(n: u32) -> impl Iterator<Item = [f64; 2]> {
    let scale = 2.0_f64.powi(-32);
    (0..n).map(move |i| {
        let inverse = (f64::from(i.reverse_bits()) + 0.5) * scale;
        [(f64::from(i) + 0.5) / f64::from(n), inverse]
    })
}

/// Returns Schlick's (1 - cos)⁵: the share of light that is added to the reflectance of facets seen
/// at an angle with this cosine.
#[inline(always)]
pub fn schlick<R: Real>(cos: R) -> R {
    let one = cos.splat(1.0);
    let rest = (one - cos).max(cos.splat(0.0));
    let square = rest * rest;
    square * square * rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facets(alpha: f32) -> Ggx {
        Ggx {
            alpha,
            masking: Masking::HeightCorrelated,
        }
    }

    #[test]
    fn smooth_surfaces_lose_nothing() {
        let facets = facets(0.01);
        for cos in [0.2_f32, 0.7, 1.0] {
            let [all, _] = Albedo::tabulate_mirror(facets).at(cos);
            let [outside, inside] = Albedo::tabulate_medium(facets, 1.5).at(cos);
            for found in [all, outside, inside] {
                assert!((found - 1.0).abs() < 2e-3, "{cos}: {found}");
            }
        }
    }

    #[test]
    fn a_mirror_of_roughness_1_has_a_closed_form_from_above() {
        let [all, schlick] = Albedo::tabulate_mirror(facets(1.0)).at(1.0_f32);
        assert!((all - (1.0 - 2.0_f32.ln())).abs() < 5e-4, "{all}");
        assert!(schlick < 0.01 * all);
    }

    #[test]
    fn rows_are_dense_enough() {
        for alpha in [0.02, 0.1, 0.3, 1.0] {
            let facets = facets(alpha);
            for albedo in [
                Albedo::tabulate_mirror(facets),
                Albedo::tabulate_medium(facets, 1.5),
            ] {
                let half = albedo.rows.len() / 2;
                let coarse = |i: usize| {
                    0.5 * (albedo.rows[2 * i][0] + albedo.rows[(2 * i + 2).min(2 * half - 1)][0])
                };
                for i in 1..half - 1 {
                    // The error of a step is a quarter of the error of a step twice as long.
                    let error = 0.25 * (coarse(i) - albedo.rows[2 * i + 1][0]);
                    let tolerance = if alpha < 0.1 { 4e-3 } else { 1e-3 };
                    assert!(error.abs() < tolerance, "{alpha}, row {i}: {error}");
                }
            }
        }
    }
}
