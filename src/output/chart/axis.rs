//! An axis with ticks and labels along an edge of a rectangle.

use super::surface::{Anchor, DrawingSurface, INK, LINE, Rect, faded, line_px, px};
use super::text::{CAP_HEIGHT_EM, Style};
use super::ticks::{Scale, Ticks};

/// An edge of a rectangle, with ticks and labels outside of it. Values increase to the right and
/// upward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisEdge {
    /// The left edge.
    Left,
    /// The right edge.
    Right,
    /// The lower edge.
    Bottom,
}

/// A scale between two values, with ticks and labels.
#[derive(Clone, Debug)]
pub struct LabeledAxis {
    /// The scale.
    pub scale: Scale,
    /// The values at the low and at the high end.
    pub ends: [f64; 2],
    /// The ticks; labels belong to the major ones.
    pub ticks: Ticks,
    labels: Vec<String>,
}

// Distances in ems, the font size of the labels.
const TICK_EM: f32 = 0.45;
const MINOR_TICK_EM: f32 = 0.25;
const LABEL_EM: f32 = 0.8;

impl LabeledAxis {
    /// Creates an axis with these ticks.
    pub fn new(scale: Scale, ends: [f64; 2], ticks: Ticks, label: impl Fn(f64) -> String) -> Self {
        let labels = ticks.major.iter().map(|value| label(*value)).collect();
        Self {
            scale,
            ends,
            ticks,
            labels,
        }
    }

    /// Returns the position of a value from the low (0) to the high (1) end.
    pub fn position(&self, value: f64) -> f32 {
        self.scale.position(value, self.ends) as f32
    }

    /// Returns the distance in pixels from an edge to the outer end of labels of `em_px`.
    pub fn depth(&self, edge: AxisEdge, em_px: f32) -> f32 {
        let style = Style::new(em_px, INK);
        let widths = self.labels.iter().map(|label| style.width(label));
        let outer = match edge {
            AxisEdge::Bottom => px(CAP_HEIGHT_EM * em_px),
            AxisEdge::Left | AxisEdge::Right => widths.fold(0.0, f32::max).ceil(),
        };
        px(LABEL_EM * em_px) + outer
    }

    /// Draws ticks and labels of `em_px` along an edge of `rect`. Labels below it extend beyond its
    /// ends by at most their font size.
    pub fn draw(&self, surface: &mut dyn DrawingSurface, rect: Rect, edge: AxisEdge, em_px: f32) {
        let (style, line) = (Style::new(em_px, INK), line_px(em_px));
        let Ticks { major, minor } = &self.ticks;
        for (values, size_em) in [(minor, MINOR_TICK_EM), (major, TICK_EM)] {
            for &value in values {
                let tick = self.line(value, rect, edge, line, px(size_em * em_px));
                surface.rect(tick, LINE);
            }
        }
        for (&value, label) in major.iter().zip(&self.labels) {
            let [x, y] = self.at(value, rect, edge);
            let beside = px(LABEL_EM * em_px);
            let (at, anchor) = match edge {
                AxisEdge::Bottom => {
                    let reach = style.width(label) / 2.0 - em_px;
                    let x = x.min(rect.right() - reach).max(rect.x + reach);
                    ([x, y + self.depth(edge, em_px)], Anchor::Middle)
                }
                AxisEdge::Left => ([x - beside, px(style.baseline_around(y))], Anchor::End),
                AxisEdge::Right => ([x + beside, px(style.baseline_around(y))], Anchor::Start),
            };
            surface.text(label, at, anchor, &style);
        }
    }

    /// Draws pale lines from the ticks of an edge across `rect`.
    pub fn draw_grid(&self, surface: &mut dyn DrawingSurface, rect: Rect, edge: AxisEdge) {
        let across = if edge == AxisEdge::Bottom {
            rect.height
        } else {
            rect.width
        };
        for (values, share) in [(&self.ticks.minor, 0.92), (&self.ticks.major, 0.75)] {
            for &value in values {
                let line = self.line(value, rect, edge, 1.0, -across);
                surface.rect(line, faded(LINE, share));
            }
        }
    }

    /// Returns the position of a value on an edge of `rect`.
    fn at(&self, value: f64, rect: Rect, edge: AxisEdge) -> [f32; 2] {
        let along = self.position(value);
        match edge {
            AxisEdge::Bottom => [rect.x + along * rect.width, rect.bottom()],
            AxisEdge::Left => [rect.x, rect.bottom() - along * rect.height],
            AxisEdge::Right => [rect.right(), rect.bottom() - along * rect.height],
        }
    }

    /// Returns a line from an edge outward, within the ends of the edge.
    fn line(&self, value: f64, rect: Rect, edge: AxisEdge, width: f32, length: f32) -> Rect {
        let [x, y] = self.at(value, rect, edge);
        let along = |center: f32, low, high| px(center - width / 2.0).min(high - width).max(low);
        if edge == AxisEdge::Bottom {
            let x = along(x, rect.x, rect.right());
            return Rect::between([x, y], [x + width, y + length]);
        }
        let y = along(y, rect.y, rect.bottom());
        let outward = if edge == AxisEdge::Left {
            -length
        } else {
            length
        };
        Rect::between([x, y], [x + outward, y + width])
    }
}
