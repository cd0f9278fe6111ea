//! The control points of ParaView's color maps.

use base::Keyword;
use world::color::ColorMap;

/// Every fifth color of a 256-color map: interpolation restores the others within 1/255.
const N_COLORS: usize = 52;

/// Returns value, red, green and blue of each point in turn, for a map such as `inferno` or
/// `red_blue_reversed`; `value_at` returns the value at a fraction from 0 to 1. `None` for an
/// unknown map.
pub(super) fn color_points(map: &str, value_at: impl Fn(f64) -> f64) -> Option<Vec<String>> {
    let reversed = map.strip_suffix("_reversed");
    let map = ColorMap::from_name(reversed.unwrap_or(map))?;
    let point = |i: usize| {
        let fraction = i as f64 / (N_COLORS - 1) as f64;
        let position = if reversed.is_some() {
            1.0 - fraction
        } else {
            fraction
        };
        let [r, g, b] = map.at(position).map(|number| (1e4 * number).round() / 1e4);
        [value_at(fraction), r, g, b].map(|number| number.to_string())
    };
    Some((0..N_COLORS).flat_map(point).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_interpolate_to_the_colors_of_the_map() {
        for name in ["inferno", "viridis", "turbo", "red_blue_reversed"] {
            let points = color_points(name, |fraction| fraction).unwrap();
            let points: Vec<f64> = points.iter().map(|text| text.parse().unwrap()).collect();
            let map = ColorMap::from_name(name.trim_end_matches("_reversed")).unwrap();
            for entry in 0..256 {
                let fraction = f64::from(entry) / 255.0;
                let reversed = name.ends_with("_reversed");
                let expected = map.at(if reversed { 1.0 - fraction } else { fraction });
                let next = (entry as usize / 5 + 1).min(N_COLORS - 1);
                let [a, b] = [next - 1, next].map(|i| &points[4 * i..][..4]);
                let share = (fraction - a[0]) / (b[0] - a[0]);
                for channel in 0..3 {
                    let [a, b] = [a, b].map(|point| point[channel + 1]);
                    let off = 255.0 * (a + share * (b - a) - expected[channel]).abs();
                    assert!(off < 2.5, "{name} at {entry}: {off}");
                }
            }
        }
        assert_eq!(color_points("rainbow", |fraction| fraction), None);
    }
}
