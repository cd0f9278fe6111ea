//! Colors, symbols and text of plots.

use plotters::coord::Shift;
use plotters::element::{Circle, Cross, Text, TriangleMarker};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontStyle, register_font};

/// The font family of all text.
pub(super) const FONT: &str = "sans-serif";
/// Distance in pixels from a plot to the border of its picture.
pub(super) const MARGIN: i32 = 16;
/// Safety factor of text widths: a browser may replace the font by a wider one.
const WIDTH_FACTOR: f64 = 1.2;
/// Radius in pixels of the ring around an oversubscribed point.
const RING_RADIUS: i32 = 10;

/// The result of a drawing operation.
pub(super) type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

/// Colors that readers with color blindness can distinguish: Okabe and Ito, "Color Universal
/// Design", 2008, without yellow, which is too light for lines.
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(0, 0, 0),
];

/// Registers the font; call it before any text is measured or drawn.
pub(super) fn load_font() {
    // Fails only for an invalid font, and this one is embedded.
    let _ = register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
}

/// Returns the color of the series with this index.
pub(super) fn color_of(number: usize) -> RGBColor {
    COLORS[number % COLORS.len()]
}

/// Returns an upper estimate of the width of a text in pixels.
pub(super) fn text_width<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    text: &str,
    size: i32,
) -> i32 {
    let measured = area.estimate_text_size(text, &style(size, HPos::Left));
    measured.map_or(0, |(width, _)| {
        (f64::from(width) * WIDTH_FACTOR).ceil() as i32
    })
}

/// Draws a line of text whose top is at `at`, where `side` selects which end of the line lies
/// there.
pub(super) fn draw_text<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    text: &str,
    at: (i32, i32),
    size: i32,
    side: HPos,
) -> Drawn<DB> {
    area.draw(&Text::new(text.to_owned(), at, style(size, side)))
}

fn style(size: i32, side: HPos) -> TextStyle<'static> {
    TextStyle::from((FONT, size).into_font()).pos(Pos::new(side, VPos::Top))
}

/// Draws the symbol of the series with this index; series differ in shape and color.
pub(super) fn draw_symbol<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    number: usize,
    at: (i32, i32),
) -> Drawn<DB> {
    let color = color_of(number);
    match number % 3 {
        0 => area.draw(&Circle::new(at, 5, color.filled())),
        1 => area.draw(&TriangleMarker::new(at, 7, color.filled())),
        _ => area.draw(&Cross::new(at, 5, color.stroke_width(2))),
    }
}

/// Draws the ring that marks an oversubscribed point.
pub(super) fn draw_ring<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    at: (i32, i32),
) -> Drawn<DB> {
    area.draw(&Circle::new(at, RING_RADIUS, BLACK.stroke_width(1)))
}
