//! The entries of a legend below each other: a symbol and a text for each.

use super::surface::{Anchor, DrawingSurface, INK, LINE_EM, PixelPosition, Rect, px};
use super::text::Style;

/// Entries of a legend, without a position.
pub struct LegendEntries<S> {
    em_px: f32,
    /// Symbol and lines of text.
    entries: Vec<(S, Vec<String>)>,
}

// Distances in ems, the font size of the texts.
const SYMBOL_EM: f32 = 1.4;
const TEXT_LEFT_EM: f32 = 2.0;
/// Distance from the lowest line or symbol of an entry to the next entry.
const GAP_EM: f32 = 0.5;

impl<S> LegendEntries<S> {
    /// Creates an empty list with text of `em_px`.
    pub fn new(em_px: f32) -> Self {
        let entries = Vec::new();
        Self { em_px, entries }
    }

    /// Creates a list of single lines within this width and height in pixels; if not all fit, the
    /// last row counts the rest beside the symbol `other`.
    pub fn within(
        [width, height]: [f32; 2],
        em_px: f32,
        all: impl ExactSizeIterator<Item = (S, String)>,
        other: S,
    ) -> Self {
        let mut list = Self::new(em_px);
        let (style, room) = (list.style(), width - px(TEXT_LEFT_EM * em_px));
        let n_rows = (height / ((SYMBOL_EM + GAP_EM) * em_px)) as usize;
        let n_other = match all.len() {
            n if n <= n_rows => 0,
            n => n - n_rows.saturating_sub(1),
        };
        let n_shown = all.len() - n_other;
        let rest = (n_other > 0).then(|| (other, format!("{n_other} more")));
        for (symbol, text) in all.take(n_shown).chain(rest) {
            list.push(symbol, vec![style.fitted(&text, room)]);
        }
        list
    }

    /// Adds an entry with these lines of text.
    pub fn push(&mut self, symbol: S, lines: Vec<String>) {
        self.entries.push((symbol, lines));
    }

    /// Returns the style of the texts.
    pub fn style(&self) -> Style {
        Style::new(self.em_px, INK)
    }

    /// Returns width and height in pixels; 0 if empty.
    pub fn size(&self) -> [f32; 2] {
        let style = self.style();
        let lines = self.entries.iter().flat_map(|(_, lines)| lines);
        let widest = lines.map(|line| style.width(line).ceil()).reduce(f32::max);
        let heights = self.entries.iter().map(|(_, lines)| height_em(lines));
        [
            widest.map_or(0.0, |width| px(TEXT_LEFT_EM * self.em_px) + width),
            px(heights.sum::<f32>() * self.em_px),
        ]
    }

    /// Draws the list with its upper left corner at `corner`; `draw_symbol` draws a symbol in its
    /// square.
    pub fn draw(
        &self,
        surface: &mut dyn DrawingSurface,
        [x, y]: PixelPosition,
        draw_symbol: impl Fn(&mut dyn DrawingSurface, &S, Rect),
    ) {
        let (style, side) = (self.style(), px(SYMBOL_EM * self.em_px));
        let mut top_em = 0.0;
        for (symbol, lines) in &self.entries {
            let top = y + px(top_em * self.em_px);
            let square = Rect::at([x, top], [side, side]);
            draw_symbol(surface, symbol, square);
            let left = x + px(TEXT_LEFT_EM * self.em_px);
            let at = [left, px(style.baseline_around(top + side / 2.0))];
            surface.lines(lines, at, Anchor::Start, &style);
            top_em += height_em(lines);
        }
    }
}

/// Returns the distance from an entry to the next one in ems.
fn height_em(lines: &[String]) -> f32 {
    SYMBOL_EM + LINE_EM * (lines.len() as f32 - 1.0) + GAP_EM
}
