//! Color maps. Cost uses Inferno over a logarithmic range: dark for cheap to light for expensive,
//! with monotone lightness. Changes use a diverging map, ColorBrewer's RdBu: blue for cheaper, red
//! for more expensive.

use image::Rgb;

use super::range::Range;
use super::ticks::Scale;
use scene::color::{ColorMap, Palette, rgb8};

/// The color of pixels without a value on the scale: a gray that no color map contains.
pub const NO_VALUE: Rgb<u8> = Rgb([128; 3]);

/// The color map of a range of values.
pub struct Colors {
    range: Range,
    /// Colors at equal steps of position from 0 to 1.
    by_position: Vec<Rgb<u8>>,
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
    pub fn of_map(range: &Range, map: &Palette) -> Self {
        Self::sampled(range, |position| map.at(position))
    }

    /// Samples a color map in equal steps.
    fn sampled(range: &Range, color_at: impl Fn(f64) -> [f64; 3]) -> Self {
        let position = |i| i as f64 / (N_COLORS - 1) as f64;
        let colors = (0..N_COLORS).map(|i| Rgb(rgb8(color_at(position(i)))));
        let [low, high] = [range.low, range.high].map(|end| place(range.scale, end as f32));
        Self {
            range: *range,
            by_position: colors.collect(),
            low,
            slope: 1.0 / (high - low),
        }
    }

    /// Returns the color of a value, or the color of the nearer end outside of the range.
    pub fn color(&self, value: f32) -> Rgb<u8> {
        if !self.range.can_show(value) {
            return NO_VALUE;
        }
        // One logarithm of single precision, instead of three of double.
        self.at((place(self.range.scale, value) - self.low) * self.slope)
    }

    /// Returns the color at `position` between the low (0) and the high (1) end of the range.
    pub fn at(&self, position: f32) -> Rgb<u8> {
        let step = position * (N_COLORS - 1) as f32;
        // The cast saturates: values below the range become 0.
        self.by_position[((step + 0.5) as usize).min(N_COLORS - 1)]
    }
}

/// Returns the place of a value along a scale.
fn place(scale: Scale, value: f32) -> f32 {
    match scale {
        Scale::Logarithmic => value.log2(),
        Scale::Linear => value,
    }
}

/// Finer than 8 bits per channel, so that interpolated colors show no bands.
const N_COLORS: usize = 1024;

#[cfg(test)]
mod tests {
    use super::*;

    fn inferno(t: f64) -> Rgb<u8> {
        Rgb(rgb8(ColorMap::Inferno.at(t)))
    }

    #[test]
    fn the_ends_have_the_end_colors() {
        for (low, high) in [(1.0, 2.0), (100.0, 101.5), (37.0, 9.1e6), (2e-38, f32::MAX)] {
            let colors = Colors::over(&Range::spanning(&[low, high]));
            assert_eq!(
                [colors.color(low), colors.color(high)],
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
            assert!(apart(colors.color(value as f32), colors.at(position as f32)) <= Some(2));
            assert!(apart(colors.color(value as f32), inferno(position)) <= Some(6));
        }
    }

    #[test]
    fn expensive_is_lighter() {
        let colors = Colors::over(&Range::spanning(&[1.0, 1e6]));
        let lightness = |v: f32| colors.color(v).0.into_iter().map(u32::from).sum::<u32>();
        let ladder: Vec<u32> = (0..20)
            .map(|i| lightness(10f32.powf(i as f32 * 0.3)))
            .collect();
        assert!(ladder.is_sorted_by(|a, b| a < b), "{ladder:?}");
    }

    #[test]
    fn decreases_are_blue_and_increases_are_red() {
        let colors = Colors::over(&Range::around_zero(&[-50.0, 20.0]));
        let [cheaper, same, costlier] = [-50.0, 0.0, 50.0].map(|change| colors.color(change).0);
        assert!(cheaper[2] > 2 * cheaper[0] && costlier[0] > 2 * costlier[2]);
        assert!(same.iter().all(|&channel| channel > 230), "{same:?}");
        assert_eq!(
            [colors.color(-1e9).0, colors.color(1e9).0],
            [cheaper, costlier]
        );
        assert_eq!(colors.color(f32::NAN), NO_VALUE);
    }

    #[test]
    fn outside_the_scale_is_gray() {
        let colors = Colors::over(&Range::spanning(&[1.0, 10.0]));
        for value in [f32::NAN, f32::INFINITY, -f32::INFINITY, 0.0, -1.0, 1e-40] {
            assert_eq!(colors.color(value), NO_VALUE);
        }
        assert_eq!(
            [colors.color(0.5), colors.color(20.0)],
            [inferno(0.0), inferno(1.0)]
        );
    }
}
