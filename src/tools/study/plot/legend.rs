//! The legend on the right of a plot.

use super::ceilings::visible_limit;
use super::figure::{Figure, Series};
use super::plane::SIZE;
use super::symbols::{WIDTH_FACTOR, draw_bar, draw_interval, draw_ring, draw_symbol};
use output::chart::{DrawingSurface, INK, LegendEntries, Rect, Style};

/// Font size in pixels.
const EM_PX: f32 = 13.5;
/// Distance from the legend to the right border of the picture.
const MARGIN: f32 = 10.0;
/// Distance from the top of the picture to the first entry in pixels.
const TOP: f32 = 72.0;
/// Maximum width of a line of text in pixels.
const MAX_TEXT_WIDTH: f32 = 215.0;
/// Maximum number of lines of a label.
const MAX_LINES: usize = 8;

/// The symbol before an entry.
pub(super) enum LegendSymbol {
    /// The symbol of the series with this index.
    Series(usize),
    /// The bar of a limit or a law.
    Bar,
    /// The interval of a point.
    Interval,
    /// The ring of an oversubscribed point.
    Ring,
}

/// Returns the entries for a figure; none for a single series without a law.
pub(super) fn entries(figure: &Figure) -> LegendEntries<LegendSymbol> {
    let mut entries = LegendEntries::new(EM_PX);
    for (number, series) in figure.series.iter().enumerate() {
        let lines = lines_of(series);
        if !lines.is_empty() {
            entries.push(LegendSymbol::Series(number), lines);
        }
    }
    let has_limits = figure
        .points()
        .any(|point| visible_limit(figure, point).is_some());
    let has_laws = figure.series.iter().any(|series| series.law.is_some());
    let has_rings = figure.points().any(|point| point.oversubscribed);
    let has_ranges = figure
        .points()
        .any(|point| point.is_range && point.interval[0] < point.interval[1]);
    let limits = ["if all its time were", "waiting for memory"];
    let laws = ["a + b x^k, with the", "interval of 95 % of k"];
    let rings = ["more threads than", "processors: not fitted"];
    let ranges = ["the range of fewer", "than six runs"];
    let notes = [
        (has_limits, LegendSymbol::Bar, limits),
        (has_laws, LegendSymbol::Bar, laws),
        (has_rings, LegendSymbol::Ring, rings),
        (has_ranges, LegendSymbol::Interval, ranges),
    ];
    for (_, symbol, lines) in notes.into_iter().filter(|(is_needed, ..)| *is_needed) {
        entries.push(symbol, lines.map(str::to_owned).into());
    }
    entries
}

/// Returns the left end of a legend in the picture.
pub(super) fn left(entries: &LegendEntries<LegendSymbol>) -> f32 {
    let [width, _] = entries.size();
    let margin = if width > 0.0 { MARGIN } else { 0.0 };
    SIZE[0] as f32 - (WIDTH_FACTOR * width).ceil() - margin
}

/// Draws a legend on the right of the picture.
pub(super) fn draw(entries: &LegendEntries<LegendSymbol>, surface: &mut dyn DrawingSurface) {
    let draw_key = |surface: &mut dyn DrawingSurface, symbol: &LegendSymbol, square: Rect| {
        let at = [
            square.x + square.width / 2.0,
            square.y + square.height / 2.0,
        ]
        .map(f32::round);
        match symbol {
            LegendSymbol::Series(number) => draw_symbol(surface, *number, at),
            LegendSymbol::Bar => draw_bar(surface, at, 8.0, INK),
            LegendSymbol::Ring => draw_ring(surface, at),
            LegendSymbol::Interval => {
                draw_interval(surface, [-6.0, 6.0].map(|dy| [at[0], at[1] + dy]), INK);
            }
        }
    };
    entries.draw(surface, [left(entries), TOP], draw_key);
}

/// Returns the label of a series, wrapped where it is too wide, then the exponent of its law.
fn lines_of(series: &Series) -> Vec<String> {
    let mut lines = Vec::new();
    if !series.label.is_empty() {
        lines = Style::new(EM_PX, INK).wrapped(&series.label, MAX_TEXT_WIDTH, MAX_LINES);
    }
    if let Some(law) = series.law {
        let interval = law.exponent_95.map_or(String::new(), |[low, high]| {
            format!(" [{low:.2}, {high:.2}]")
        });
        lines.push(format!("k = {:.3}{interval}", law.growing.exponent));
    }
    lines
}
