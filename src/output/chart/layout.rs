//! The positions of all parts of the picture.
//!
//! ```text
//! title                          title
//! subtitle                       subtitle
//! +-------------+ +-+- 1 µs      +--------------------------------+
//! |     map     | |b|            |              map               |
//! |             | |a|            +--------------------------------+
//! +-------------+ +r+- 100 ns    +--------------bar---------------+
//! footer                           100 ns                    1 µs
//!                                footer
//! ```

use super::CostMap;
use super::bar::{Bar, Direction};
use super::canvas::{Rect, px};
use super::label::Unit;
use super::text::{CAP_HEIGHT_EM, Style};
use super::{canvas, footer};

/// Size of the title, in ems.
const TITLE_EM: f32 = 1.3;
/// Size of the footer, in ems.
const FOOTER_EM: f32 = 0.9;
/// Distance between lines of the same text, in its font size.
const LINE_EM: f32 = 1.25;
/// Maximum number of lines of a text; the last one is truncated.
const MAX_LINES: usize = 3;

/// Text in one or more lines.
pub struct Block {
    /// Font.
    pub style: Style,
    /// Lines, each with its baseline.
    pub lines: Vec<(String, u32)>,
}

impl Block {
    /// Breaks `text` into lines at most `width` wide, the first with this baseline.
    fn new(text: &str, style: Style, em_px: f32, width: u32, baseline: u32) -> Self {
        let lines = style.wrapped(text, width, MAX_LINES).into_iter();
        let baselines = (0..).map(|i: u32| baseline + px(i as f32 * LINE_EM * em_px));
        Self {
            lines: lines.zip(baselines).collect(),
            style,
        }
    }

    /// Returns the baseline of the last line.
    fn end(&self) -> u32 {
        self.lines.last().map_or(0, |(_, baseline)| *baseline)
    }
}

/// Positions and sizes in pixels of the picture.
pub struct Layout {
    /// Width of the picture.
    pub width: u32,
    /// Height of the picture.
    pub height: u32,
    /// Font size of tick labels and subtitle, and the unit of all distances.
    pub em_px: f32,
    /// Side of a value's square, in pixels.
    pub magnification: u32,
    /// The map, without its frame.
    pub map: Rect,
    /// The color bar.
    pub bar: Bar,
    /// Upper left corner of the color bar, without its frame.
    pub bar_corner: [u32; 2],
    /// Title, subtitle and footer.
    pub texts: [Block; 3],
}

/// Returns the smallest magnification that makes the longer side of the map long enough.
pub(super) fn magnification([width, height]: [u32; 2]) -> u32 {
    MIN_LONGER_SIDE_PX.div_ceil(width.max(height))
}

impl Layout {
    /// Computes the layout of `map`.
    pub fn of(map: &CostMap) -> Self {
        let magnification = magnification([map.width, map.height]);
        let [width, height] = [map.width * magnification, map.height * magnification];
        let em_px = (width.max(height) as f32 / 50.0).clamp(14.0, 160.0);
        let em = |n: f32| px(n * em_px);

        // Place the bar beside the map, which gives the width of the texts.
        let bar = Bar::beside([width, height], &map.range, Unit::named(map.unit), em_px);
        let [bar_width, bar_height] = bar.size();
        let map_and_bar = match bar.direction() {
            Direction::Up => width + em(BAR_GAP_EM) + bar_width,
            Direction::Right => bar_width,
        };
        let text_width = map_and_bar.max(em(MIN_TEXT_WIDTH_EM));
        let block = |text: &str, size_em: f32, color, baseline| {
            let size_px = size_em * em_px;
            Block::new(
                text,
                Style::new(size_px, color),
                size_px,
                text_width,
                baseline,
            )
        };

        // Stack title, subtitle, map, bar and footer from top to bottom.
        let first = em(MARGIN_EM) + em(TITLE_EM * CAP_HEIGHT_EM);
        let title = block(map.title, TITLE_EM, canvas::INK, first);
        let below = title.end() + if map.subtitle.is_empty() { 0 } else { em(1.7) };
        let subtitle = block(map.subtitle, 1.0, canvas::GRAY_INK, below);
        let at = Rect {
            x: em(MARGIN_EM),
            y: subtitle.end() + em(1.1),
            width,
            height,
        };
        let bar_corner = match bar.direction() {
            Direction::Up => [at.right() + em(BAR_GAP_EM), at.y],
            Direction::Right => [at.x, at.bottom() + em(1.0)],
        };
        let last = bar_corner[1] + bar_height + em(1.9);
        let footer = footer::line(map.unit, &map.range);
        let footer = block(&footer, FOOTER_EM, canvas::GRAY_INK, last);
        Self {
            width: text_width + 2 * em(MARGIN_EM),
            height: footer.end() + em(1.3),
            em_px,
            magnification,
            map: at,
            bar,
            bar_corner,
            texts: [title, subtitle, footer],
        }
    }
}

