//! Colors, symbols and text of plots.

use image::Rgb;

use output::chart::{Anchor, DrawingSurface, INK, PixelPosition, Style};

/// Distance in pixels from a plot to the border of its picture.
pub(super) const MARGIN: f32 = 16.0;
/// Safety factor of text widths: a browser may replace the font by a wider one.
pub(super) const WIDTH_FACTOR: f32 = 1.2;
/// Radius in pixels of the ring around an oversubscribed point.
const RING_RADIUS: f32 = 10.0;

/// Colors that readers with color blindness can distinguish: Okabe and Ito, "Color Universal
/// Design", 2008, without yellow, which is too light for lines.
const COLORS: [[u8; 3]; 7] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [86, 180, 233],
    [230, 159, 0],
    [0, 0, 0],
];

/// Returns the color of the series with this index.
pub(super) fn color_of(number: usize) -> Rgb<u8> {
    Rgb(COLORS[number % COLORS.len()])
}

/// Returns an upper estimate of the width in pixels of a text with this font size.
pub(super) fn text_width(text: &str, em_px: f32) -> f32 {
    (Style::new(em_px, INK).width(text) * WIDTH_FACTOR).ceil()
}

/// Draws a line of text to the right of `at`, which is at the middle of its height.
pub(super) fn draw_text(
    surface: &mut dyn DrawingSurface,
    text: &str,
    [x, y]: PixelPosition,
    em_px: f32,
) {
    let style = Style::new(em_px, INK);
    let at = [x, style.baseline_around(y).round()];
    surface.text(text, at, Anchor::Start, &style);
}

/// Draws the symbol of the series with this index; series differ in shape and color.
pub(super) fn draw_symbol(surface: &mut dyn DrawingSurface, number: usize, at: PixelPosition) {
    let (color, [x, y]) = (color_of(number), at);
    match number % 3 {
        0 => surface.disk(at, 5.0, color),
        1 => surface.triangle(
            [[x, y - 7.0], [x - 6.0, y + 3.5], [x + 6.0, y + 3.5]],
            color,
        ),
        _ => {
            for rise in [-5.0, 5.0] {
                let ends = [[x - 5.0, y - rise], [x + 5.0, y + rise]];
                surface.line(&ends, 2.0, color);
            }
        }
    }
}

/// Draws the ring that marks an oversubscribed point.
pub(super) fn draw_ring(surface: &mut dyn DrawingSurface, at: PixelPosition) {
    surface.ring(at, RING_RADIUS, 1.0, INK);
}

/// Draws the line between the ends of an interval, with a bar at each.
pub(super) fn draw_interval(
    surface: &mut dyn DrawingSurface,
    ends: [PixelPosition; 2],
    color: Rgb<u8>,
) {
    surface.line(&ends, 2.0, color);
    for end in ends {
        draw_bar(surface, end, 5.0, color);
    }
}

/// Draws a bar across `at`, which extends horizontally by `reach` pixels to both sides.
pub(super) fn draw_bar(
    surface: &mut dyn DrawingSurface,
    [x, y]: PixelPosition,
    reach: f32,
    color: Rgb<u8>,
) {
    surface.line(&[[x - reach, y], [x + reach, y]], 2.0, color);
}
