//! Labels beside points, placed such that they cover neither each other nor points.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::ceilings::visible_limit;
use super::coordinates::{Chart, pixel_at};
use super::figure::Figure;
use super::symbols::{Drawn, draw_text, text_width};

const TEXT_SIZE: i32 = 14;

/// Draws the labels of all points, after the points themselves.
pub(super) fn draw_labels<DB: DrawingBackend>(
    figure: &Figure,
    chart: &Chart<DB>,
    area: &DrawingArea<DB, Shift>,
) -> Drawn<DB> {
    let (x, y) = chart.plotting_area().get_pixel_range();
    let mut placement = LabelPlacement::new(PixelRect {
        left: x.start,
        top: y.start,
        right: x.end,
        bottom: y.end,
    });
    let numbered = || {
        let series = figure.series.iter().enumerate();
        series.flat_map(|(number, series)| series.points.iter().map(move |point| (number, point)))
    };
    for (number, point) in numbered() {
        let at = |y| pixel_at(figure, number, (point.x, y), chart);
        placement.occupy(PixelRect::around(at(point.y), 7));
        let [(left, bottom), (_, top)] = point.interval.map(at);
        placement.occupy(PixelRect {
            left: left - 5,
            top,
            right: left + 5,
            bottom,
        });
        if let Some(limit) = visible_limit(figure, point) {
            placement.occupy(PixelRect::around(at(limit), 6));
        }
    }
    for (number, point) in numbered().filter(|(_, point)| !point.label.is_empty()) {
        let size = (text_width(area, &point.label, TEXT_SIZE), TEXT_SIZE + 2);
        let label = placement.place(pixel_at(figure, number, (point.x, point.y), chart), size);
        let corner = (label.left, label.top);
        draw_text(area, &point.label, corner, TEXT_SIZE, HPos::Left)?;
    }
    Ok(())
}

/// A rectangle of pixels, `top` above `bottom`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct PixelRect {
    left: i32,
    top: i32,
    right: i32,
    bottom: i32,
}

impl PixelRect {
    /// Returns the square around a pixel.
    fn around((x, y): (i32, i32), radius: i32) -> Self {
        Self {
            left: x - radius,
            top: y - radius,
            right: x + radius,
            bottom: y + radius,
        }
    }

    /// Returns the number of pixels in both rectangles.
    fn overlap(self, other: Self) -> i64 {
        let width = self.right.min(other.right) - self.left.max(other.left);
        let height = self.bottom.min(other.bottom) - self.top.max(other.top);
        i64::from(width.max(0)) * i64::from(height.max(0))
    }

    fn is_within(self, other: Self) -> bool {
        let is_beside = self.left >= other.left && self.right <= other.right;
        is_beside && self.top >= other.top && self.bottom <= other.bottom
    }
}

/// The occupied parts of a plot.
struct LabelPlacement {
    bounds: PixelRect,
    occupied: Vec<PixelRect>,
}

impl LabelPlacement {
    /// Creates an empty plot within `bounds`.
    fn new(bounds: PixelRect) -> Self {
        let occupied = Vec::new();
        Self { bounds, occupied }
    }

    /// Marks a rectangle as occupied.
    fn occupy(&mut self, rect: PixelRect) {
        self.occupied.push(rect);
    }

    /// Occupies the best place for a label of this width and height beside the pixel `(x, y)`:
    /// within the bounds and where it covers least; among equals on the right.
    fn place(&mut self, (x, y): (i32, i32), (width, height): (i32, i32)) -> PixelRect {
        let (near, far, farthest) = (9, 16, 27);
        let lefts = [x + near, x - near - width, x - width / 2];
        let tops = [
            y + 2,
            y - 2 - height,
            y - height / 2,
            y + near,
            y - near - height,
            y + far,
            y - far - height,
            y + farthest,
            y - farthest - height,
        ];
        let at = |left: i32, top: i32| PixelRect {
            left,
            top,
            right: left + width,
            bottom: top + height,
        };
        let places = tops.iter().flat_map(|&top| lefts.map(|left| at(left, top)));
        let cost = |place: &PixelRect| {
            let covered = self
                .occupied
                .iter()
                .map(|rect| rect.overlap(*place))
                .sum::<i64>();
            (!place.is_within(self.bounds), covered)
        };
        let best = places.min_by_key(cost).unwrap_or_else(|| at(x, y));
        self.occupied.push(best);
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_close_points_do_not_cover_each_other() {
        let bounds = PixelRect::around((100, 100), 100);
        let mut placement = LabelPlacement::new(bounds);
        let points = [(100, 100), (108, 104), (112, 98), (190, 100)];
        for point in points {
            placement.occupy(PixelRect::around(point, 6));
        }
        let labels = points.map(|point| placement.place(point, (40, 14)));
        for (i, label) in labels.iter().enumerate() {
            assert!(label.is_within(bounds), "{label:?}");
            assert!(labels[..i].iter().all(|other| label.overlap(*other) == 0));
            let covered = points.map(|point| label.overlap(PixelRect::around(point, 6)));
            assert_eq!(covered, [0; 4], "{label:?}");
        }
    }

    #[test]
    fn a_single_label_is_on_the_right() {
        let mut placement = LabelPlacement::new(PixelRect::around((100, 100), 100));
        let label = placement.place((50, 50), (40, 14));
        assert_eq!((label.left, label.top), (59, 52));
    }
}
