//! The color bar: colors, ticks, labels, and a pointed tip at each end that clips values.

use super::axis::{AxisEdge, LabeledAxis};
use super::colors::Colors;
use super::label::Unit;
use super::range::Range;
use super::surface::{DrawingSurface, LINE, PixelPosition, Rect, line_px, px};

/// A color bar without a position.
pub struct Bar {
    /// The edge with the labels: at the right of a vertical bar or below a horizontal one.
    pub edge: AxisEdge,
    em_px: f32,
    /// Length in pixels without the tips.
    scale_px: f32,
    /// Lengths of the tips at the low and at the high end in pixels.
    tips_px: [f32; 2],
    axis: LabeledAxis,
}

/// Least number of digits of labels, before trailing zeros are removed.
const MIN_LABEL_DIGITS: usize = 6;

// Distances in ems, the font size of the labels.
const THICKNESS_EM: f32 = 1.4;
const TIP_EM: f32 = 1.1;
/// Distance between the centers of adjacent labels: room for "100.25 ms".
const SIDE_BY_SIDE_EM: f32 = 5.8;
/// Distance between the centers of a label and the next one above.
const STACKED_EM: f32 = 1.6;

impl Bar {
    /// Creates a bar for `range`, as long as one side of a map of `map_size` (width and height in
    /// pixels), with labels of `em_px`. The bar is to the right of the map, or below a wide map
    /// that is too low for the labels.
    pub fn beside([width, height]: [f32; 2], range: &Range, unit: Unit, em_px: f32) -> Self {
        let (edge, length_px, pitch_em) = if 2.0 * width > 5.0 * height {
            (AxisEdge::Bottom, width, SIDE_BY_SIDE_EM)
        } else {
            (AxisEdge::Right, height, STACKED_EM)
        };
        let tip_px = |n_pixels| {
            if n_pixels > 0 {
                px(TIP_EM * em_px)
            } else {
                0.0
            }
        };
        let tips_px = [range.n_below, range.n_above].map(tip_px);
        let scale_px = length_px - tips_px[0] - tips_px[1];
        let min_gap = f64::from(pitch_em * em_px / scale_px);
        let ends = [range.low, range.high];
        let ticks = range.scale.ticks(ends, min_gap);
        let n_digits = label_digits(&ticks.major);
        let label = |value| unit.label(value, n_digits);
        Self {
            edge,
            em_px,
            scale_px,
            tips_px,
            axis: LabeledAxis::new(range.scale, ends, ticks, label),
        }
    }

    /// Returns width and height in pixels, including ticks and labels.
    pub fn size(&self) -> [f32; 2] {
        let length = self.tips_px[0] + self.scale_px + self.tips_px[1];
        let depth = self.thickness_px() + self.axis.depth(self.edge, self.em_px);
        match self.edge {
            AxisEdge::Bottom => [length, depth],
            _ => [depth, length],
        }
    }

    /// Draws the bar with its upper left corner at `corner`, inside its frame.
    pub fn draw(&self, surface: &mut dyn DrawingSurface, [x, y]: PixelPosition, colors: &Colors) {
        let (length, thickness, line) = (self.scale_px, self.thickness_px(), line_px(self.em_px));
        let [low_tip, high_tip] = self.tips_px;
        // Returns a position along the bar from the low end of its scale, and across it.
        let at = |along: f32, across: f32| match self.edge {
            AxisEdge::Bottom => [x + low_tip + along, y + across],
            _ => [x + across, y + high_tip + length - along],
        };
        let scale = Rect::between(at(0.0, 0.0), at(length, thickness));
        surface.rect(scale.grown(line), LINE);
        for i in 0..length as usize {
            let start = i as f32;
            let slice = Rect::between(at(start, 0.0), at(start + 1.0, thickness));
            surface.rect(slice, colors.at((start + 0.5) / length));
        }
        let tips = [(0.0, -low_tip), (length, high_tip)]
            .into_iter()
            .zip([0.0, 1.0]);
        for ((base, tip), position) in tips.filter(|((_, tip), _)| *tip != 0.0) {
            // The outline is half a line outside of the color.
            let apex = at(base + tip, thickness / 2.0);
            let [a, b] = [-line / 2.0, thickness + line / 2.0].map(|across| at(base, across));
            surface.triangle([a, b, apex], colors.at(position));
            surface.line(&[a, b, apex, a], line, LINE);
        }
        self.axis.draw(surface, scale, self.edge, self.em_px);
    }

    fn thickness_px(&self) -> f32 {
        px(THICKNESS_EM * self.em_px)
    }
}

/// Returns the number of digits that distinguish ascending values, and that round steps between them
/// need.
fn label_digits(values: &[f64]) -> usize {
    let steps = values.windows(2).map(|pair| pair[1] - pair[0]);
    let step = steps.fold(f64::INFINITY, f64::min);
    let size = values
        .iter()
        .fold(0.0, |size: f64, value| size.max(value.abs()));
    ((size / step).log10().ceil() as usize + 2).max(MIN_LABEL_DIGITS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_a_narrow_range_differ() {
        for (values, n_digits) in [
            (&[0.0, 0.5, 1.0][..], 6),
            (&[101_325.0, 101_325.005, 101_325.01], 10),
            (&[1.7e9, 1.7e9 + 20.0], 10),
            (&[5.0], 6),
            (&[], 6),
        ] {
            assert_eq!(label_digits(values), n_digits, "{values:?}");
            let labels = values
                .iter()
                .map(|value| Unit::from_name("").label(*value, n_digits));
            let distinct: std::collections::HashSet<String> = labels.collect();
            assert_eq!(distinct.len(), values.len(), "{values:?}");
        }
    }
}
