//! The ceilings of a plot: straight lines on logarithmic axes, each with a label at its right end
//! or, if it rises, at its left end.

use super::figure::{Ceiling, Figure, PlotPoint};
use super::plane::PlotPlane;
use super::symbols::{draw_text, text_width};
use crate::study::PowerLaw;
use output::chart::{DrawingSurface, INK, LabeledAxis, PixelPosition, faded};

/// Minimum vertical distance between labels in pixels.
const LINE_HEIGHT: f32 = 19.0;
/// Font size in pixels.
const EM_PX: f32 = 13.5;
/// Distance between a line's end and its label in pixels.
const LABEL_GAP: f32 = 6.0;

/// Returns the heights that the vertical axis has to include: the labeled ends of the ceilings, and
/// the visible limits of points.
pub(super) fn heights(figure: &Figure, x: &LabeledAxis) -> Vec<f64> {
    let ceilings = figure.ceilings.iter();
    let ends = ceilings.map(|ceiling| ceiling.law.at(labeled_end(&ceiling.law, x)));
    let limits = figure
        .points()
        .filter_map(|point| visible_limit(figure, point));
    ends.chain(limits).collect()
}

/// Returns the limit of a point unless it exceeds all ceilings, and with them the plot.
pub(super) fn visible_limit(figure: &Figure, point: &PlotPoint) -> Option<f64> {
    let limit = point.limit?;
    let highest = figure
        .ceilings
        .iter()
        .map(|ceiling| ceiling.law.at(point.x));
    let highest = highest.fold(0.0, f64::max);
    (limit <= highest.max(point.y)).then_some(limit)
}

/// Returns the width in pixels of the labels on the right of the axes.
pub(super) fn labels_width(ceilings: &[Ceiling]) -> f32 {
    let on_right = ceilings.iter().filter(|ceiling| !is_rising(ceiling));
    let widths = on_right.map(|ceiling| LABEL_GAP + text_width(&ceiling.label, EM_PX));
    widths.fold(0.0, f32::max)
}

/// Draws lines and labels.
pub(super) fn draw(ceilings: &[Ceiling], plane: &PlotPlane, surface: &mut dyn DrawingSurface) {
    let (mut on_left, mut on_right) = (Vec::new(), Vec::new());
    for ceiling in ceilings {
        let Some(ends) = visible_range(&ceiling.law, &plane.x, &plane.y) else {
            continue;
        };
        let ends = ends.map(|x| plane.at(x, ceiling.law.at(x)));
        surface.line(&ends, 1.5, faded(INK, 0.4));
        let [[left_x, left_y], [right_x, right_y]] = ends;
        if is_rising(ceiling) {
            on_left.push((
                [left_x + LABEL_GAP, left_y + LINE_HEIGHT / 2.0 + 3.0],
                ceiling,
            ));
        } else {
            on_right.push(([right_x + LABEL_GAP, right_y], ceiling));
        }
    }
    draw_labels(on_left, surface);
    draw_labels(on_right, surface);
}

/// Draws labels from top to bottom; a label that would cover the previous one moves down.
fn draw_labels(mut labels: Vec<(PixelPosition, &Ceiling)>, surface: &mut dyn DrawingSurface) {
    labels.sort_by(|([_, a], _), ([_, b], _)| a.total_cmp(b));
    let mut free = f32::NEG_INFINITY;
    for ([x, y], ceiling) in labels {
        let middle = y.max(free);
        free = middle + LINE_HEIGHT;
        draw_text(surface, &ceiling.label, [x.round(), middle], EM_PX);
    }
}

fn is_rising(ceiling: &Ceiling) -> bool {
    ceiling.law.exponent > 0.0
}

/// Returns the `x` of the labeled end, where the lines are far from each other.
fn labeled_end(law: &PowerLaw, x: &LabeledAxis) -> f64 {
    if law.exponent > 0.0 {
        x.ends[0]
    } else {
        x.ends[1]
    }
}

/// Returns the range of `x` where the line is within both axes.
fn visible_range(law: &PowerLaw, x: &LabeledAxis, y: &LabeledAxis) -> Option<[f64; 2]> {
    if law.exponent == 0.0 {
        let is_within = (y.ends[0]..=y.ends[1]).contains(&law.factor);
        return is_within.then_some(x.ends);
    }
    let mut crossings = y.ends.map(|y| (y / law.factor).powf(1.0 / law.exponent));
    crossings.sort_by(f64::total_cmp);
    let [left, right] = [crossings[0].max(x.ends[0]), crossings[1].min(x.ends[1])];
    (left < right).then_some([left, right])
}

#[cfg(test)]
mod tests {
    use super::*;
    use output::chart::{Scale, Ticks};

    #[test]
    fn lines_end_where_the_axes_do() {
        let axis = |ends| {
            LabeledAxis::new(Scale::Logarithmic, ends, Ticks::default(), |_| {
                String::new()
            })
        };
        let (x, y) = (axis([1.0, 100.0]), axis([10.0, 1000.0]));
        let law = |factor, exponent| PowerLaw { factor, exponent };
        assert_eq!(visible_range(&law(100.0, 1.0), &x, &y), Some([1.0, 10.0]));
        assert_eq!(
            visible_range(&law(5000.0, -1.0), &x, &y),
            Some([5.0, 100.0])
        );
        assert_eq!(visible_range(&law(1e6, -1.0), &x, &y), None);
        assert_eq!(visible_range(&law(500.0, 0.0), &x, &y), Some([1.0, 100.0]));
        assert_eq!(visible_range(&law(5000.0, 0.0), &x, &y), None);
    }
}
