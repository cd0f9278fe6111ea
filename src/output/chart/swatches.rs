//! The key to categories: a color swatch and a label for each.

use image::{Rgb, RgbImage};

use super::canvas::{self, Rect, px};
use super::text::{CAP_HEIGHT_EM, Style};

/// A category in a legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Swatch {
    /// The name of the category.
    pub label: String,
    /// Red, green and blue in sRGB.
    pub color: [u8; 3],
}

/// A list of categories, the first on top, without a position.
pub(super) struct Swatches {
    em_px: f32,
    rows: Vec<(Option<Rgb<u8>>, String)>,
}

// Distances in ems, the font size of the labels.
const PITCH_EM: f32 = 1.9;
const SIDE_EM: f32 = 1.4;
const GAP_EM: f32 = 0.6;

impl Swatches {
    /// Creates the list of these categories within this width and height in pixels; if not all fit,
    /// the last row counts the rest.
    pub(super) fn within(all: &[Swatch], [width, height]: [u32; 2], em_px: f32) -> Self {
        let style = Style::new(em_px, canvas::INK);
        let n_rows = (height as f32 / (PITCH_EM * em_px)) as usize;
        let n_shown = if all.len() <= n_rows {
            all.len()
        } else {
            n_rows.saturating_sub(1)
        };
        let room = width.saturating_sub(px((SIDE_EM + GAP_EM) * em_px));
        let shown = all.iter().take(n_shown);
        let mut rows: Vec<_> = shown
            .map(|swatch| (Some(Rgb(swatch.color)), style.fitted(&swatch.label, room)))
            .collect();
        if n_shown < all.len() {
            let others = format!("{} more", all.len() - n_shown);
            rows.push((None, style.fitted(&others, room)));
        }
        Self { em_px, rows }
    }

    /// Returns width and height in pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        let style = Style::new(self.em_px, canvas::INK);
        let widths = self.rows.iter().map(|(_, label)| style.width(label));
        let widest = widths.fold(0.0, f32::max).ceil() as u32;
        let height = px(self.rows.len() as f32 * PITCH_EM * self.em_px);
        [px((SIDE_EM + GAP_EM) * self.em_px) + widest, height]
    }

    /// Paints the list with its upper left corner at `corner`, x and y.
    pub(super) fn paint(&self, picture: &mut RgbImage, [x, y]: [u32; 2]) {
        let style = Style::new(self.em_px, canvas::INK);
        let side = px(SIDE_EM * self.em_px);
        for (i, (color, label)) in self.rows.iter().enumerate() {
            let top = y + px(i as f32 * PITCH_EM * self.em_px);
            let square = Rect {
                x,
                y: top,
                width: side,
                height: side,
            };
            if let Some(color) = color {
                let frame = square.grown(canvas::line_px(self.em_px));
                canvas::fill_rect(picture, frame, canvas::LINE);
                canvas::fill_rect(picture, square, *color);
            }
            let left = x + px((SIDE_EM + GAP_EM) * self.em_px);
            let baseline = top + (side + px(CAP_HEIGHT_EM * self.em_px)) / 2;
            style.paint(picture, label, left, baseline);
        }
    }
}
