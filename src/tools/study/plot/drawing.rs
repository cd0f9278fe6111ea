//! Figures → SVG and PNG.

use std::io::{self, Cursor};

use image::{ImageFormat, RgbImage};
use plotters::coord::Shift;
use plotters::element::PathElement;
use plotters::prelude::*;

use super::bars;
use super::ceilings::{self, visible_limit};
use super::coordinates::{Chart, axes, pixel_at};
use super::figure::{Figure, PlotPoint, Series};
use super::labels::draw_labels;
use super::legend::Legend;
use super::symbols::{Drawn, FONT, MARGIN, color_of, draw_ring, draw_symbol, load_font};

/// Width and height in pixels.
const SIZE: (u32, u32) = (960, 640);
/// Number of line segments of a law.
const N_STEPS: u32 = 64;

impl Figure {
    /// Draws the figure as SVG.
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

    /// Draws the figure as PNG.
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

fn draw<DB: DrawingBackend>(figure: &Figure, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
    load_font();
    area.fill(&WHITE)?;
    let legend = Legend::of(figure, area);
    let (chart, right) = area.split_horizontally(SIZE.0 - legend.width());
    if figure.has_bars {
        bars::draw(figure, &chart)?;
    } else {
        draw_chart(figure, &chart)?;
    }
    legend.draw(&right)
}

fn draw_chart<DB: DrawingBackend>(figure: &Figure, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
    let (x, y) = axes(figure);
    let mut chart = ChartBuilder::on(area)
        .caption(&figure.title, (FONT, 26))
        .margin(MARGIN)
        .margin_right(MARGIN + ceilings::labels_width(&figure.ceilings, area))
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
    let plain = area.strip_coord_spec();
    ceilings::draw(&figure.ceilings, (&x, &y), to_pixels, &plain)?;
    for (number, series) in figure.series.iter().enumerate() {
        draw_line(figure, number, &mut chart)?;
        for point in &series.points {
            draw_point(figure, (number, point), &chart, &plain)?;
        }
    }
    draw_labels(figure, &chart, &plain)
}

/// Draws the law of a series, or the line that joins its points.
fn draw_line<DB: DrawingBackend>(
    figure: &Figure,
    number: usize,
    chart: &mut Chart<DB>,
) -> Drawn<DB> {
    let (series, color) = (&figure.series[number], color_of(number));
    if let Some(law) = series.law {
        let line = law_positions(series).map(|x| (x, law.at(x)));
        chart.draw_series(LineSeries::new(line, color.mix(0.8).stroke_width(2)))?;
    } else if figure.is_joined {
        let line = series.points.iter().map(|point| (point.x, point.y));
        chart.draw_series(LineSeries::new(line, color.mix(0.5).stroke_width(1)))?;
    }
    Ok(())
}

/// Draws a point with its interval and its limit.
fn draw_point<DB: DrawingBackend>(
    figure: &Figure,
    (number, point): (usize, &PlotPoint),
    chart: &Chart<DB>,
    area: &DrawingArea<DB, Shift>,
) -> Drawn<DB> {
    let color = color_of(number);
    let at = |y| pixel_at(figure, number, (point.x, y), chart);
    let bar = |(x, y): (i32, i32), reach| {
        PathElement::new([(x - reach, y), (x + reach, y)], color.stroke_width(2))
    };
    let [low, high] = point.interval.map(at);
    area.draw(&PathElement::new([low, high], color.stroke_width(2)))?;
    area.draw(&bar(low, 5))?;
    area.draw(&bar(high, 5))?;
    if point.oversubscribed {
        draw_ring(area, at(point.y))?;
    }
    draw_symbol(area, number, at(point.y))?;
    match visible_limit(figure, point) {
        Some(limit) => area.draw(&bar(at(limit), 8)),
        None => Ok(()),
    }
}

/// Returns the `x` where a law is drawn, from the first to the last point that it is fitted to,
/// equidistant on a logarithmic scale.
fn law_positions(series: &Series) -> impl Iterator<Item = f64> {
    let fitted = || series.points.iter().filter(|point| !point.oversubscribed);
    let [first, last] =
        [fitted().next(), fitted().next_back()].map(|point| point.map_or(1.0, |at| at.x));
    (0..=N_STEPS).map(move |i| first * (last / first).powf(f64::from(i) / f64::from(N_STEPS)))
}

fn failed(error: impl std::fmt::Display) -> io::Error {
    io::Error::other(format!("cannot draw a plot: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::AxisScale;

    fn figure(labels: &[&str]) -> Figure {
        let point = |x: f64| PlotPoint {
            x,
            y: 2.0 * x,
            interval: [1.9 * x, 2.1 * x],
            label: String::new(),
            limit: None,
            oversubscribed: false,
        };
        let series = |label: &&str| Series {
            label: (*label).to_owned(),
            points: [1.0, 10.0, 100.0].map(point).into(),
            law: None,
        };
        Figure {
            title: "title".to_owned(),
            x_title: "x".to_owned(),
            y_title: "y".to_owned(),
            scale: AxisScale::Log,
            categories: Vec::new(),
            has_bars: false,
            series: labels.iter().map(series).collect(),
            is_joined: true,
            has_levels: true,
            ceilings: Vec::new(),
        }
    }

    /// Returns the values of an attribute of all elements with this name.
    fn values(svg: &str, element: &str, attribute: &str) -> Vec<f64> {
        let opening = format!("<{element} ");
        let of_element = |rest: &str| {
            let (_, value) = rest
                .split_once(&format!(" {attribute}=\""))
                .or_else(|| rest.split_once(&format!("{attribute}=\"")))?;
            value.split_once('"')?.0.parse().ok()
        };
        svg.split(&opening).skip(1).filter_map(of_element).collect()
    }

    #[test]
    fn a_single_series_has_no_legend() {
        let svg = figure(&[""]).to_svg().unwrap();
        let circles = values(&svg, "circle", "cx");
        assert_eq!(circles.len(), 3, "{svg}");
        assert!(circles.iter().all(|x| *x < f64::from(SIZE.0) - 10.0));
    }

    #[test]
    fn long_labels_of_series_are_wrapped() {
        let long = "a scene of many words, tile order scanline, image size 7680x4320";
        let svg = figure(&[long, "short"]).to_svg().unwrap();
        assert!(!svg.contains(long) && svg.contains("image size"), "{svg}");
        let left = values(&svg, "text", "x").into_iter().fold(0.0, f64::max);
        // The legend leaves most of the picture to the plot.
        assert!(left > 600.0 && left < 760.0, "{left}");
        let png = figure(&[long, "short"]).to_png().unwrap();
        assert!(image::load_from_memory(&png).is_ok());
    }
}
