//! The legend on the right of a plot.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::ceilings::visible_limit;
use super::figure::{Figure, Series};
use super::symbols::{Drawn, draw_ring, draw_symbol, draw_text, text_width};

const TEXT_SIZE: i32 = 16;
const LINE_HEIGHT: i32 = 18;
/// Distance between entries in pixels.
const GAP: i32 = 10;
/// Distance from the top of the picture to the first entry in pixels.
const TOP: i32 = 72;
/// Left end of the text in pixels, right of the symbols.
const TEXT_LEFT: i32 = 26;
/// Maximum width of a line of text in pixels.
const MAX_TEXT_WIDTH: i32 = 260;

/// The entries of the legend.
pub(super) struct Legend {
    /// Symbol and lines of text, from top to bottom.
    entries: Vec<(LegendSymbol, Vec<String>)>,
    /// In pixels.
    width: u32,
}

/// The symbol before an entry.
enum LegendSymbol {
    /// The symbol of the series with this index.
    Series(usize),
    /// The bar of a limit or a law.
    Bar,
    /// The ring of an oversubscribed point.
    Ring,
}

impl Legend {
    /// Creates the legend of a figure; empty for a single series without a law.
    pub(super) fn of<DB: DrawingBackend>(figure: &Figure, area: &DrawingArea<DB, Shift>) -> Self {
        let named = figure.series.iter().map(entry_of);
        let named = named.enumerate().filter(|(_, name)| !name.is_empty());
        let mut entries: Vec<(LegendSymbol, Vec<String>)> = named
            .map(|(number, name)| (LegendSymbol::Series(number), wrapped(area, &name)))
            .collect();
        let mut note = |is_needed: bool, key: LegendSymbol, lines: [&str; 2]| {
            if is_needed {
                entries.push((key, lines.map(str::to_owned).into()));
            }
        };
        let has_limits = figure
            .points()
            .any(|point| visible_limit(figure, point).is_some());
        let has_laws = figure.series.iter().any(|series| series.law.is_some());
        let has_rings = figure.points().any(|point| point.oversubscribed);
        note(
            has_limits,
            LegendSymbol::Bar,
            ["if all its time were", "waiting for memory"],
        );
        note(
            has_laws,
            LegendSymbol::Bar,
            ["a + b x^k, with the", "interval of 95 % of k"],
        );
        note(
            has_rings,
            LegendSymbol::Ring,
            ["more threads than", "processors: not fitted"],
        );
        let all = entries.iter().flat_map(|(_, lines)| lines);
        let widest = all.map(|line| text_width(area, line, TEXT_SIZE)).max();
        let width = widest.map_or(0, |width| (TEXT_LEFT + width + GAP) as u32);
        Self { entries, width }
    }

    /// Returns the width in pixels; 0 if empty.
    pub(super) fn width(&self) -> u32 {
        self.width
    }

    /// Draws the legend in `area`, which is as wide as the legend.
    pub(super) fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let mut top = TOP;
        for (key, lines) in &self.entries {
            let middle = top + LINE_HEIGHT / 2;
            match key {
                LegendSymbol::Series(number) => draw_symbol(area, *number, (10, middle))?,
                LegendSymbol::Bar => {
                    let ends = [(2, middle), (18, middle)];
                    area.draw(&PathElement::new(ends, BLACK.stroke_width(2)))?;
                }
                LegendSymbol::Ring => draw_ring(area, (10, middle))?,
            }
            for line in lines {
                draw_text(area, line, (TEXT_LEFT, top), TEXT_SIZE, HPos::Left)?;
                top += LINE_HEIGHT;
            }
            top += GAP;
        }
        Ok(())
    }
}

/// Returns the label of a series with the exponent of its law.
fn entry_of(series: &Series) -> String {
    let law = series.law.map(|law| {
        let interval = law.exponent_95.map_or(String::new(), |[low, high]| {
            format!(" [{low:.2}, {high:.2}]")
        });
        format!("k = {:.3}{interval}", law.growing.exponent)
    });
    let label = Some(series.label.clone()).filter(|label| !label.is_empty());
    label.into_iter().chain(law).collect::<Vec<_>>().join(": ")
}

/// Returns an entry as lines: the label, wrapped where it is too wide, then the law.
fn wrapped<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, entry: &str) -> Vec<String> {
    let mut lines = Vec::new();
    for part in entry.split(": ") {
        let mut line = String::new();
        for word in part.split_inclusive(' ') {
            let longer = format!("{line}{word}");
            if line.is_empty() || text_width(area, &longer, TEXT_SIZE) <= MAX_TEXT_WIDTH {
                line = longer;
            } else {
                lines.push(std::mem::replace(&mut line, word.to_owned()));
            }
        }
        lines.push(line);
    }
    lines
}
