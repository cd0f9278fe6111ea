//! Figures → SVG and PNG.

use std::io::{self, Cursor};

use image::{ImageFormat, RgbImage};
use plotters::chart::SeriesAnno;
use plotters::coord::Shift;
use plotters::element::{Circle, Cross, ErrorBar, IntoDynElement, TriangleMarker};
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

use super::axis::Axis;
use super::figure::{Figure, Series};

/// Width and height in pixels.
const SIZE: (u32, u32) = (960, 640);
const FONT: &str = "sans-serif";

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

type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

fn draw<'a, DB: DrawingBackend + 'a>(figure: &Figure, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
    // Only the bytes of a font could be refused, and these are known.
    let _ = register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
    area.fill(&WHITE)?;
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
    for (number, series) in figure.series.iter().enumerate() {
        let color = COLORS[number % COLORS.len()];
        let points = || series.points.iter();
        if let Some(law) = series.law {
            let ends = [points().next(), points().last()].into_iter().flatten();
            let line = ends.map(|mark| (mark.x, law.at(mark.x)));
            chart.draw_series(LineSeries::new(line, color.mix(0.8).stroke_width(2)))?;
        } else if figure.categories.is_empty() {
            let line = points().map(|mark| (mark.x, mark.y));
            chart.draw_series(LineSeries::new(line, color.mix(0.5).stroke_width(1)))?;
        }
        let bar = |[low, high]: [f64; 2], x, y| {
            ErrorBar::new_vertical(x, low, y, high, color.stroke_width(2), 10)
        };
        chart.draw_series(points().map(|mark| bar(mark.interval, mark.x, mark.y)))?;
        // A shape of the series' own: colour is not all that tells them apart.
        let (name, style) = (name_of(series), color.filled());
        let places = points().map(|mark| (mark.x, mark.y));
        match number % 3 {
            0 => named(
                chart.draw_series(places.map(|at| Circle::new(at, 5, style)))?,
                name,
                move |at| Circle::new(at, 5, style),
            ),
            1 => named(
                chart.draw_series(places.map(|at| TriangleMarker::new(at, 7, style)))?,
                name,
                move |at| TriangleMarker::new(at, 7, style),
            ),
            _ => named(
                chart.draw_series(places.map(|at| Cross::new(at, 5, color.stroke_width(2))))?,
                name,
                move |at| Cross::new(at, 5, color.stroke_width(2)),
            ),
        }
    }
    if figure
        .series
        .iter()
        .any(|series| !name_of(series).is_empty())
    {
        chart
            .configure_series_labels()
            .label_font((FONT, 16))
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.2))
            .position(SeriesLabelPosition::UpperLeft)
            .draw()?;
    }
    Ok(())
}

/// Puts a series into the legend, if it has a name.
fn named<'a, DB: DrawingBackend + 'a, E: IntoDynElement<'a, DB, (i32, i32)>>(
    series: &mut SeriesAnno<'a, DB>,
    name: String,
    symbol: impl Fn((i32, i32)) -> E + 'a,
) {
    if !name.is_empty() {
        series.label(name).legend(move |(x, y)| symbol((x + 10, y)));
    }
}

fn axes(figure: &Figure) -> (Axis, Axis) {
    let marks = || figure.series.iter().flat_map(|series| &series.points);
    let y = Axis::around(
        marks().flat_map(|mark| mark.interval.into_iter().chain([mark.y])),
        figure.scale,
    );
    let x = match figure.categories.is_empty() {
        true => Axis::around(marks().map(|mark| mark.x), figure.scale),
        false => Axis::of_names(&figure.categories),
    };
    (x, y)
}

/// The series' label and the exponent of its law.
fn name_of(series: &Series) -> String {
    let law = series.law.map(|law| {
        let [exponent, error] = [law.exponent, law.exponent_error];
        format!("slope {exponent:.3} ± {error:.3}")
    });
    let label = Some(series.label.clone()).filter(|label| !label.is_empty());
    label.into_iter().chain(law).collect::<Vec<_>>().join(": ")
}

fn failed(error: impl std::fmt::Display) -> io::Error {
    io::Error::other(format!("cannot draw a plot: {error}"))
}
