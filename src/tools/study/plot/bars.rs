//! Horizontal bars of medians, one category below the other.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::axis::PlotAxis;
use super::figure::{Figure, PlotPoint};
use super::symbols::{Drawn, FONT, MARGIN, color_of, draw_text, text_width};
use crate::study::AxisScale;

const TEXT_SIZE: i32 = 21;
/// Height of all bars of a category as a share of the distance between categories.
const HEIGHT: f64 = 0.6;
/// Distance in pixels from the end of an interval to the label.
const GAP: i32 = 8;

/// Draws the bars of a figure, the first category on top, with their intervals and labels.
pub(super) fn draw<DB: DrawingBackend>(
    figure: &Figure,
    area: &DrawingArea<DB, Shift>,
) -> Drawn<DB> {
    let names: Vec<String> = figure.categories.iter().rev().cloned().collect();
    let width = |text: &String| text_width(area, text, TEXT_SIZE);
    let labels = figure.points().map(|point| width(&point.label));
    let values = figure
        .points()
        .flat_map(|point| point.interval.into_iter().chain([point.y]));
    let x = PlotAxis::around(values, figure.scale);
    let left = if figure.scale == AxisScale::Log {
        x.low
    } else {
        0.0
    };
    let mut chart = ChartBuilder::on(area)
        .caption(&figure.title, (FONT, 26))
        .margin(MARGIN)
        .margin_right(MARGIN + labels.max().unwrap_or(0))
        .x_label_area_size(56)
        .y_label_area_size(names.iter().map(width).max().unwrap_or(0) + GAP)
        .build_cartesian_2d(x, PlotAxis::of_names(&names))?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .x_desc(&figure.y_title)
        .label_style((FONT, TEXT_SIZE))
        .axis_desc_style((FONT, 19))
        .bold_line_style(BLACK.mix(0.18))
        .light_line_style(BLACK.mix(0.06))
        .draw()?;
    let plain = area.strip_coord_spec();
    let height = HEIGHT / figure.series.len() as f64;
    for (number, series) in figure.series.iter().enumerate() {
        for point in &series.points {
            let top = names.len() as f64 - 1.0 - point.x + HEIGHT / 2.0 - number as f64 * height;
            let at = |x: f64, y: f64| chart.backend_coord(&(x, y));
            let bar = [at(left, top), at(point.y, top - height)];
            plain.draw(&Rectangle::new(bar, color_of(number).mix(0.85).filled()))?;
            let [low, high] = point.interval.map(|x| at(x, top - height / 2.0));
            draw_interval(point, (low, high), &plain)?;
        }
    }
    Ok(())
}

/// Draws an interval from its lower to its upper end, and the label behind it.
fn draw_interval<DB: DrawingBackend>(
    point: &PlotPoint,
    (low, high): ((i32, i32), (i32, i32)),
    area: &DrawingArea<DB, Shift>,
) -> Drawn<DB> {
    area.draw(&PathElement::new([low, high], BLACK.stroke_width(2)))?;
    for (x, y) in [low, high] {
        area.draw(&PathElement::new(
            [(x, y - 5), (x, y + 5)],
            BLACK.stroke_width(2),
        ))?;
    }
    let corner = (high.0 + GAP, high.1 - TEXT_SIZE / 2);
    draw_text(area, &point.label, corner, TEXT_SIZE, HPos::Left)
}
