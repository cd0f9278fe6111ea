//! Figures → SVG and PNG.

use std::io::{self, Cursor};

use image::{ImageFormat, RgbImage};
use plotters::coord::Shift;
use plotters::element::{Circle, Cross, PathElement, Text, TriangleMarker};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontStyle, register_font};

use super::axis::Axis;
use super::ceiling;
use super::figure::{Figure, Mark, Series};

/// Width and height in pixels.
const SIZE: (u32, u32) = (960, 640);
/// Part of the width for the names of series, where there are some.
const LEGEND_WIDTH: u32 = 240;
/// Steps in which a law is drawn.
const N_STEPS: u32 = 64;
/// Radius in pixels of the ring around an oversubscribed point.
const RING_RADIUS: i32 = 10;
pub(super) const FONT: &str = "sans-serif";

/// Colours that the colour-blind tell apart: Okabe and Ito, "Color Universal
/// Design", 2008, without the yellow, which is too light for lines.
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
];

impl Figure {
    /// The figure as SVG.
    ///
    /// # Errors
    /// If it cannot be drawn.
    pub fn to_svg(&self) -> io::Result<String> {
        let mut svg = String::new();
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        draw(self, &area).map_err(failed)?;
        area.present().map_err(failed)?;
        drop(area);
        Ok(svg)
    }

    /// The figure as PNG.
    ///
    /// # Errors
    /// If it cannot be drawn.
    pub fn to_png(&self) -> io::Result<Vec<u8>> {
        let (width, height) = SIZE;
        let mut rgb = vec![0; 3 * width as usize * height as usize];
        let area = BitMapBackend::with_buffer(&mut rgb, SIZE).into_drawing_area();
        draw(self, &area).map_err(failed)?;
        area.present().map_err(failed)?;
        drop(area);
        let image = RgbImage::from_raw(width, height, rgb);
        let image = image.ok_or_else(|| io::Error::other("a picture of the wrong size"))?;
        let mut png = Cursor::new(Vec::new());
        image.write_to(&mut png, ImageFormat::Png).map_err(failed)?;
        Ok(png.into_inner())
    }
}

/// Nothing, or what the picture could not take.
pub(super) type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

fn draw<DB: DrawingBackend>(figure: &Figure, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
    // Only the bytes of a font could be refused, and these are known.
    let _ = register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
    area.fill(&WHITE)?;
    let has_limits = marks(figure).any(|mark| ceiling::limit_of(figure, mark).is_some());
    let has_names = figure
        .series
        .iter()
        .any(|series| !name_of(series).is_empty());
    let has_legend = has_names || has_limits;
    let legend_width = if has_legend { LEGEND_WIDTH } else { 0 };
    let (chart, legend) = area.split_horizontally(SIZE.0 - legend_width);
    draw_chart(figure, &chart)?;
    let y_of = |number: usize| 80 + 44 * number as i32;
    let mut y = y_of(figure.series.len());
    let mut note = |draw_key: &dyn Fn(i32) -> Drawn<DB>, lines: &[&str]| -> Drawn<DB> {
        draw_key(y)?;
        for (line, text) in lines.iter().enumerate() {
            let at = (22, y - 8 + 18 * line as i32);
            legend.draw(&Text::new((*text).to_owned(), at, (FONT, 16)))?;
        }
        y += 8 + 18 * lines.len() as i32;
        Ok(())
    };
    let bar = |y| legend.draw(&PathElement::new([(0, y), (16, y)], BLACK.stroke_width(2)));
    if has_limits {
        note(&bar, &["if all its time were", "waiting for memory"])?;
    }
    if figure.series.iter().any(|series| series.law.is_some()) {
        note(&bar, &["a + b x^k, with the", "interval of 95 % of k"])?;
    }
    if marks(figure).any(|mark| mark.oversubscribed) {
        let ring = |y| legend.draw(&Circle::new((8, y), RING_RADIUS, BLACK.stroke_width(1)));
        note(&ring, &["more threads than", "processors: not fitted"])?;
    }
    for (number, series) in figure.series.iter().enumerate() {
        let y = y_of(number);
        draw_symbol(&legend, number, (8, y), false)?;
        let name = name_of(series);
        for (line, text) in name.split(": ").enumerate() {
            let at = (22, y - 8 + 18 * line as i32);
            legend.draw(&Text::new(text.to_owned(), at, (FONT, 16)))?;
        }
    }
    Ok(())
}

