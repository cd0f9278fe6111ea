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
use super::text::CAP_HEIGHT_EM;

/// Size of the title, in ems.
pub const TITLE_EM: f32 = 1.3;
/// Size of the footer, in ems.
pub const FOOTER_EM: f32 = 0.9;

/// Positions and sizes in pixels of the picture.
pub struct Layout {
    /// Width of the picture.
    pub width: u32,
    /// Height of the picture.
    pub height: u32,
    /// Font size of tick labels and subtitle, and the unit of all distances.
    pub em_px: f32,
    /// Side of the square of one value.
    pub magnification: u32,
    /// The map, without its frame.
    pub map: Rect,
    /// The color bar.
    pub bar: Bar,
    /// Upper left corner of the color bar, without its frame.
    pub bar_corner: [u32; 2],
    /// Greatest width of a line of text.
    pub text_width: u32,
    /// Baseline of the title.
    pub title_baseline: u32,
    /// Baseline of the subtitle.
    pub subtitle_baseline: u32,
    /// Baseline of the footer.
    pub footer_baseline: u32,
}

/// The smallest magnification at which the longer side of the map is long enough.
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

        let title_baseline = em(MARGIN_EM) + em(TITLE_EM * CAP_HEIGHT_EM);
        let subtitle_baseline = title_baseline + if map.subtitle.is_empty() { 0 } else { em(1.7) };
        let at = Rect {
            x: em(MARGIN_EM),
            y: subtitle_baseline + em(1.1),
            width,
            height,
        };
        let bar = Bar::beside([width, height], &map.range, Unit::named(map.unit), em_px);
        let bar_corner = match bar.direction() {
            Direction::Up => [at.right() + em(1.2), at.y],
            Direction::Right => [at.x, at.bottom() + em(1.0)],
        };
        let [bar_width, bar_height] = bar.size();
        let footer_baseline = bar_corner[1] + bar_height + em(1.9);
        let text_width = (bar_corner[0] + bar_width - at.x).max(em(MIN_TEXT_WIDTH_EM));
        Self {
            width: text_width + 2 * em(MARGIN_EM),
            height: footer_baseline + em(1.3),
            em_px,
            magnification,
            map: at,
            bar,
            bar_corner,
            text_width,
            title_baseline,
            subtitle_baseline,
            footer_baseline,
        }
    }
}

/// Smaller maps are magnified to at least this size.
const MIN_LONGER_SIDE_PX: u32 = 600;
const MARGIN_EM: f32 = 1.5;
/// Least width for the title, even if the map is narrower.
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
            assert!(l.title_baseline < l.subtitle_baseline && l.subtitle_baseline < l.map.y);
            assert!(
                bar_x > l.map.right() || bar_y > l.map.bottom(),
                "{width} x {height}"
            );
            assert!(l.footer_baseline as f32 - l.em_px > (bar_y + bar_height) as f32);
            assert!(l.footer_baseline as f32 - l.em_px > l.map.bottom() as f32);
            assert!(bar_x + bar_width < l.width && l.footer_baseline < l.height);
            assert!(l.map.right() < l.width && l.map.x + l.text_width < l.width);
        }
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
