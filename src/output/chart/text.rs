//! One line of text on a picture.

use ab_glyph::{Font, FontRef, Glyph, PxScaleFont, ScaleFont, point};
use image::{Rgb, RgbImage};

use super::canvas;

/// Height of digits and capitals as a fraction of the font size.
pub const CAP_HEIGHT_EM: f32 = 0.69;

/// A font size with a color.
pub struct Style {
    font: PxScaleFont<FontRef<'static>>,
    color: Rgb<u8>,
}

impl Style {
    /// Creates a style with a font size of `em_px` pixels.
    pub fn new(em_px: f32, color: Rgb<u8>) -> Self {
        let font = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT)
            .expect("a font compiled into the program can be read");
        let em_units = font.units_per_em().unwrap_or(font.height_unscaled());
        let line_px = em_px * font.height_unscaled() / em_units;
        Self {
            font: font.into_scaled(line_px),
            color,
        }
    }

    /// Returns the width of `line` in pixels.
    pub fn width(&self, line: &str) -> f32 {
        self.place(line).1
    }

    /// Returns `line`, truncated with an ellipsis if it is wider than `max_px`.
    pub fn fitted(&self, line: &str, max_px: u32) -> String {
        let (glyphs, width) = self.place(line);
        if width <= max_px as f32 {
            return line.to_owned();
        }
        let room = max_px as f32 - self.width("…");
        let end = |glyph: &Glyph| glyph.position.x + self.font.h_advance(glyph.id);
        let n_fitting = glyphs.iter().take_while(|glyph| end(glyph) <= room).count();
        let beginning: String = line.chars().take(n_fitting).collect();
        format!("{}…", beginning.trim_end())
    }

    /// Returns `text` in lines of at most `max_px`, broken between words; the last of
    /// `max_lines` is truncated with an ellipsis if more would follow.
    pub fn wrapped(&self, text: &str, max_px: u32, max_lines: usize) -> Vec<String> {
        let mut lines = Vec::new();
        let mut rest = text;
        while lines.len() + 1 < max_lines && self.width(rest) > max_px as f32 {
            let breaks = rest.match_indices(' ').map(|(at, _)| at);
            let fits = |at: &usize| self.width(&rest[..*at]) <= max_px as f32;
            let Some(end) = breaks.take_while(fits).filter(|&at| at > 0).last() else {
                break;
            };
            lines.push(rest[..end].trim_end().to_owned());
            rest = rest[end..].trim_start();
        }
        lines.push(self.fitted(rest, max_px));
        lines
    }

    /// Paints `line` from column `left` with its baseline at the lower edge of row `baseline`.
    pub fn paint(&self, picture: &mut RgbImage, line: &str, left: u32, baseline: u32) {
        for glyph in self.place(line).0 {
            let Some(outline) = self.font.outline_glyph(glyph) else {
                continue;
            };
            let corner = outline.px_bounds().min;
            outline.draw(|x, y, coverage| {
                let x = i64::from(left) + corner.x as i64 + i64::from(x);
                let y = i64::from(baseline) + corner.y as i64 + i64::from(y);
                // The light font looks pale at small sizes; this thickens its strokes slightly.
                let coverage = coverage.min(1.0).powf(0.8);
                canvas::blend(picture, x, y, self.color, coverage);
            });
        }
    }

    /// Lays out `line` with kerning from x = 0 on a baseline at y = 0; returns its glyphs and width.
    fn place(&self, line: &str) -> (Vec<Glyph>, f32) {
        let mut x = 0.0;
        let mut glyphs: Vec<Glyph> = Vec::new();
        for c in line.chars() {
            let mut glyph = self.font.scaled_glyph(c);
            if let Some(previous) = glyphs.last() {
                x += self.font.kern(previous.id, glyph.id);
            }
            glyph.position = point(x, 0.0);
            x += self.font.h_advance(glyph.id);
            glyphs.push(glyph);
        }
        (glyphs, x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_long_a_line_ends_in_an_ellipsis_within_the_width() {
        let style = Style::new(14.0, canvas::INK);
        let line = "über-Szene ä: time per pixel";
        let width = style.width(line).ceil() as u32;
        assert_eq!(style.fitted(line, width), line);
        for max_px in [20, 50, 100, width - 1] {
            let fitted = style.fitted(line, max_px);
            assert!(fitted.ends_with('…') && line.starts_with(fitted.trim_end_matches('…')));
            assert!(style.width(&fitted) <= max_px as f32, "{fitted}");
            assert!(style.width(&fitted) > max_px as f32 - 20.0, "{fitted}");
        }
    }

    #[test]
    fn long_text_is_broken_between_words() {
        let style = Style::new(14.0, canvas::INK);
        let text = "a title with more words than a line has room for";
        let lines = style.wrapped(text, 150, 3);
        assert_eq!(lines.join(" "), text);
        assert!(lines.len() > 1 && lines.iter().all(|line| style.width(line) <= 150.0));
        let cut = style.wrapped(text, 60, 3);
        assert!(cut.len() == 3 && cut[2].ends_with('…'), "{cut:?}");
        assert_eq!(style.wrapped("", 60, 3), [""]);
        assert_eq!(style.wrapped("unbreakable", 20, 3).len(), 1);
    }

    #[test]
    fn glyphs_stay_within_the_width_and_above_the_baseline() {
        let style = Style::new(40.0, canvas::INK);
        let mut picture = RgbImage::from_pixel(400, 100, Rgb([canvas::PAPER; 3]));
        style.paint(&mut picture, "HEX", 10, 60);
        let inked = |x: u32, y: u32| picture.get_pixel(x, y).0[0] < 128;
        let columns: Vec<u32> = (0..400)
            .filter(|&x| (0..100).any(|y| inked(x, y)))
            .collect();
        let rows: Vec<u32> = (0..100)
            .filter(|&y| (0..400).any(|x| inked(x, y)))
            .collect();
        assert!(columns[0] >= 10 && columns[columns.len() - 1] as f32 <= 10.0 + style.width("HEX"));
        assert_eq!(rows[rows.len() - 1], 59);
        assert!(
            (rows.len() as f32 - 40.0 * CAP_HEIGHT_EM).abs() <= 1.0,
            "{}",
            rows.len()
        );
    }
}