fn draw_chart<DB: DrawingBackend>(figure: &Figure, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
    let (x, y) = axes(figure);
    let mut chart = ChartBuilder::on(area)
        .caption(&figure.title, (FONT, 26))
        .margin(16)
        .x_label_area_size(56)
        .y_label_area_size(84)
        .build_cartesian_2d(x, y)?;
    chart
        .configure_mesh()
        .x_desc(&figure.x_title)
        .y_desc(&figure.y_title)
        .label_style((FONT, 17))
        .axis_desc_style((FONT, 19))
        .bold_line_style(BLACK.mix(0.18))
        .light_line_style(BLACK.mix(0.06))
        .draw()?;
    let (x, y) = axes(figure);
    let to_pixels = |x, y| chart.backend_coord(&(x, y));
    ceiling::draw(
        &figure.ceilings,
        (&x, &y),
        to_pixels,
        &area.strip_coord_spec(),
    )?;
    for (number, series) in figure.series.iter().enumerate() {
        let color = color_of(number);
        let points = || series.points.iter();
        if let Some(law) = series.law {
            let line = places(series).map(|x| (x, law.at(x)));
            chart.draw_series(LineSeries::new(line, color.mix(0.8).stroke_width(2)))?;
        } else if figure.is_joined {
            let line = points().map(|mark| (mark.x, mark.y));
            chart.draw_series(LineSeries::new(line, color.mix(0.5).stroke_width(1)))?;
        }
        for mark in points() {
            let [low, high] = mark.interval.map(|end| chart.backend_coord(&(mark.x, end)));
            let interval = PathElement::new([low, high], color.stroke_width(2));
            area.strip_coord_spec().draw(&interval)?;
            let cap = |(x, y)| PathElement::new([(x - 5, y), (x + 5, y)], color.stroke_width(2));
            area.strip_coord_spec().draw(&cap(low))?;
            area.strip_coord_spec().draw(&cap(high))?;
            let (x, y) = chart.backend_coord(&(mark.x, mark.y));
            draw_symbol(area, number, (x, y), mark.oversubscribed)?;
            draw_label(area, &mark.label, (x, y))?;
            if let Some(limit) = ceiling::limit_of(figure, mark) {
                let (x, y) = chart.backend_coord(&(mark.x, limit));
                area.draw(&PathElement::new(
                    [(x - 8, y), (x + 8, y)],
                    color.stroke_width(2),
                ))?;
            }
        }
    }
    Ok(())
}

/// Draws what stands beside a mark: on its left where there is no room on its
/// right.
fn draw_label<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    label: &str,
    (x, y): (i32, i32),
) -> Drawn<DB> {
    let width = 8 * label.len() as i32;
    let (side, x) = match x + 10 + width > area.dim_in_pixel().0 as i32 {
        true => (HPos::Right, x - 10),
        false => (HPos::Left, x + 10),
    };
    let style = TextStyle::from((FONT, 14).into_font()).pos(Pos::new(side, VPos::Top));
    area.draw(&Text::new(label.to_owned(), (x, y + 2), style))
}

/// Draws the symbol of a series: color is not all that tells them apart. That of
/// an oversubscribed point has a ring around it.
fn draw_symbol<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    number: usize,
    at: (i32, i32),
    oversubscribed: bool,
) -> Drawn<DB> {
    let color = color_of(number);
    if oversubscribed {
        area.draw(&Circle::new(at, RING_RADIUS, BLACK.stroke_width(1)))?;
    }
    match number % 3 {
        0 => area.draw(&Circle::new(at, 5, color.filled())),
        1 => area.draw(&TriangleMarker::new(at, 7, color.filled())),
        _ => area.draw(&Cross::new(at, 5, color.stroke_width(2))),
    }
}

/// Where a law is drawn: evenly from the first point of the series to the last
/// one that it was fitted to, by the logarithm, since it is no straight line.
fn places(series: &Series) -> impl Iterator<Item = f64> {
    let fitted = || series.points.iter().filter(|mark| !mark.oversubscribed);
    let [first, last] =
        [fitted().next(), fitted().next_back()].map(|mark| mark.map_or(1.0, |at| at.x));
    (0..=N_STEPS).map(move |i| first * (last / first).powf(f64::from(i) / f64::from(N_STEPS)))
}

fn color_of(number: usize) -> RGBColor {
    COLORS[number % COLORS.len()]
}

fn axes(figure: &Figure) -> (Axis, Axis) {
    let x = match figure.categories.is_empty() {
        true => Axis::around(marks(figure).map(|mark| mark.x), figure.scale),
        false => Axis::of_names(&figure.categories),
    };
    let heights = marks(figure).flat_map(|mark| mark.interval.into_iter().chain([mark.y]));
    let y = Axis::around(heights.chain(ceiling::heights(figure, &x)), figure.scale);
    (x, y)
}

fn marks(figure: &Figure) -> impl Iterator<Item = &Mark> {
    figure.series.iter().flat_map(|series| &series.points)
}

/// The series' label and the exponent of its law.
fn name_of(series: &Series) -> String {
    let law = series.law.map(|law| {
        let interval = law.exponent_95.map_or(String::new(), |[low, high]| {
            format!(" [{low:.2}, {high:.2}]")
        });
        format!("k = {:.3}{interval}", law.growing.exponent)
    });
    let label = Some(series.label.clone()).filter(|label| !label.is_empty());
    label.into_iter().chain(law).collect::<Vec<_>>().join(": ")
}

fn failed(error: impl std::fmt::Display) -> io::Error {
    io::Error::other(format!("cannot draw a plot: {error}"))
}
