//! Figures → SVG and PNG.

use std::io::{self, Cursor};

use image::{ImageFormat, RgbImage};
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::element::PathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::axis::Axis;
use super::ceiling;
use super::figure::{Figure, Mark, Scale, Series};
use super::ink::{Drawn, FONT, color_of, draw_ring, draw_symbol, draw_text, load_font, text_width};
use super::label::{Rect, Room};
use super::legend::Legend;

/// Width and height in pixels.
const SIZE: (u32, u32) = (960, 640);
const MARGIN: i32 = 16;
/// Steps in which a law is drawn.
const N_STEPS: u32 = 64;
/// Ratio of the levels of a factor from which on they lie by their logarithms.
const WIDE: f64 = 8.0;
/// Text beside marks.
const LABEL_SIZE: i32 = 14;
/// Pixels between the marks of two series over one name.
const SERIES_GAP: i32 = 14;

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

fn draw<DB: DrawingBackend>(figure: &Figure, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
    load_font();
    area.fill(&WHITE)?;
    let legend = Legend::of(figure, area);
    let (chart, right) = area.split_horizontally(SIZE.0 - legend.width());
    draw_chart(figure, &chart)?;
    legend.draw(&right)
}

type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<Axis, Axis>>;

fn draw_chart<DB: DrawingBackend>(figure: &Figure, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
    let (x, y) = axes(figure);
    let mut chart = ChartBuilder::on(area)
        .caption(&figure.title, (FONT, 26))
        .margin(MARGIN)
        .margin_right(MARGIN + ceiling::names_width(&figure.ceilings, area))
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
    ceiling::draw(&figure.ceilings, (&x, &y), to_pixels, &plain)?;
    for (number, series) in figure.series.iter().enumerate() {
        draw_line(figure, number, &mut chart)?;
        for mark in &series.points {
            draw_mark(figure, (number, mark), &chart, &plain)?;
        }
    }
    draw_labels(figure, &chart, &plain)
}

/// Draws the law of a series, or what joins its points.
fn draw_line<DB: DrawingBackend>(
    figure: &Figure,
    number: usize,
    chart: &mut Chart<DB>,
) -> Drawn<DB> {
    let (series, color) = (&figure.series[number], color_of(number));
    if let Some(law) = series.law {
        let line = places(series).map(|x| (x, law.at(x)));
        chart.draw_series(LineSeries::new(line, color.mix(0.8).stroke_width(2)))?;
    } else if figure.is_joined {
        let line = series.points.iter().map(|mark| (mark.x, mark.y));
        chart.draw_series(LineSeries::new(line, color.mix(0.5).stroke_width(1)))?;
    }
    Ok(())
}

/// Draws a point, its interval and its limit.
fn draw_mark<DB: DrawingBackend>(
    figure: &Figure,
    (number, mark): (usize, &Mark),
    chart: &Chart<DB>,
    area: &DrawingArea<DB, Shift>,
) -> Drawn<DB> {
    let color = color_of(number);
    let at = |y| place(figure, number, (mark.x, y), chart);
    let bar = |(x, y): (i32, i32), reach| {
        PathElement::new([(x - reach, y), (x + reach, y)], color.stroke_width(2))
    };
    let [low, high] = mark.interval.map(at);
    area.draw(&PathElement::new([low, high], color.stroke_width(2)))?;
    area.draw(&bar(low, 5))?;
    area.draw(&bar(high, 5))?;
    if mark.oversubscribed {
        draw_ring(area, at(mark.y))?;
    }
    draw_symbol(area, number, at(mark.y))?;
    match ceiling::limit_of(figure, mark) {
        Some(limit) => area.draw(&bar(at(limit), 8)),
        None => Ok(()),
    }
}

/// Where a point of a series lies in pixels. Series over a name stand side by
/// side: their intervals would cover each other.
fn place<DB: DrawingBackend>(
    figure: &Figure,
    number: usize,
    point: (f64, f64),
    chart: &Chart<DB>,
) -> (i32, i32) {
    let (x, y) = chart.backend_coord(&point);
    if figure.categories.is_empty() {
        return (x, y);
    }
    let from_middle = 2 * number as i32 - (figure.series.len() as i32 - 1);
    (x + from_middle * SERIES_GAP / 2, y)
}

