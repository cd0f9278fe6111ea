//! One line of text on a picture.

use ab_glyph::{Font, FontRef, Glyph, PxScaleFont, ScaleFont, point};
use image::Rgb;

/// Height of digits and capitals as a fraction of the font size.
pub const CAP_HEIGHT_EM: f32 = 0.69;

/// A font size with a color.
#[derive(Debug, Clone)]
pub struct Style {
    font: PxScaleFont<FontRef<'static>>,
    /// Font size in pixels.
    pub em_px: f32,
    /// Color of the text.
    pub color: Rgb<u8>,
    /// True if the text runs upward.
    pub is_turned: bool,
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
            em_px,
            color,
            is_turned: false,
        }
    }

    /// Returns the style for text that runs upward.
    pub fn turned(self) -> Self {
        Self {
            is_turned: true,
            ..self
        }
    }

    /// Returns the baseline of text whose capitals are centered at `y`.
    pub fn baseline_around(&self, y: f32) -> f32 {
        y + CAP_HEIGHT_EM * self.em_px / 2.0
    }

    /// Returns the width of `line` in pixels.
    pub fn width(&self, line: &str) -> f32 {
        self.place(line).1
    }

    /// Returns `line`, truncated with an ellipsis if it is wider than `max_px`.
    pub fn fitted(&self, line: &str, max_px: f32) -> String {
        let (glyphs, width) = self.place(line);
        if width <= max_px {
            return line.to_owned();
        }
        let room = max_px - self.width("…");
        let end = |glyph: &Glyph| glyph.position.x + self.font.h_advance(glyph.id);
        let n_fitting = glyphs.iter().take_while(|glyph| end(glyph) <= room).count();
        let beginning: String = line.chars().take(n_fitting).collect();
        format!("{}…", beginning.trim_end())
    }

    /// Returns `text` in lines of at most `max_px`, broken between words; the last of
    /// `max_lines` is truncated with an ellipsis if more would follow.
    pub fn wrapped(&self, text: &str, max_px: f32, max_lines: usize) -> Vec<String> {
        let mut lines = Vec::new();
        let mut rest = text;
        while lines.len() + 1 < max_lines && self.width(rest) > max_px {
            let breaks = rest.match_indices(' ').map(|(at, _)| at);
            let fits = |at: &usize| self.width(&rest[..*at]) <= max_px;
            let Some(end) = breaks.take_while(fits).filter(|&at| at > 0).last() else {
                break;
            };
            lines.push(rest[..end].trim_end().to_owned());
            rest = rest[end..].trim_start();
        }
        lines.push(self.fitted(rest, max_px));
        lines
    }

    /// Calls `paint` for each pixel of `line` with its column and row, from the start of the
    /// baseline, and its coverage.
    pub(super) fn rasterize(&self, line: &str, mut paint: impl FnMut([i64; 2], f32)) {
        for glyph in self.place(line).0 {
            let Some(outline) = self.font.outline_glyph(glyph) else {
                continue;
            };
            let corner = outline.px_bounds().min;
            outline.draw(|x, y, coverage| {
                let [x, y] = [
                    corner.x as i64 + i64::from(x),
                    corner.y as i64 + i64::from(y),
                ];
                let at = if self.is_turned { [y, -x - 1] } else { [x, y] };
                // The light font looks pale at small sizes; this thickens its strokes slightly.
                paint(at, coverage.min(1.0).powf(0.8));
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

    const INK: Rgb<u8> = Rgb([0; 3]);

    #[test]
    fn too_long_a_line_ends_in_an_ellipsis_within_the_width() {
        let style = Style::new(14.0, INK);
        let line = "über-Szene ä: time per pixel";
        let width = style.width(line).ceil();
        assert_eq!(style.fitted(line, width), line);
        for max_px in [20.0, 50.0, 100.0, width - 1.0] {
            let fitted = style.fitted(line, max_px);
            assert!(fitted.ends_with('…') && line.starts_with(fitted.trim_end_matches('…')));
            assert!(style.width(&fitted) <= max_px, "{fitted}");
            assert!(style.width(&fitted) > max_px - 20.0, "{fitted}");
        }
    }

    #[test]
    fn long_text_is_broken_between_words() {
        let style = Style::new(14.0, INK);
        let text = "a title with more words than a line has room for";
        let lines = style.wrapped(text, 150.0, 3);
        assert_eq!(lines.join(" "), text);
        assert!(lines.len() > 1 && lines.iter().all(|line| style.width(line) <= 150.0));
        let cut = style.wrapped(text, 60.0, 3);
        assert!(cut.len() == 3 && cut[2].ends_with('…'), "{cut:?}");
        assert_eq!(style.wrapped("", 60.0, 3), [""]);
        assert_eq!(style.wrapped("unbreakable", 20.0, 3).len(), 1);
    }

    #[test]
    fn glyphs_stay_within_the_width_and_above_the_baseline() {
        let style = Style::new(40.0, INK);
        let (mut columns, mut rows) = (Vec::new(), Vec::new());
        style.rasterize("HEX", |[column, row], coverage| {
            if coverage > 0.5 {
                columns.push(column);
                rows.push(row);
            }
        });
        columns.sort_unstable();
        rows.sort_unstable();
        let last = rows.len() - 1;
        assert!(columns[0] >= 0 && columns[last] as f32 <= style.width("HEX"));
        assert_eq!(rows[last], -1);
        let height = (rows[last] - rows[0] + 1) as f32;
        assert!((height - 40.0 * CAP_HEIGHT_EM).abs() <= 1.0, "{height}");
    }
}
