//! The color bar: colors, ticks, labels, and a pointed tip at each end that clips values.

use image::{Rgb, RgbImage};

use super::canvas::{self, PixelTriangle, Rect, px};
use super::colors::Colors;
use super::label::Unit;
use super::range::{Range, Scale};
use super::text::{CAP_HEIGHT_EM, Style};
use super::ticks::{linear_ticks, log_ticks};

/// The direction of increasing values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// A vertical bar with labels on its right.
    Up,
    /// A horizontal bar with labels below it.
    Right,
}

/// A color bar without a position.
pub struct Bar {
    direction: Direction,
    em_px: f32,
    line_px: u32,
    /// Length in pixels, with the tips.
    length_px: u32,
    low_tip_px: u32,
    high_tip_px: u32,
    labels: Vec<Label>,
    /// Positions of the ticks without a label.
    minor: Vec<f64>,
}

struct Label {
    /// 0 at the low, 1 at the high end of the range.
    position: f64,
    text: String,
    width_px: f32,
}

impl Label {
    fn new(value: f64, range: &Range, unit: Unit, style: &Style) -> Self {
        let text = unit.label(value, MAX_LABEL_DIGITS);
        Self {
            position: range.position(value),
            width_px: style.width(&text),
            text,
        }
    }
}

/// More digits than the ticks of the narrowest range need.
const MAX_LABEL_DIGITS: usize = 6;

// Distances in ems, the font size of the labels.
const THICKNESS_EM: f32 = 1.4;
const TIP_EM: f32 = 1.1;
const TICK_EM: f32 = 0.45;
const MINOR_TICK_EM: f32 = 0.25;
const LABEL_GAP_EM: f32 = 0.35;
/// Distance between the centers of adjacent labels: room for "100.25 ms".
const SIDE_BY_SIDE_EM: f32 = 5.8;
/// Distance between the centers of a label and the next one above.
const STACKED_EM: f32 = 1.6;

impl Bar {
    /// Creates a bar for `range`, as long as one side of a map of `map_size` (width and height in
    /// pixels), with labels of `em_px`. The bar is to the right of the map, or below a wide map
    /// that is too low for the labels.
    pub fn beside(map_size: [u32; 2], range: &Range, unit: Unit, em_px: f32) -> Self {
        let [width, height] = map_size;
        let (direction, length_px, pitch_em) = if 2 * width > 5 * height {
            (Direction::Right, width, SIDE_BY_SIDE_EM)
        } else {
            (Direction::Up, height, STACKED_EM)
        };
        let tip_px = |n_pixels| if n_pixels > 0 { px(TIP_EM * em_px) } else { 0 };
        let (low_tip_px, high_tip_px) = (tip_px(range.n_below), tip_px(range.n_above));
        let scale_px = (length_px - low_tip_px - high_tip_px) as f32;
        let min_gap = (pitch_em * em_px / scale_px).into();
        let ticks = match range.scale {
            Scale::Logarithmic => log_ticks(range.low, range.high, min_gap),
            Scale::Linear => {
                // Closer labels are hard to read.
                let min_step = (range.high - range.low) * min_gap.max(0.08);
                linear_ticks(range.low, range.high, min_step)
            }
        };
        let style = Style::new(em_px, canvas::INK);
        let label = |&value: &f64| Label::new(value, range, unit, &style);
        Self {
            direction,
            em_px,
            line_px: canvas::line_px(em_px),
            length_px,
            low_tip_px,
            high_tip_px,
            labels: ticks.major.iter().map(label).collect(),
            minor: ticks.minor.iter().map(|&v| range.position(v)).collect(),
        }
    }

    /// Returns the direction of increasing values.
    pub fn direction(&self) -> Direction {
        self.direction
    }

    /// Returns width and height in pixels, including ticks and labels.
    pub fn size(&self) -> [u32; 2] {
        let to_label = self.thickness_px() + self.to_label_px();
        match self.direction {
            Direction::Up => {
                let widths = self.labels.iter().map(|label| label.width_px);
                let widest = widths.fold(0.0, f32::max);
                [to_label + widest.ceil() as u32, self.length_px]
            }
            Direction::Right => [self.length_px, to_label + px(CAP_HEIGHT_EM * self.em_px)],
        }
    }

    /// Paints the bar with its upper left corner at `corner`, x and y, inside its frame.
    pub fn paint(&self, picture: &mut RgbImage, corner: [u32; 2], colors: &Colors) {
        let [x, y] = corner;
        let placed = Placed { bar: self, x, y };
        placed.paint_scale(picture, colors);
        placed.paint_tips(picture, colors);
        placed.paint_ticks(picture);
        placed.paint_labels(picture);
    }

