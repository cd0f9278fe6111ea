//! Draws elements of SVG.

use image::Rgb;
use quick_xml::escape::escape;

use super::surface::{Anchor, DrawingSurface, PixelPosition, Rect};
use super::text::Style;
use host::text::one_line;

/// A picture as SVG, on transparent ground.
#[derive(Debug)]
pub struct SvgPicture(String);

impl SvgPicture {
    /// Starts a picture of this width and height.
    pub fn new([width, height]: [u32; 2]) -> Self {
        Self(format!(
            "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             xmlns=\"http://www.w3.org/2000/svg\">\n"
        ))
    }

    /// Returns the text of the file.
    pub fn finish(self) -> String {
        self.0 + "</svg>\n"
    }
}

impl DrawingSurface for SvgPicture {
    fn rect(&mut self, rect: Rect, color: Rgb<u8>) {
        let [x, y] = [rect.x, rect.y].map(short);
        let [width, height] = [rect.width, rect.height].map(short);
        let fill = hex(color);
        self.0 += &format!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{fill}\"/>\n"
        );
    }

    fn line(&mut self, points: &[PixelPosition], width: f32, color: Rgb<u8>) {
        let (points, stroke) = (joined(points), hex(color));
        self.0 += &format!(
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{stroke}\" \
             stroke-width=\"{width}\"/>\n"
        );
    }

    fn ring(&mut self, center: PixelPosition, radius: f32, width: f32, color: Rgb<u8>) {
        let ([x, y], stroke) = (center.map(short), hex(color));
        self.0 += &format!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"none\" stroke=\"{stroke}\" \
             stroke-width=\"{width}\"/>\n"
        );
    }

    fn triangle(&mut self, corners: [PixelPosition; 3], color: Rgb<u8>) {
        let (points, fill) = (joined(&corners), hex(color));
        self.0 += &format!("<polygon points=\"{points}\" fill=\"{fill}\"/>\n");
    }

    fn text(&mut self, text: &str, at: PixelPosition, anchor: Anchor, style: &Style) {
        if text.is_empty() {
            return;
        }
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let [x, y] = at.map(short);
        let turn = if style.is_turned {
            format!(" transform=\"rotate(-90, {x}, {y})\"")
        } else {
            String::new()
        };
        // XML has no control characters.
        let text = one_line(text);
        let (size, fill, text) = (style.em_px, hex(style.color), escape(&*text));
        self.0 += &format!(
            "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" font-family=\"sans-serif\" \
             font-size=\"{size}\" fill=\"{fill}\"{turn}>{text}</text>\n"
        );
    }
}

fn hex(Rgb([red, green, blue]): Rgb<u8>) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// Rounds to tenths of a pixel, which need few digits.
fn short(length: f32) -> f32 {
    (10.0 * length).round() / 10.0
}

fn joined(points: &[PixelPosition]) -> String {
    let pairs = points.iter().map(|point| {
        let [x, y] = point.map(short);
        format!("{x},{y}")
    });
    pairs.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::super::surface::INK;
    use super::*;

    #[test]
    fn text_of_any_characters_is_xml() {
        let mut picture = SvgPicture::new([9, 9]);
        let style = Style::new(9.0, INK);
        picture.text("a\u{1b}[31m <\u{ffff}>", [1.0, 2.0], Anchor::Start, &style);
        let svg = picture.finish();
        assert!(
            svg.contains(">a\\u{1b}[31m &lt;\\u{ffff}&gt;</text>"),
            "{svg}"
        );
    }
}
