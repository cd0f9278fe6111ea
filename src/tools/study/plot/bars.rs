//! Horizontal bars of medians, one category below the other.

use super::axis::{axis_around, axis_of_names};
use super::figure::{Figure, PlotPoint};
use super::plane::PlotPlane;
use super::symbols::{MARGIN, color_of, draw_text, text_width};
use output::chart::{DrawingSurface, INK, PixelPosition, Rect, Scale, faded, px};

/// Font size of all labels in pixels.
const EM_PX: f32 = 18.0;
/// Height of all bars of a category as a share of the distance between categories.
const HEIGHT: f64 = 0.6;
/// Distance in pixels from the end of an interval to the label.
const GAP: f32 = 8.0;

/// Draws the bars of a figure, the first category on top, with their intervals and labels, in a
/// plot of this width.
pub(super) fn draw(figure: &Figure, width: f32, surface: &mut dyn DrawingSurface) {
    let names: Vec<String> = figure.categories.iter().rev().cloned().collect();
    let labels = figure.points().map(|point| text_width(&point.label, EM_PX));
    let right = width - MARGIN - labels.fold(0.0, f32::max);
    let values = figure
        .points()
        .flat_map(|point| point.interval.into_iter().chain([point.y]));
    let x = axis_around(values, figure.scale);
    let left = match figure.scale {
        Scale::Logarithmic => x.ends[0],
        Scale::Linear => 0.0,
    };
    let titles = [&*figure.title, &figure.y_title, ""];
    let axes = [x, axis_of_names(&names)];
    let plane = PlotPlane::draw(surface, titles, axes, [width, right], EM_PX);
    let height = HEIGHT / figure.series.len() as f64;
    for (number, series) in figure.series.iter().enumerate() {
        for point in &series.points {
            let top = names.len() as f64 - 1.0 - point.x + HEIGHT / 2.0 - number as f64 * height;
            let bar = Rect::between(plane.at(left, top), plane.at(point.y, top - height));
            surface.rect(bar, faded(color_of(number), 0.15));
            let ends = point
                .interval
                .map(|x| plane.at(x, top - height / 2.0).map(px));
            draw_interval(point, ends, surface);
        }
    }
}

/// Draws an interval from its lower to its upper end, and the label behind it.
fn draw_interval(
    point: &PlotPoint,
    [low, high]: [PixelPosition; 2],
    surface: &mut dyn DrawingSurface,
) {
    surface.line(&[low, high], 2.0, INK);
    for [x, y] in [low, high] {
        surface.line(&[[x, y - 5.0], [x, y + 5.0]], 2.0, INK);
    }
    draw_text(surface, &point.label, [high[0] + GAP, high[1]], EM_PX);
}
