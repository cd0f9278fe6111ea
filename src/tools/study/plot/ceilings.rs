//! The ceilings of a plot: straight lines on logarithmic axes, each with a label at its right end
//! or, if it rises, at its left end.

use plotters::coord::Shift;
use plotters::element::PathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::axis::PlotAxis;
use super::figure::{Ceiling, Figure, PlotPoint};
use super::symbols::{Drawn, draw_text, text_width};
use crate::study::PowerLaw;

/// Minimum vertical distance between labels in pixels.
const LINE_HEIGHT: i32 = 19;
const TEXT_SIZE: i32 = 16;
/// Distance between a line's end and its label in pixels.
const LABEL_GAP: i32 = 6;

/// Returns the heights that the vertical axis has to include: the labeled ends of the ceilings, and
/// the visible limits of points.
pub(super) fn heights(figure: &Figure, x: &PlotAxis) -> Vec<f64> {
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
pub(super) fn labels_width<DB: DrawingBackend>(
    ceilings: &[Ceiling],
    area: &DrawingArea<DB, Shift>,
) -> i32 {
    let on_right = ceilings.iter().filter(|ceiling| !is_rising(ceiling));
    let widths = on_right.map(|ceiling| LABEL_GAP + text_width(area, &ceiling.label, TEXT_SIZE));
    widths.max().unwrap_or(0)
}

/// Draws lines and labels; `to_pixels` maps a point of the axes to its pixel.
pub(super) fn draw<DB: DrawingBackend>(
    ceilings: &[Ceiling],
    (x, y): (&PlotAxis, &PlotAxis),
    to_pixels: impl Fn(f64, f64) -> (i32, i32),
    area: &DrawingArea<DB, Shift>,
) -> Drawn<DB> {
    let (mut on_left, mut on_right) = (Vec::new(), Vec::new());
    for ceiling in ceilings {
        let Some([left, right]) = visible_range(&ceiling.law, x, y) else {
            continue;
        };
        let ends = [left, right].map(|x| to_pixels(x, ceiling.law.at(x)));
        area.draw(&PathElement::new(ends, BLACK.mix(0.6).stroke_width(1)))?;
        if is_rising(ceiling) {
            let (x, y) = ends[0];
            on_left.push(((x + LABEL_GAP, y + 3), ceiling));
        } else {
            let (x, y) = ends[1];
            on_right.push(((x + LABEL_GAP, y - LINE_HEIGHT / 2), ceiling));
        }
    }
    draw_labels(on_left, area)?;
    draw_labels(on_right, area)
}

/// Draws labels from top to bottom; a label that would cover the previous one moves down.
fn draw_labels<DB: DrawingBackend>(
    mut labels: Vec<((i32, i32), &Ceiling)>,
    area: &DrawingArea<DB, Shift>,
) -> Drawn<DB> {
    labels.sort_by_key(|((_, y), _)| *y);
    let mut lowest = i32::MIN;
    for ((x, y), ceiling) in labels {
        let top = y.max(lowest);
        lowest = top + LINE_HEIGHT;
        draw_text(area, &ceiling.label, (x, top), TEXT_SIZE, HPos::Left)?;
    }
    Ok(())
}

fn is_rising(ceiling: &Ceiling) -> bool {
    ceiling.law.exponent > 0.0
}

/// Returns the `x` of the labeled end, where the lines are far from each other.
fn labeled_end(law: &PowerLaw, x: &PlotAxis) -> f64 {
    if law.exponent > 0.0 { x.low } else { x.high }
}

/// Returns the range of `x` where the line is within both axes.
fn visible_range(law: &PowerLaw, x: &PlotAxis, y: &PlotAxis) -> Option<[f64; 2]> {
    if law.exponent == 0.0 {
        let is_within = (y.low..=y.high).contains(&law.factor);
        return is_within.then_some([x.low, x.high]);
    }
    let mut crossings = [y.low, y.high].map(|y| (y / law.factor).powf(1.0 / law.exponent));
    crossings.sort_by(f64::total_cmp);
    let [left, right] = [crossings[0].max(x.low), crossings[1].min(x.high)];
    (left < right).then_some([left, right])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::AxisScale;

    #[test]
    fn lines_end_where_the_axes_do() {
        let axis = |ends: [f64; 2]| {
            let mut axis = PlotAxis::around(ends.into_iter(), AxisScale::Log);
            [axis.low, axis.high] = ends;
            axis
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
