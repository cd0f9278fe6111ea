//! The choice of the light that is sampled at a point.

use super::light_source::LightSource;
use crate::geometry::Aabb;
use crate::shading::LightSampling;
use math::sampling::AliasTable;
use math::simd::{Mask, Real, Vector};

/// The method of choosing lights.
#[derive(Debug, Clone, Default)]
pub(super) enum LightChoice {
    /// Samples every light, or the only one.
    #[default]
    Each,
    /// Samples one light, in proportion to the light that would arrive at the point from each.
    ByArrival,
    /// Samples one light, in proportion to the power and to the mean power, half and half.
    ByPower(AliasTable),
}

/// A chosen light per point.
pub(super) struct Chosen<R> {
    /// The index of the light.
    pub(super) index: R,
    /// The probability of this choice.
    pub(super) probability: R,
    /// A number in [0, 1) that is independent of the choice.
    pub(super) number: R,
}

/// Maximum number of lights for which the arriving light is estimated at each point.
const MAX_COMPARED: usize = 16;

/// The largest number below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

impl LightChoice {
    pub(super) fn new(sampling: LightSampling, sources: &[LightSource], scene: &Aabb) -> Self {
        match (sampling, sources.len()) {
            (LightSampling::Each, _) | (LightSampling::Power, 0 | 1) => Self::Each,
            (LightSampling::Power, 2..=MAX_COMPARED) => Self::ByArrival,
            (LightSampling::Power, _) => {
                let powers: Vec<f64> = sources.iter().map(|of| of.power(scene)).collect();
                AliasTable::new(&defensive(powers)).map_or(Self::Each, Self::ByPower)
            }
        }
    }

    /// Chooses the light of sample `i` at a point with numbers in [0, 1): by arrival with `second`,
    /// by power with `numbers`.
    #[inline(always)]
    pub(super) fn choose<R: Real>(
        &self,
        i: usize,
        sources: &[LightSource],
        point: Vector<R>,
        numbers: [R; 2],
        second: R,
    ) -> Chosen<R> {
        let one = second.splat(1.0);
        match self {
            Self::Each => Chosen {
                index: one.splat(i as f32),
                probability: one,
                number: second,
            },
            Self::ByArrival => by_arrival(sources, point, second),
            Self::ByPower(table) => {
                let index = table.choose(numbers);
                Chosen {
                    index,
                    probability: table.probability(index),
                    number: second,
                }
            }
        }
    }

    /// Returns the probability that the light of this index is chosen at a point.
    #[inline(always)]
    pub(super) fn probability<R: Real>(
        &self,
        index: u32,
        sources: &[LightSource],
        point: Vector<R>,
    ) -> R {
        let one = point.x.splat(1.0);
        match self {
            Self::Each => one,
            Self::ByArrival => {
                sources[index as usize].arrival(point) / sum_of_arrivals(sources, point)
            }
            Self::ByPower(table) => table.probability(one.splat(index as f32)),
        }
    }
}

/// Adds the mean to each power: lights far away, or of the sky indoors, have most of the power but
/// may leave a point in the dark that a weak lamp lights.
///
/// Hesterberg, "Weighted Average Importance Sampling and Defensive Mixture Distributions",
/// Technometrics 37(2), 1995.
fn defensive(powers: Vec<f64>) -> Vec<f64> {
    let mean = powers.iter().sum::<f64>() / powers.len() as f64;
    powers.into_iter().map(|power| power + mean).collect()
}

/// Returns the sum of the estimated arrivals at a point.
#[inline(always)]
fn sum_of_arrivals<R: Real>(sources: &[LightSource], point: Vector<R>) -> R {
    let mut sum = point.x.splat(0.0);
    for source in sources {
        sum = sum + source.arrival(point);
    }
    sum
}

/// Inverts the cumulative distribution of the estimated arrivals, so that the numbers that choose
/// one light are as well distributed as all numbers.
#[inline(always)]
fn by_arrival<R: Real>(sources: &[LightSource], point: Vector<R>, number: R) -> Chosen<R> {
    let (zero, one) = (number.splat(0.0), number.splat(1.0));
    let sum = sum_of_arrivals(sources, point);
    let target = number * sum;
    let (mut chosen, mut share, mut below) = (zero, one, zero);
    let mut before = zero;
    let mut is_open = zero.splat_mask(true);
    for (i, source) in sources.iter().enumerate() {
        let of_source = source.arrival(point);
        chosen = R::select(is_open, zero.splat(i as f32), chosen);
        share = R::select(is_open, of_source, share);
        below = R::select(is_open, before, below);
        before = before + of_source;
        is_open = is_open & before.le(target);
        if is_open.none() {
            break;
        }
    }
    Chosen {
        index: chosen,
        probability: share / sum,
        number: ((target - below) / share)
            .max(zero)
            .min(one.splat(BELOW_ONE)),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn lights_are_chosen_as_often_as_their_probability_says() {
        let sources: Vec<LightSource> = [
            "point: { position: [1, 0, 0], intensity: 3, falloff: inverse_square }",
            "directional: { direction: [0, -1, 0], intensity: 0.5 }",
            "point: { position: [0, 9, 0], color: [0, 0, 0] }",
            "spot: { position: [0, 2, 0], target: [0, 0, 0], angle_deg: 40, intensity: 2 }",
        ]
        .map(|text| LightSource::Light(scene::yaml::from_str(text).unwrap()))
        .into();
        const N: u16 = 20_000;
        for point in [
            Vec3::ZERO,
            Vec3::new(0.0, 1.5, 0.0),
            Vec3::new(90.0, 0.0, 0.0),
        ] {
            let (mut shares, mut sums) = ([0.0; 4], [0.0; 4]);
            for i in 0..N {
                let number = (f32::from(i) + 0.5) / f32::from(N);
                let chosen =
                    LightChoice::ByArrival.choose(0, &sources, point.into(), [0.5; 2], number);
                let index = chosen.index as usize;
                let expected =
                    LightChoice::ByArrival.probability(index as u32, &sources, point.into());
                assert_eq!(chosen.probability, expected);
                assert!((0.0..1.0).contains(&chosen.number));
                shares[index] += 1.0 / f32::from(N);
                sums[index] += chosen.number / f32::from(N);
            }
            for (i, share) in shares.into_iter().enumerate() {
                let expected = LightChoice::ByArrival.probability(i as u32, &sources, point.into());
                assert!(
                    (share - expected).abs() < 1e-3,
                    "{point} {i}: {share} {expected}"
                );
                // The rest of the number is uniform.
                assert!((sums[i] - 0.5 * share).abs() < 1e-3, "{point} {i}");
            }
        }
    }
}
