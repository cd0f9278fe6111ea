//! Color maps. Cost uses Inferno over a logarithmic range: dark for cheap to light for expensive,
//! with monotone lightness. Changes use a diverging map, ColorBrewer's RdBu: blue for cheaper, red
//! for more expensive.

use std::f32::consts::{FRAC_1_SQRT_2, LOG2_E};
use std::iter;

use image::Rgb;

use super::range::{Range, is_drawable};
use super::ticks::Scale;
use world::color::{ColorMap, Palette, rgb8};

/// The color of pixels without a value on the scale: a gray that no color map contains.
pub const NO_VALUE: Rgb<u8> = Rgb([128; 3]);

/// The color map of a range of values.
pub struct Colors {
    scale: Scale,
    /// Colors at equal steps of position from 0 to 1, then [`NO_VALUE`].
    by_step: Vec<Rgb<u8>>,
    /// The place of the low end on the scale.
    low: f32,
    /// Positions per unit of the scale.
    slope: f32,
}

impl Colors {
    /// Creates a map from the first color at `range.low` to the last color at `range.high`.
    pub fn over(range: &Range) -> Self {
        Self::sampled(range, |position| match range.scale {
            Scale::Logarithmic => ColorMap::Inferno.at(position),
            Scale::Linear => ColorMap::RedBlue.at(1.0 - position),
        })
    }

    /// Creates a color map for data.
    pub fn from_map(range: &Range, map: &Palette) -> Self {
        Self::sampled(range, |position| map.at(position))
    }

    /// Samples a color map in equal steps.
    fn sampled(range: &Range, color_at: impl Fn(f64) -> [f64; 3]) -> Self {
        let position = |i| f64::from(i) / f64::from(N_COLORS - 1);
        let colors = (0..N_COLORS).map(|i| Rgb(rgb8(color_at(position(i)))));
        let [low, high] = [range.low, range.high].map(|end| place(range.scale, end as f32));
        Self {
            scale: range.scale,
            by_step: colors.chain([NO_VALUE]).collect(),
            low,
            slope: 1.0 / (high - low),
        }
    }

    /// Returns the colors of values; outside of the range, the color of the nearer end.
    pub fn look_up(&self, values: &[f32]) -> impl Iterator<Item = Rgb<u8>> {
        let mut steps = vec![0; values.len()];
        // One loop per scale, which compiles to vector instructions.
        match self.scale {
            Scale::Logarithmic => fill(values, &mut steps, |value| {
                let step = self.step((log2(value) - self.low) * self.slope);
                if is_drawable(value) { step } else { N_COLORS }
            }),
            Scale::Linear => fill(values, &mut steps, |value| {
                let step = self.step((value - self.low) * self.slope);
                if value.is_finite() { step } else { N_COLORS }
            }),
        }
        steps
            .into_iter()
            .map(|step| self.by_step[usize::from(step)])
    }

    /// Returns the color at `position` between the low (0) and the high (1) end of the range.
    pub fn at(&self, position: f32) -> Rgb<u8> {
        self.by_step[usize::from(self.step(position))]
    }

    /// Returns the step of a position, the nearer end outside of 0 to 1.
    #[inline]
    fn step(&self, position: f32) -> u16 {
        let last = N_COLORS - 1;
        // The cast saturates.
        let step = (position * f32::from(last) + 0.5) as i32;
        step.clamp(0, last.into()) as u16
    }
}

/// Calculates the step of each value.
#[inline]
fn fill(values: &[f32], steps: &mut [u16], step: impl Fn(f32) -> u16) {
    iter::zip(steps, values).for_each(|(to, &value)| *to = step(value));
}

/// Returns the place of a value along a scale.
fn place(scale: Scale, value: f32) -> f32 {
    match scale {
        Scale::Logarithmic => log2(value),
        Scale::Linear => value,
    }
}