/// Draws what stands beside marks, when all of them are there.
fn draw_labels<DB: DrawingBackend>(
    figure: &Figure,
    chart: &Chart<DB>,
    area: &DrawingArea<DB, Shift>,
) -> Drawn<DB> {
    let (x, y) = chart.plotting_area().get_pixel_range();
    let mut room = Room::new(Rect {
        left: x.start,
        top: y.start,
        right: x.end,
        bottom: y.end,
    });
    let of_all = || {
        let numbered = figure.series.iter().enumerate();
        numbered.flat_map(|(number, series)| series.points.iter().map(move |mark| (number, mark)))
    };
    for (number, mark) in of_all() {
        let at = |y| place(figure, number, (mark.x, y), chart);
        room.take(Rect::around(at(mark.y), 7));
        let [(left, bottom), (_, top)] = mark.interval.map(at);
        room.take(Rect {
            left: left - 5,
            top,
            right: left + 5,
            bottom,
        });
        if let Some(limit) = ceiling::limit_of(figure, mark) {
            room.take(Rect::around(at(limit), 6));
        }
    }
    for (number, mark) in of_all().filter(|(_, mark)| !mark.label.is_empty()) {
        let size = (text_width(area, &mark.label, LABEL_SIZE), LABEL_SIZE + 2);
        let name = room.place(place(figure, number, (mark.x, mark.y), chart), size);
        draw_text(
            area,
            &mark.label,
            (name.left, name.top),
            LABEL_SIZE,
            HPos::Left,
        )?;
    }
    Ok(())
}

/// Where a law is drawn: evenly from the first point of the series to the last
/// one that it was fitted to, by the logarithm, since it is no straight line.
fn places(series: &Series) -> impl Iterator<Item = f64> {
    let fitted = || series.points.iter().filter(|mark| !mark.oversubscribed);
    let [first, last] =
        [fitted().next(), fitted().next_back()].map(|mark| mark.map_or(1.0, |at| at.x));
    (0..=N_STEPS).map(move |i| first * (last / first).powf(f64::from(i) / f64::from(N_STEPS)))
}

fn axes(figure: &Figure) -> (Axis, Axis) {
    let x = if figure.categories.is_empty() {
        lower_axis(figure)
    } else {
        Axis::of_names(&figure.categories)
    };
    let heights = marks(figure).flat_map(|mark| mark.interval.into_iter().chain([mark.y]));
    let y = Axis::around(heights.chain(ceiling::heights(figure, &x)), figure.scale);
    (x, y)
}

/// The lower axis of numbers. Levels of a factor that spread over decades lie by
/// their logarithms even if the measured values do not.
fn lower_axis(figure: &Figure) -> Axis {
    let places = || marks(figure).map(|mark| mark.x);
    if !figure.has_levels {
        return Axis::around(places(), figure.scale);
    }
    let low = places().fold(f64::INFINITY, f64::min);
    let high = places().fold(0.0, f64::max);
    let spreads = low > 0.0 && high >= WIDE * low;
    let scale = if spreads { Scale::Log } else { figure.scale };
    Axis::around(places(), scale).with_levels(places().collect())
}

fn marks(figure: &Figure) -> impl Iterator<Item = &Mark> {
    figure.series.iter().flat_map(|series| &series.points)
}

fn failed(error: impl std::fmt::Display) -> io::Error {
    io::Error::other(format!("cannot draw a plot: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(labels: &[&str]) -> Figure {
        let mark = |x: f64| Mark {
            x,
            y: 2.0 * x,
            interval: [1.9 * x, 2.1 * x],
            label: String::new(),
            limit: None,
            oversubscribed: false,
        };
        let series = |label: &&str| Series {
            label: (*label).to_owned(),
            points: [1.0, 10.0, 100.0].map(mark).into(),
            law: None,
        };
        Figure {
            title: "title".to_owned(),
            x_title: "x".to_owned(),
            y_title: "y".to_owned(),
            scale: Scale::Log,
            categories: Vec::new(),
            series: labels.iter().map(series).collect(),
            is_joined: true,
            has_levels: true,
            ceilings: Vec::new(),
        }
    }

    /// The values of an attribute of all elements of this name.
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
    fn an_only_series_has_no_legend() {
        let svg = figure(&[""]).to_svg().unwrap();
        let circles = values(&svg, "circle", "cx");
        assert_eq!(circles.len(), 3, "{svg}");
        assert!(circles.iter().all(|x| *x < f64::from(SIZE.0) - 10.0));
    }

    #[test]
    fn long_names_of_series_are_broken_into_lines() {
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