    fn scale_px(&self) -> u32 {
        self.length_px - self.low_tip_px - self.high_tip_px
    }

    fn thickness_px(&self) -> u32 {
        px(THICKNESS_EM * self.em_px)
    }

    /// Returns the distance from the bar to its labels.
    fn to_label_px(&self) -> u32 {
        px((TICK_EM + LABEL_GAP_EM) * self.em_px)
    }
}

/// A bar at a position. Coordinates are measured along the bar from its low end, and across it
/// toward the labels.
struct Placed<'a> {
    bar: &'a Bar,
    x: u32,
    y: u32,
}

impl Placed<'_> {
    fn paint_scale(&self, picture: &mut RgbImage, colors: &Colors) {
        let (n, thickness) = (self.bar.scale_px(), self.bar.thickness_px());
        let low = self.bar.low_tip_px;
        let frame = self.rect(low, n, 0, thickness).grown(self.bar.line_px);
        canvas::fill_rect(picture, frame, canvas::LINE);
        for i in 0..n {
            let color = colors.at((i as f32 + 0.5) / n as f32);
            canvas::fill_rect(picture, self.rect(low + i, 1, 0, thickness), color);
        }
    }

    fn paint_tips(&self, picture: &mut RgbImage, colors: &Colors) {
        let (low, length) = (self.bar.low_tip_px, self.bar.length_px);
        if low > 0 {
            self.paint_tip(picture, low, 0, colors.at(0.0));
        }
        if self.bar.high_tip_px > 0 {
            let high = length - self.bar.high_tip_px;
            self.paint_tip(picture, high, length, colors.at(1.0));
        }
    }

    /// Paints a framed triangle as wide as the bar, from its base to its apex along the bar.
    fn paint_tip(&self, picture: &mut RgbImage, base: u32, apex: u32, color: Rgb<u8>) {
        let line = self.bar.line_px as f32;
        let thickness = self.bar.thickness_px() as f32;
        let outline: PixelTriangle = [
            self.point(base as f32, -line),
            self.point(base as f32, thickness + line),
            self.point(apex as f32, thickness / 2.0),
        ];
        canvas::fill_triangle(picture, outline, canvas::LINE);
        canvas::fill_triangle(picture, canvas::inset(outline, line), color);
    }

    fn paint_ticks(&self, picture: &mut RgbImage) {
        let Bar {
            ref labels,
            ref minor,
            line_px,
            em_px,
            ..
        } = *self.bar;
        let major = labels.iter().map(|label| (label.position, TICK_EM));
        let minor = minor.iter().map(|&position| (position, MINOR_TICK_EM));
        for (position, length_em) in minor.chain(major) {
            let last = self.bar.length_px.saturating_sub(line_px);
            let along = self.along(position).saturating_sub(line_px / 2).min(last);
            let across = self.bar.thickness_px();
            let tick = self.rect(along, line_px, across, px(length_em * em_px));
            canvas::fill_rect(picture, tick, canvas::LINE);
        }
    }

    fn paint_labels(&self, picture: &mut RgbImage) {
        let style = Style::new(self.bar.em_px, canvas::INK);
        let cap_height_px = CAP_HEIGHT_EM * self.bar.em_px;
        let across = (self.bar.thickness_px() + self.bar.to_label_px()) as f32;
        for label in &self.bar.labels {
            let [x, y] = self.point(self.along(label.position) as f32 + 0.5, across);
            let (left, baseline) = match self.bar.direction {
                Direction::Up => (x, y + cap_height_px / 2.0),
                Direction::Right => (x - label.width_px / 2.0, y + cap_height_px),
            };
            let rightmost = picture.width() as f32 - label.width_px;
            style.paint(picture, &label.text, px(left.min(rightmost)), px(baseline));
        }
    }

    /// Returns the pixel along the bar that shows `position`.
    fn along(&self, position: f64) -> u32 {
        let n = self.bar.scale_px();
        self.bar.low_tip_px + ((position * f64::from(n)) as u32).min(n - 1)
    }

    /// Returns a rectangle of `length` along and `depth` across the bar.
    fn rect(&self, along: u32, length: u32, across: u32, depth: u32) -> Rect {
        let (x, y, width, height) = match self.bar.direction {
            Direction::Up => (across, self.bar.length_px - along - length, depth, length),
            Direction::Right => (along, across, length, depth),
        };
        Rect {
            x: self.x + x,
            y: self.y + y,
            width,
            height,
        }
    }

    /// Converts to a point in the picture.
    fn point(&self, along: f32, across: f32) -> [f32; 2] {
        let (x, y) = (self.x as f32, self.y as f32);
        match self.bar.direction {
            Direction::Up => [x + across, y + self.bar.length_px as f32 - along],
            Direction::Right => [x + along, y + across],
        }
    }
}