/// Returns the binary logarithm of a positive, normal, finite float: the same bits on every machine,
/// unlike [`f32::log2`]. The error is at most 2e-7, or that part of the logarithm.
///
/// A float is a power of two times a mantissa `m` from sqrt(1/2) to sqrt(2), and ln m is
/// 2 artanh((m - 1) / (m + 1)), whose series converges fast (Abramowitz and Stegun, 4.1.27).
#[inline]
fn log2(value: f32) -> f32 {
    let sqrt_half = FRAC_1_SQRT_2.to_bits();
    let above = value.to_bits().wrapping_sub(sqrt_half);
    let exponent = above as i32 >> 23;
    let mantissa = f32::from_bits((above & 0x7f_ffff) + sqrt_half);
    let ratio = (mantissa - 1.0) / (mantissa + 1.0);
    let square = ratio * ratio;
    let series = 1.0 + square * (1.0 / 3.0 + square * (1.0 / 5.0 + square * (1.0 / 7.0)));
    exponent as f32 + 2.0 * LOG2_E * ratio * series
}

/// Finer than 8 bits per channel, so that interpolated colors show no bands.
const N_COLORS: u16 = 1024;

#[cfg(test)]
mod tests {
    use super::*;

    fn color(colors: &Colors, value: f32) -> Rgb<u8> {
        colors.look_up(&[value]).next().unwrap()
    }

    #[test]
    fn logarithms_are_those_of_the_library() {
        for exponent in (-126..128).step_by(3) {
            for i in 0..500 {
                let value = 2_f32.powi(exponent) * (1.0 + i as f32 / 500.0);
                let expected = f64::from(value).log2();
                let error = (f64::from(log2(value)) - expected).abs();
                assert!(error <= 2e-7 * expected.abs().max(1.0), "{value}: {error}");
            }
        }
    }

    fn inferno(t: f64) -> Rgb<u8> {
        Rgb(rgb8(ColorMap::Inferno.at(t)))
    }

    #[test]
    fn the_ends_have_the_end_colors() {
        for (low, high) in [(1.0, 2.0), (100.0, 101.5), (37.0, 9.1e6), (2e-38, f32::MAX)] {
            let colors = Colors::over(&Range::spanning(&[low, high]));
            assert_eq!(
                [color(&colors, low), color(&colors, high)],
                [inferno(0.0), inferno(1.0)]
            );
            assert_eq!(
                [colors.at(0.0), colors.at(1.0)],
                [inferno(0.0), inferno(1.0)]
            );
        }
    }

    #[test]
    fn values_and_positions_agree() {
        let range = Range::spanning(&[20.0, 70_000.0]);
        let colors = Colors::over(&range);
        for i in 0..=200 {
            let position = f64::from(i) / 200.0;
            let value = range.low * (range.high / range.low).powf(position);
            let apart = |a: Rgb<u8>, b: Rgb<u8>| (0..3).map(|c| a[c].abs_diff(b[c])).max();
            assert!(apart(color(&colors, value as f32), colors.at(position as f32)) <= Some(2));
            assert!(apart(color(&colors, value as f32), inferno(position)) <= Some(6));
        }
    }

    #[test]
    fn expensive_is_lighter() {
        let colors = Colors::over(&Range::spanning(&[1.0, 1e6]));
        let lightness = |v: f32| color(&colors, v).0.into_iter().map(u32::from).sum::<u32>();
        let ladder: Vec<u32> = (0..20)
            .map(|i| lightness(10f32.powf(i as f32 * 0.3)))
            .collect();
        assert!(ladder.is_sorted_by(|a, b| a < b), "{ladder:?}");
    }

    #[test]
    fn decreases_are_blue_and_increases_are_red() {
        let colors = Colors::over(&Range::around_zero(&[-50.0, 20.0]));
        let [cheaper, same, costlier] = [-50.0, 0.0, 50.0].map(|change| color(&colors, change).0);
        assert!(cheaper[2] > 2 * cheaper[0] && costlier[0] > 2 * costlier[2]);
        assert!(same.iter().all(|&channel| channel > 230), "{same:?}");
        assert_eq!(
            [color(&colors, -1e9).0, color(&colors, 1e9).0],
            [cheaper, costlier]
        );
        assert_eq!(color(&colors, f32::NAN), NO_VALUE);
    }

    #[test]
    fn outside_the_scale_is_gray() {
        let colors = Colors::over(&Range::spanning(&[1.0, 10.0]));
        for value in [f32::NAN, f32::INFINITY, -f32::INFINITY, 0.0, -1.0, 1e-40] {
            assert_eq!(color(&colors, value), NO_VALUE);
        }
        assert_eq!(
            [color(&colors, 0.5), color(&colors, 20.0)],
            [inferno(0.0), inferno(1.0)]
        );
    }
}
