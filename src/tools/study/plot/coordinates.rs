//! The axes of a figure, and the positions of its points in pixels.

use plotters::coord::cartesian::Cartesian2d;
use plotters::prelude::*;

use super::axis::PlotAxis;
use super::ceilings;
use super::figure::Figure;
use crate::study::AxisScale;

/// Ratio of the highest to the lowest level of a factor from which its axis is logarithmic.
const MIN_LOG_RATIO: f64 = 8.0;
/// Horizontal distance in pixels between the points of two series at one category.
const SERIES_GAP: i32 = 14;

/// A chart with numeric axes.
pub(super) type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<PlotAxis, PlotAxis>>;

/// Returns the horizontal and the vertical axis of a figure.
pub(super) fn axes(figure: &Figure) -> (PlotAxis, PlotAxis) {
    let x = if figure.categories.is_empty() {
        numeric_x_axis(figure)
    } else {
        PlotAxis::of_names(&figure.categories)
    };
    let heights = figure
        .points()
        .flat_map(|point| point.interval.into_iter().chain([point.y]));
    let y = PlotAxis::around(heights.chain(ceilings::heights(figure, &x)), figure.scale);
    (x, y)
}

/// Returns the horizontal axis of numbers. Levels of a factor that span a wide range have a
/// logarithmic axis even if the metrics do not.
fn numeric_x_axis(figure: &Figure) -> PlotAxis {
    let positions = || figure.points().map(|point| point.x);
    if !figure.has_levels {
        return PlotAxis::around(positions(), figure.scale);
    }
    let low = positions().fold(f64::INFINITY, f64::min);
    let high = positions().fold(0.0, f64::max);
    let is_wide = low > 0.0 && high >= MIN_LOG_RATIO * low;
    let scale = if is_wide {
        AxisScale::Log
    } else {
        figure.scale
    };
    PlotAxis::around(positions(), scale).with_levels(positions().collect())
}

/// Returns the pixel of a point of a series. Series at a category stand side by side, so that their
/// intervals do not cover each other.
pub(super) fn pixel_at<DB: DrawingBackend>(
    figure: &Figure,
    series: usize,
    point: (f64, f64),
    chart: &Chart<DB>,
) -> (i32, i32) {
    let (x, y) = chart.backend_coord(&point);
    if figure.categories.is_empty() {
        return (x, y);
    }
    let from_middle = 2 * series as i32 - (figure.series.len() as i32 - 1);
    (x + from_middle * SERIES_GAP / 2, y)
}
