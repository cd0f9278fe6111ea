//! A surface to draw on: the shapes and colors of all charts and plots.

use image::Rgb;

use super::text::Style;

/// Background, per channel.
pub const PAPER: u8 = 255;
/// Titles and tick labels.
pub const INK: Rgb<u8> = Rgb([26; 3]);
/// Subtitle and footer.
pub const GRAY_INK: Rgb<u8> = Rgb([88; 3]);
/// Frames, axes and ticks.
pub const LINE: Rgb<u8> = Rgb([64; 3]);

/// Returns a color on paper that lets this share of the paper's light through.
pub fn faded(color: Rgb<u8>, share: f32) -> Rgb<u8> {
    Rgb(color.0.map(|ink| mixed(ink, PAPER, share)))
}

/// Returns a channel's value from `old` to `new`, which `share` from 0 to 1 approaches.
pub fn mixed(old: u8, new: u8, share: f32) -> u8 {
    (f32::from(old) + share * (f32::from(new) - f32::from(old))).round() as u8
}

/// Distance between lines of the same text, in its font size.
pub const LINE_EM: f32 = 1.25;

/// Rounds to whole pixels.
pub fn px(length: f32) -> f32 {
    length.round()
}

/// Returns the thickness of frames and ticks for text of `em_px`.
pub fn line_px(em_px: f32) -> f32 {
    px(em_px / 16.0).max(1.0)
}

/// x to the right and y down, in pixels from the upper left corner of the first one.
pub type PixelPosition = [f32; 2];

/// A rectangle in pixels; `x` and `y` are its upper left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// The left edge.
    pub x: f32,
    /// The upper edge.
    pub y: f32,
    /// Number of columns.
    pub width: f32,
    /// Number of rows.
    pub height: f32,
}

impl Rect {
    /// Returns the rectangle with its upper left corner at `x` and `y`.
    pub fn at([x, y]: PixelPosition, [width, height]: [f32; 2]) -> Self {
        Self {
            x,
            y,
            width,
            height,
        }
    }

    /// Returns the rectangle between two opposite corners.
    pub fn between([a_x, a_y]: PixelPosition, [b_x, b_y]: PixelPosition) -> Self {
        let size = [(a_x - b_x).abs(), (a_y - b_y).abs()];
        Self::at([a_x.min(b_x), a_y.min(b_y)], size)
    }

    /// Returns the square around a position.
    pub fn around(center: PixelPosition, radius: f32) -> Self {
        Self::between(center, center).grown(radius)
    }

    /// Returns the right edge.
    pub fn right(&self) -> f32 {
        self.x + self.width
    }

    /// Returns the lower edge.
    pub fn bottom(&self) -> f32 {
        self.y + self.height
    }

    /// Adds a border of `border_px` on each side.
    pub fn grown(&self, border_px: f32) -> Self {
        let size = [self.width, self.height].map(|side| side + 2.0 * border_px);
        Self::at([self.x - border_px, self.y - border_px], size)
    }

    /// Returns the area in both rectangles.
    pub fn overlap(&self, other: &Self) -> f32 {
        let width = self.right().min(other.right()) - self.x.max(other.x);
        let height = self.bottom().min(other.bottom()) - self.y.max(other.y);
        width.max(0.0) * height.max(0.0)
    }
}

/// The part of a line of text that is at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its first letter.
    Start,
    /// Its middle.
    Middle,
    /// Its last letter.
    End,
}

/// A picture that is being drawn, in pixels or as SVG. Shapes have smooth edges and may extend
/// beyond the picture.
pub trait DrawingSurface {
    /// Fills a rectangle.
    fn rect(&mut self, rect: Rect, color: Rgb<u8>);

    /// Draws a line through these points, which is `width` pixels wide.
    fn line(&mut self, points: &[PixelPosition], width: f32, color: Rgb<u8>);

    /// Draws the outline of a circle, which extends half of `width` to both sides of it.
    fn ring(&mut self, center: PixelPosition, radius: f32, width: f32, color: Rgb<u8>);

    /// Fills a triangle.
    fn triangle(&mut self, corners: [PixelPosition; 3], color: Rgb<u8>);

    /// Draws a line of text with a part of its baseline at `at`.
    fn text(&mut self, text: &str, at: PixelPosition, anchor: Anchor, style: &Style);

    /// Draws lines of text below each other, the first with a part of its baseline at `at`.
    fn lines(&mut self, lines: &[String], [x, y]: PixelPosition, anchor: Anchor, style: &Style) {
        for (i, line) in lines.iter().enumerate() {
            let down = px(i as f32 * LINE_EM * style.em_px);
            self.text(line, [x, y + down], anchor, style);
        }
    }

    /// Fills a circle.
    fn disk(&mut self, center: PixelPosition, radius: f32, color: Rgb<u8>) {
        self.ring(center, radius / 2.0, radius, color);
    }
}
