//! What the symbols of a plot mean, on its right.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::ceiling;
use super::figure::{Figure, Series};
use super::ink::{Drawn, draw_ring, draw_symbol, draw_text, text_width};

const TEXT_SIZE: i32 = 16;
const LINE_HEIGHT: i32 = 18;
/// Pixels between entries, and from the top to the first.
const GAP: i32 = 10;
const TOP: i32 = 72;
/// Where text begins, right of the symbols.
const TEXT_LEFT: i32 = 26;
/// Text that is wider is broken into lines, in pixels.
const MAX_TEXT_WIDTH: i32 = 260;

/// The entries from the top, and how wide they are.
pub(super) struct Legend {
    entries: Vec<(Key, Vec<String>)>,
    width: u32,
}

/// What stands before an entry.
enum Key {
    /// The symbol of the series with this number.
    Symbol(usize),
    /// The bar of a limit or a law.
    Bar,
    /// The ring of an oversubscribed point.
    Ring,
}

impl Legend {
    /// What a figure needs to be understood; nothing for an only series without
    /// a law.
    pub(super) fn of<DB: DrawingBackend>(figure: &Figure, area: &DrawingArea<DB, Shift>) -> Self {
        let named = figure.series.iter().map(name_of);
        let named = named.enumerate().filter(|(_, name)| !name.is_empty());
        let mut entries: Vec<(Key, Vec<String>)> = named
            .map(|(number, name)| (Key::Symbol(number), lines(area, &name)))
            .collect();
        let marks = || figure.series.iter().flat_map(|series| &series.points);
        let mut note = |is_needed: bool, key: Key, lines: [&str; 2]| {
            if is_needed {
                entries.push((key, lines.map(str::to_owned).into()));
            }
        };
        let has_limits = marks().any(|mark| ceiling::limit_of(figure, mark).is_some());
        let has_laws = figure.series.iter().any(|series| series.law.is_some());
        let has_rings = marks().any(|mark| mark.oversubscribed);
        note(
            has_limits,
            Key::Bar,
            ["if all its time were", "waiting for memory"],
        );
        note(
            has_laws,
            Key::Bar,
            ["a + b x^k, with the", "interval of 95 % of k"],
        );
        note(
            has_rings,
            Key::Ring,
            ["more threads than", "processors: not fitted"],
        );
        let all = entries.iter().flat_map(|(_, lines)| lines);
        let widest = all.map(|line| text_width(area, line, TEXT_SIZE)).max();
        let width = widest.map_or(0, |width| (TEXT_LEFT + width + GAP) as u32);
        Self { entries, width }
    }

    /// Width in pixels; 0 without entries.
    pub(super) fn width(&self) -> u32 {
        self.width
    }

    pub(super) fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let mut top = TOP;
        for (key, lines) in &self.entries {
            let middle = top + LINE_HEIGHT / 2;
            match key {
                Key::Symbol(number) => draw_symbol(area, *number, (10, middle))?,
                Key::Bar => {
                    let ends = [(2, middle), (18, middle)];
                    area.draw(&PathElement::new(ends, BLACK.stroke_width(2)))?;
                }
                Key::Ring => draw_ring(area, (10, middle))?,
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

/// The series' label and the exponent of its law.
fn name_of(series: &Series) -> String {
    let law = series.law.map(|law| {
        let interval = law.exponent_95.map_or(String::new(), |[low, high]| {
            format!(" [{low:.2}, {high:.2}]")
        });
        format!("k = {:.3}{interval}", law.growing.exponent)
    });
    let label = Some(series.label.clone()).filter(|label| !label.is_empty());
    label.into_iter().chain(law).collect::<Vec<_>>().join(": ")
}

/// A name in lines: the law in one of its own, and the label broken where it is
/// too wide.
fn lines<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, name: &str) -> Vec<String> {
    let mut lines = Vec::new();
    for part in name.split(": ") {
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
