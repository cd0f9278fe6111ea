//! Labels beside points, placed such that they cover neither each other nor points.

use super::ceilings::visible_limit;
use super::figure::Figure;
use super::plane::PlotPlane;
use super::symbols::{draw_text, text_width};
use output::chart::{DrawingSurface, PixelPosition, Rect};

/// Font size in pixels.
const EM_PX: f32 = 12.0;

/// Draws the labels of all points, after the points themselves.
pub(super) fn draw_labels(figure: &Figure, plane: &PlotPlane, surface: &mut dyn DrawingSurface) {
    let mut placement = LabelPlacement {
        bounds: plane.area,
        occupied: Vec::new(),
    };
    let numbered = || {
        let series = figure.series.iter().enumerate();
        series.flat_map(|(number, series)| series.points.iter().map(move |point| (number, point)))
    };
    for (number, point) in numbered() {
        let at = |y| plane.pixel_at(figure, number, point.x, y);
        placement.occupied.push(Rect::around(at(point.y), 7.0));
        let [low, high] = point.interval.map(at);
        let bar = Rect::between([low[0] - 5.0, low[1]], [high[0] + 5.0, high[1]]);
        placement.occupied.push(bar);
        if let Some(limit) = visible_limit(figure, point) {
            placement.occupied.push(Rect::around(at(limit), 6.0));
        }
    }
    for (number, point) in numbered().filter(|(_, point)| !point.label.is_empty()) {
        let size = [text_width(&point.label, EM_PX), EM_PX + 2.0];
        let label = placement.place(plane.pixel_at(figure, number, point.x, point.y), size);
        let at = [label.x, label.y + label.height / 2.0];
        draw_text(surface, &point.label, at, EM_PX);
    }
}

/// The occupied parts of a plot.
struct LabelPlacement {
    bounds: Rect,
    occupied: Vec<Rect>,
}

impl LabelPlacement {
    /// Occupies the best place for a label of this width and height beside a position: within the
    /// bounds and where it covers least; among equals on the right.
    fn place(&mut self, [x, y]: PixelPosition, [width, height]: [f32; 2]) -> Rect {
        let (near, far, farthest) = (9.0, 16.0, 27.0);
        let lefts = [x + near, x - near - width, x - width / 2.0];
        let tops = [
            y + 2.0,
            y - 2.0 - height,
            y - height / 2.0,
            y + near,
            y - near - height,
            y + far,
            y - far - height,
            y + farthest,
            y - farthest - height,
        ];
        let places = tops.iter().flat_map(|&top| lefts.map(|left| [left, top]));
        let places = places.map(|corner| Rect::at(corner, [width, height]));
        let cost = |place: &Rect| {
            let covered = self.occupied.iter().map(|rect| rect.overlap(place));
            let outside = width * height - self.bounds.overlap(place);
            covered.sum::<f32>() + if outside > 0.1 { 1e6 } else { 0.0 }
        };
        let best = places.min_by(|a, b| cost(a).total_cmp(&cost(b)));
        let best = best.unwrap_or_else(|| Rect::around([x, y], 0.0));
        self.occupied.push(best);
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placement(occupied: Vec<Rect>) -> LabelPlacement {
        let bounds = Rect::around([100.0; 2], 100.0);
        LabelPlacement { bounds, occupied }
    }

    #[test]
    fn labels_of_close_points_do_not_cover_each_other() {
        let points = [
            [100.0, 100.0],
            [108.0, 104.0],
            [112.0, 98.0],
            [190.0, 100.0],
        ];
        let symbols = points.map(|point| Rect::around(point, 6.0));
        let mut placement = placement(symbols.into());
        let labels = points.map(|point| placement.place(point, [40.0, 14.0]));
        for (i, label) in labels.iter().enumerate() {
            assert_eq!(label.overlap(&placement.bounds), 40.0 * 14.0, "{label:?}");
            let others = labels[..i].iter().chain(&symbols);
            assert!(
                others
                    .map(|other| label.overlap(other))
                    .all(|area| area == 0.0)
            );
        }
    }

    #[test]
    fn a_single_label_is_on_the_right() {
        let label = placement(Vec::new()).place([50.0; 2], [40.0, 14.0]);
        assert_eq!([label.x, label.y], [59.0, 52.0]);
    }
}
