//! Figures → SVG and PNG.

use std::io::{self, Write};

use image::{Rgb, RgbImage};

use super::axis::{axis_around, axis_of_levels, axis_of_names};
use super::ceilings::{self, visible_limit};
use super::figure::{Figure, PlotPoint, Series};
use super::labels::draw_labels;
use super::plane::{PlotPlane, SIZE};
use super::symbols::{MARGIN, color_of, draw_bar, draw_interval, draw_ring, draw_symbol};
use super::{bars, legend};
use output::chart::{DrawingSurface, LabeledAxis, PAPER, Rect, Scale, SvgPicture, faded, png};

/// Font size of tick labels in pixels.
const LABEL_PX: f32 = 14.5;
/// Ratio of the highest to the lowest level of a factor from which its axis is logarithmic.
const MIN_LOG_RATIO: f64 = 8.0;
/// Number of line segments of a law.
const N_STEPS: u32 = 64;

impl Figure {
    /// Draws the figure as SVG.
    pub fn to_svg(&self) -> String {
        let mut svg = SvgPicture::new(SIZE);
        draw(self, &mut svg);
        svg.finish()
    }

    /// Draws the figure as PNG.
    ///
    /// # Errors
    /// An error of `out`.
    pub fn write_png(&self, out: &mut impl Write) -> io::Result<()> {
        let mut picture = RgbImage::new(SIZE[0], SIZE[1]);
        draw(self, &mut picture);
        png::write(SIZE, 3, &[], out, |rows| rows.write_all(&picture))
    }
}

fn draw(figure: &Figure, surface: &mut dyn DrawingSurface) {
    let all = Rect::between([0.0; 2], SIZE.map(|n| n as f32));
    surface.rect(all, Rgb([PAPER; 3]));
    let entries = legend::entries(figure);
    let width = legend::left(&entries);
    if figure.has_bars {
        bars::draw(figure, width, surface);
    } else {
        draw_points(figure, width, surface);
    }
    legend::draw(&entries, surface);
}

/// Draws lines and points in a plot of this width.
fn draw_points(figure: &Figure, width: f32, surface: &mut dyn DrawingSurface) {
    let titles = [&*figure.title, &figure.x_title, &figure.y_title];
    let right = width - MARGIN - ceilings::labels_width(&figure.ceilings);
    let plane = PlotPlane::draw(surface, titles, axes(figure), [width, right], LABEL_PX);
    ceilings::draw(&figure.ceilings, &plane, surface);
    for (number, series) in figure.series.iter().enumerate() {
        draw_line(figure, number, &plane, surface);
        for point in &series.points {
            draw_point(figure, number, point, &plane, surface);
        }
    }
    draw_labels(figure, &plane, surface);
}

/// Draws the law of a series, or the line that joins its points.
fn draw_line(figure: &Figure, number: usize, plane: &PlotPlane, surface: &mut dyn DrawingSurface) {
    let (series, color) = (&figure.series[number], color_of(number));
    if let Some(law) = series.law {
        let line: Vec<_> = law_positions(series)
            .map(|x| plane.at(x, law.at(x)))
            .collect();
        surface.line(&line, 2.0, faded(color, 0.2));
    } else if figure.is_joined {
        let points = series.points.iter();
        let line: Vec<_> = points.map(|point| plane.at(point.x, point.y)).collect();
        surface.line(&line, 1.0, faded(color, 0.4));
    }
}

/// Draws a point with its interval and its limit.
fn draw_point(
    figure: &Figure,
    number: usize,
    point: &PlotPoint,
    plane: &PlotPlane,
    surface: &mut dyn DrawingSurface,
) {
    let color = color_of(number);
    let at = |y| plane.pixel_at(figure, number, point.x, y);
    draw_interval(surface, point.interval.map(at), color);
    if point.oversubscribed {
        draw_ring(surface, at(point.y));
    }
    draw_symbol(surface, number, at(point.y));
    if let Some(limit) = visible_limit(figure, point) {
        draw_bar(surface, at(limit), 8.0, color);
    }
}

/// Returns the horizontal and the vertical axis of a figure.
fn axes(figure: &Figure) -> [LabeledAxis; 2] {
    let x = if figure.categories.is_empty() {
        numeric_x_axis(figure)
    } else {
        axis_of_names(&figure.categories)
    };
    let heights = figure
        .points()
        .flat_map(|point| point.interval.into_iter().chain([point.y]));
    let y = axis_around(heights.chain(ceilings::heights(figure, &x)), figure.scale);
    [x, y]
}

/// Returns the horizontal axis of numbers. Levels of a factor that span a wide range have a
/// logarithmic axis even if the metrics do not.
fn numeric_x_axis(figure: &Figure) -> LabeledAxis {
    let positions = || figure.points().map(|point| point.x);
    if !figure.has_levels {
        return axis_around(positions(), figure.scale);
    }
    let low = positions().fold(f64::INFINITY, f64::min);
    let high = positions().fold(0.0, f64::max);
    let is_wide = low > 0.0 && high >= MIN_LOG_RATIO * low;
    let scale = if is_wide {
        Scale::Logarithmic
    } else {
        figure.scale
    };
    axis_of_levels(positions().collect(), scale)
}

/// Returns the `x` where a law is drawn, from the first to the last point that it is fitted to,
/// equidistant on a logarithmic scale.
fn law_positions(series: &Series) -> impl Iterator<Item = f64> {
    let fitted = || series.points.iter().filter(|point| !point.oversubscribed);
    let [first, last] =
        [fitted().next(), fitted().next_back()].map(|point| point.map_or(1.0, |at| at.x));
    (0..=N_STEPS).map(move |i| first * (last / first).powf(f64::from(i) / f64::from(N_STEPS)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(labels: &[&str]) -> Figure {
        let point = |x: f64| PlotPoint {
            x,
            y: 2.0 * x,
            interval: [1.9 * x, 2.1 * x],
            ..Default::default()
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
            series: labels.iter().map(series).collect(),
            is_joined: true,
            has_levels: true,
            ..Default::default()
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
        let svg = figure(&[""]).to_svg();
        let circles = values(&svg, "circle", "cx");
        assert_eq!(circles.len(), 3, "{svg}");
        assert!(circles.iter().all(|x| *x < f64::from(SIZE[0]) - 10.0));
    }

    #[test]
    fn long_labels_of_series_are_wrapped() {
        let long = "a scene of many words, tile order scanline, image size 7680x4320";
        let svg = figure(&[long, "short"]).to_svg();
        assert!(!svg.contains(long) && svg.contains("image size"), "{svg}");
        let left = values(&svg, "text", "x").into_iter().fold(0.0, f64::max);
        // The legend leaves most of the picture to the plot.
        assert!(left > 600.0 && left < 760.0, "{left}");
        let mut png = Vec::new();
        figure(&[long, "short"]).write_png(&mut png).unwrap();
        assert!(image::load_from_memory(&png).is_ok());
    }
}
