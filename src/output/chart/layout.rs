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
use super::axis::AxisEdge;
use super::bar::Bar;
use super::footer;
use super::label::Unit;
use super::surface::{GRAY_INK, INK, LINE_EM, PixelPosition, Rect, px};
use super::text::{CAP_HEIGHT_EM, Style};

/// Size of the title, in ems.
const TITLE_EM: f32 = 1.3;
/// Size of the footer, in ems.
const FOOTER_EM: f32 = 0.9;
/// Maximum number of lines of a text; the last one is truncated.
const MAX_LINES: usize = 4;

/// Text in one or more lines.
pub struct Block {
    /// Font.
    pub style: Style,
    /// Lines.
    pub lines: Vec<String>,
    /// Baseline of the first line.
    pub baseline: f32,
}

impl Block {
    /// Returns the baseline of the last line.
    fn end(&self) -> f32 {
        let n_below = self.lines.len() as f32 - 1.0;
        self.baseline + px(n_below * LINE_EM * self.style.em_px)
    }
}

/// Positions and sizes in pixels of the picture.
pub struct Layout {
    /// Width of the picture.
    pub width: f32,
    /// Height of the picture.
    pub height: f32,
    /// Font size of tick labels and subtitle, and the unit of all distances.
    pub em_px: f32,
    /// Side of a value's square, in pixels.
    pub magnification: u32,
    /// The map, without its frame.
    pub map: Rect,
    /// The color bar.
    pub bar: Bar,
    /// Upper left corner of the color bar, without its frame.
    pub bar_corner: PixelPosition,
    /// Title, subtitle and footer.
    pub texts: [Block; 3],
}

impl Layout {
    /// Computes the layout of `map`.
    pub fn new(map: &CostMap) -> Self {
        let magnification = MIN_LONGER_SIDE_PX.div_ceil(map.width.max(map.height));
        let [width, height] = [map.width, map.height].map(|n| (n * magnification) as f32);
        // Beside a thin map, large texts would take most of the picture.
        let em_px = width.max(height) / 50.0;
        let em_px = em_px.min(width.min(height) / 8.0).clamp(14.0, 160.0);
        let em = |n: f32| px(n * em_px);

        // Place the bar beside the map, which gives the width of the texts.
        let bar = Bar::beside(
            [width, height],
            &map.range,
            Unit::from_name(map.unit),
            em_px,
        );
        let [bar_width, bar_height] = bar.size();
        let map_and_bar = match bar.edge {
            AxisEdge::Bottom => bar_width,
            _ => width + em(BAR_GAP_EM) + bar_width,
        };
        let text_width = map_and_bar.max(em(MIN_TEXT_WIDTH_EM));
        let block = |text: &str, size_em: f32, color, baseline| {
            let style = Style::new(size_em * em_px, color);
            Block {
                lines: style.wrapped(text, text_width, MAX_LINES),
                style,
                baseline,
            }
        };

        // Stack title, subtitle, map, bar and footer from top to bottom.
        let first = em(MARGIN_EM) + em(TITLE_EM * CAP_HEIGHT_EM);
        let title = block(map.title, TITLE_EM, INK, first);
        let below = title.end()
            + if map.subtitle.is_empty() {
                0.0
            } else {
                em(1.7)
            };
        let subtitle = block(map.subtitle, 1.0, GRAY_INK, below);
        let at = Rect::at([em(MARGIN_EM), subtitle.end() + em(1.1)], [width, height]);
        let bar_corner = match bar.edge {
            AxisEdge::Bottom => [at.x, at.bottom() + em(1.0)],
            _ => [at.right() + em(BAR_GAP_EM), at.y],
        };
        let last = bar_corner[1] + bar_height + em(1.9);
        let footer = footer::line(map.unit, &map.range);
        let footer = block(&footer, FOOTER_EM, GRAY_INK, last);
        Self {
            width: text_width + 2.0 * em(MARGIN_EM),
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

    fn layout(width: u32, height: u32, title: &str) -> Layout {
        Layout::new(&CostMap {
            values: &[],
            range: Range::spanning(&[10.0, 1e5]),
            width,
            height,
            title,
            unit: "ns",
            subtitle: "s",
        })
    }

    #[test]
    fn small_maps_are_magnified_by_a_whole_number() {
        let table = [
            (1, 1, 600.0, 600.0),
            (100, 100, 600.0, 600.0),
            (400, 300, 800.0, 600.0),
            (599, 10, 1198.0, 20.0),
            (600, 10, 600.0, 10.0),
            (3840, 2160, 3840.0, 2160.0),
            (1, 10_000, 1.0, 10_000.0),
        ];
        for (width, height, map_width, map_height) in table {
            let map = layout(width, height, "t").map;
            assert_eq!([map.width, map.height], [map_width, map_height]);
        }
    }

    #[test]
    fn nothing_overlaps_or_leaves_the_picture() {
        let sizes = [
            (1, 1),
            (400, 300),
            (20, 2000),
            (2000, 20),
            (10_000, 1),
            (5, 2),
        ];
        for (width, height) in sizes {
            let l = layout(width, height, "t");
            let [bar_x, bar_y] = l.bar_corner;
            let [bar_width, bar_height] = l.bar.size();
            let [title, subtitle, footer] = l.texts.each_ref().map(Block::end);
            assert!(title < subtitle && subtitle < l.map.y);
            assert!(bar_x > l.map.right() || bar_y > l.map.bottom());
            assert!(footer - l.em_px > bar_y + bar_height);
            assert!(footer - l.em_px > l.map.bottom());
            assert!(bar_x + bar_width < l.width && footer < l.height);
            assert!(l.map.right() < l.width);
        }
    }

    #[test]
    fn a_long_title_takes_more_lines_and_moves_the_map_down() {
        let short = layout(400, 300, "t");
        let title = "a scene whose name is a whole sentence: time per pixel of its measured frame";
        let title = [title; 2].join(" ");
        let long = layout(400, 300, &title);
        assert_eq!(long.texts[0].lines.join(" "), title);
        assert!(long.map.y > short.map.y && long.texts[0].end() < long.texts[1].end());
        assert_eq!(long.height - short.height, long.map.y - short.map.y);
    }

    #[test]
    fn the_font_is_two_percent_of_the_longer_side_but_small_beside_a_thin_map() {
        let sizes = [
            (1, 1),
            (400, 300),
            (3840, 2160),
            (2160, 3840),
            (20_000, 9000),
            (20_000, 160),
            (1, 65_535),
        ];
        let expected = [14.0, 16.0, 76.8, 76.8, 160.0, 20.0, 14.0];
        let found = sizes.map(|(width, height)| layout(width, height, "t").em_px);
        assert_eq!(found, expected);
    }
}