/// Smaller maps are magnified to at least this size.
const MIN_LONGER_SIDE_PX: u32 = 600;
const MARGIN_EM: f32 = 1.5;
/// Distance from the map to a vertical bar.
const BAR_GAP_EM: f32 = 1.2;
/// Minimum width of the title, even if the map is narrower.
const MIN_TEXT_WIDTH_EM: f32 = 30.0;

#[cfg(test)]
mod tests {
    use super::super::range::Range;
    use super::*;

    fn layout(width: u32, height: u32) -> Layout {
        let map = CostMap {
            values: &[],
            range: Range::of(&[10.0, 1e5]),
            width,
            height,
            title: "t",
            unit: "ns",
            subtitle: "s",
        };
        Layout::of(&map)
    }

    #[test]
    fn small_maps_are_magnified_by_a_whole_number() {
        let table = [
            (1, 1, 600, 600),
            (100, 100, 600, 600),
            (400, 300, 800, 600),
            (599, 10, 1198, 20),
            (600, 10, 600, 10),
            (3840, 2160, 3840, 2160),
            (1, 10_000, 1, 10_000),
        ];
        for (width, height, map_width, map_height) in table {
            let map = layout(width, height).map;
            assert_eq!(
                [map.width, map.height],
                [map_width, map_height],
                "{width} x {height}"
            );
        }
    }

    #[test]
    fn nothing_overlaps_or_leaves_the_picture() {
        for (width, height) in [
            (1, 1),
            (400, 300),
            (20, 2000),
            (2000, 20),
            (10_000, 1),
            (5, 2),
        ] {
            let l = layout(width, height);
            let [bar_x, bar_y] = l.bar_corner;
            let [bar_width, bar_height] = l.bar.size();
            let [title, subtitle, footer] = l.texts.each_ref().map(Block::end);
            assert!(title < subtitle && subtitle < l.map.y);
            assert!(
                bar_x > l.map.right() || bar_y > l.map.bottom(),
                "{width} x {height}"
            );
            assert!(footer as f32 - l.em_px > (bar_y + bar_height) as f32);
            assert!(footer as f32 - l.em_px > l.map.bottom() as f32);
            assert!(bar_x + bar_width < l.width && footer < l.height);
            assert!(l.map.right() < l.width);
        }
    }

    #[test]
    fn a_long_title_takes_more_lines_and_moves_the_map_down() {
        let short = layout(400, 300);
        let title = "a scene whose name is a whole sentence: time per pixel of its measured frame";
        let map = CostMap {
            values: &[],
            range: Range::of(&[10.0, 1e5]),
            width: 400,
            height: 300,
            title: &title.repeat(2),
            unit: "ns",
            subtitle: "s",
        };
        let long = Layout::of(&map);
        let lines: Vec<&str> = long.texts[0]
            .lines
            .iter()
            .map(|(line, _)| &**line)
            .collect();
        assert_eq!(lines.join(" "), map.title);
        assert!(long.map.y > short.map.y && long.texts[0].end() < long.texts[1].end());
        assert_eq!(long.height - short.height, long.map.y - short.map.y);
    }

    #[test]
    fn the_font_is_two_percent_of_the_longer_side() {
        let sizes = [(1, 1), (400, 300), (3840, 2160), (2160, 3840), (20_000, 9)];
        let expected = [14.0, 16.0, 76.8, 76.8, 160.0];
        assert_eq!(
            sizes.map(|(width, height)| layout(width, height).em_px),
            expected
        );
    }
}
