//! The axes of a figure, and the positions of its points in pixels.

use super::figure::Figure;
use super::symbols::{MARGIN, WIDTH_FACTOR};
use output::chart::{
    Anchor, AxisEdge, DrawingSurface, INK, LINE, LINE_EM, LabeledAxis, PixelPosition, Rect, Style,
    px,
};

/// Width and height of a picture in pixels.
pub(super) const SIZE: [u32; 2] = [960, 640];
/// Horizontal distance in pixels between the points of two series at one category.
const SERIES_GAP: f32 = 14.0;
// Font sizes, and distances of texts from each other and from the axes, in pixels.
const TITLE_PX: f32 = 22.0;
const AXIS_TITLE_PX: f32 = 16.0;
const GAP: f32 = 13.0;

/// The part of a picture where both axes place points.
pub(super) struct PlotPlane {
    /// The horizontal axis.
    pub(super) x: LabeledAxis,
    /// The vertical axis.
    pub(super) y: LabeledAxis,
    /// The pixels between the axes.
    pub(super) area: Rect,
}

impl PlotPlane {
    /// Draws a grid with axes, whose labels have `em_px`, and with the titles of the plot and of
    /// both axes; `rights` are the right ends of the plot and of its area. An axis without a title
    /// has no grid lines.
    pub(super) fn draw(
        surface: &mut dyn DrawingSurface,
        [title, x_title, y_title]: [&str; 3],
        [x, y]: [LabeledAxis; 2],
        rights: [f32; 2],
        em_px: f32,
    ) -> Self {
        let [title_style, axis_style] = [TITLE_PX, AXIS_TITLE_PX].map(|px| Style::new(px, INK));
        let lines = title_style.wrapped(title, (rights[0] - 2.0 * MARGIN) / WIDTH_FACTOR, 3);
        let to_axis = |title: &str| match title {
            "" => MARGIN,
            _ => MARGIN + AXIS_TITLE_PX + GAP,
        };
        let left = to_axis(y_title) + px(WIDTH_FACTOR * y.depth(AxisEdge::Left, em_px));
        let below = to_axis(x_title) + x.depth(AxisEdge::Bottom, em_px);
        let bottom = SIZE[1] as f32 - below;
        let top = MARGIN + px((lines.len() as f32 * LINE_EM + 0.2) * TITLE_PX);
        let area = Rect::between([left, top], [rights[1], bottom]);

        let [middle_x, middle_y] = [left + area.width / 2.0, top + area.height / 2.0].map(px);
        // A title that is wider than the axes stays within the plot.
        let widths = lines.iter().map(|line| title_style.width(line));
        let half = px(widths.fold(0.0, f32::max) / 2.0);
        let title_x = middle_x.min(rights[0] - MARGIN - half).max(MARGIN + half);
        let at = [title_x, MARGIN + px(0.8 * TITLE_PX)];
        surface.lines(&lines, at, Anchor::Middle, &title_style);
        let at = [middle_x, SIZE[1] as f32 - MARGIN - 4.0];
        surface.text(x_title, at, Anchor::Middle, &axis_style);
        let at = [MARGIN + AXIS_TITLE_PX, middle_y];
        surface.text(y_title, at, Anchor::Middle, &axis_style.turned());
        let edges = [
            (&x, AxisEdge::Bottom, x_title),
            (&y, AxisEdge::Left, y_title),
        ];
        for (axis, edge, _) in edges.iter().filter(|(.., title)| !title.is_empty()) {
            axis.draw_grid(surface, area, *edge);
        }
        for (axis, edge, _) in edges {
            axis.draw(surface, area, edge, em_px);
        }
        for end in [[area.right(), bottom + 1.0], [left + 1.0, top]] {
            surface.rect(Rect::between([left, bottom], end), LINE);
        }
        Self { x, y, area }
    }

    /// Returns the position of a value of each axis.
    pub(super) fn at(&self, x: f64, y: f64) -> PixelPosition {
        let Rect { width, height, .. } = self.area;
        let right = self.area.x + self.x.position(x) * width;
        [right, self.area.bottom() - self.y.position(y) * height]
    }

    /// Returns the whole pixels at a point of a series. Series at a category stand side by side, so
    /// that their intervals do not cover each other.
    pub(super) fn pixel_at(&self, figure: &Figure, series: usize, x: f64, y: f64) -> PixelPosition {
        let [x, y] = self.at(x, y).map(px);
        if figure.categories.is_empty() {
            return [x, y];
        }
        let from_middle = series as f32 - (figure.series.len() as f32 - 1.0) / 2.0;
        [px(x + from_middle * SERIES_GAP), y]
    }
}
