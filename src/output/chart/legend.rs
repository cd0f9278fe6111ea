//! Color bars on a picture: the key to the colors of its surfaces.

use image::{Rgb, RgbImage};

use super::bar::Bar;
use super::colors::Colors;
use super::entries::LegendEntries;
use super::label::Unit;
use super::pixels;
use super::range::Range;
use super::surface::{
    Anchor, DrawingSurface, INK, LINE, LINE_EM, PAPER, PixelPosition, Rect, line_px, px,
};
use super::text::{CAP_HEIGHT_EM, Style};
use world::color::Palette;

/// A color bar with a title.
#[derive(Debug, Clone, PartialEq)]
pub struct ColorLegend {
    /// The name of the numbers.
    pub title: String,
    /// The meaning of the colors.
    pub key: LegendKey,
}

/// The meaning of colors.
#[derive(Debug, Clone, PartialEq)]
pub enum LegendKey {
    /// A range of numbers.
    Range {
        /// The colors.
        map: Palette,
        /// The numbers from the first to the last color.
        range: Range,
    },
    /// Categories, the first on top.
    Categories(Vec<Swatch>),
}

/// A category in a legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Swatch {
    /// The name of the category.
    pub label: String,
    /// Red, green and blue in sRGB.
    pub color: [u8; 3],
}

/// Pictures with a shorter side have no room for a color bar.
const MIN_SIDE_PX: f32 = 96.0;
/// The length of a bar as a fraction of the picture's height.
const LENGTH: f32 = 0.5;
/// Maximum length of a list of categories, as a fraction of the picture's height.
const MAX_LENGTH: f32 = 0.8;
/// Minimum height of a picture in ems.
const MIN_HEIGHT_EM: f32 = 24.0;
/// Maximum width of a title that is wider than its key, as a fraction of the picture's width.
const TITLE_WIDTH: f32 = 0.2;
/// Maximum number of lines of a title.
const TITLE_LINES: usize = 4;
/// Opacity of the paper below a bar.
const OPACITY: f32 = 0.75;

/// Draws color bars along the right edge of a picture, unless it is too small.
pub fn draw_legends(picture: &mut RgbImage, legends: &[ColorLegend]) {
    let [width, height] = [picture.width() as f32, picture.height() as f32];
    if width.min(height) < MIN_SIDE_PX {
        return;
    }
    let em_px = (width.max(height) / 55.0).min(height / MIN_HEIGHT_EM);
    let margin = px(em_px);
    let mut right = width;
    for legend in legends {
        let room = [(right - 4.0 * margin).max(0.0), height];
        // Measure the key and its title.
        let ([inner, length], draw_key) = laid_out(&legend.key, room, em_px);
        let style = Style::new(em_px, INK);
        let title_width = inner.max(px(TITLE_WIDTH * width)).min(room[0]);
        let title = style.wrapped(&legend.title, title_width, TITLE_LINES);
        let widths = title.iter().map(|line| px(style.width(line).ceil()));
        let inner = widths.fold(inner, f32::max);
        let left = right - inner - 3.0 * margin;
        if left < 0.0 {
            return;
        }
        // Paint the paper, the title and the key, centered vertically.
        let below_first = (title.len() - 1) as f32 * LINE_EM;
        let title_px = px(em_px * (CAP_HEIGHT_EM + 1.0 + below_first));
        let y = ((height - length - title_px) / 2.0).max(0.0).floor() - margin;
        let size = [inner, length + title_px].map(|side| side + 2.0 * margin);
        let paper = Rect::at([left, y.max(0.0)], size);
        pale(picture, paper);
        let corner = [left + margin, paper.y + margin];
        let baseline = corner[1] + px(em_px * CAP_HEIGHT_EM);
        picture.lines(&title, [corner[0], baseline], Anchor::Start, &style);
        draw_key(picture, [corner[0], corner[1] + title_px]);
        right = left;
    }
}

/// Draws a key with its upper left corner at a position.
type DrawKey = Box<dyn Fn(&mut RgbImage, PixelPosition)>;

/// Returns the size of a key for a picture of this height, within this width, and how to draw it.
fn laid_out(key: &LegendKey, [width, height]: [f32; 2], em_px: f32) -> ([f32; 2], DrawKey) {
    match key {
        LegendKey::Range { map, range } => {
            let size = [1.0, px(LENGTH * height)];
            let bar = Bar::beside(size, range, Unit::from_name(""), em_px);
            let colors = Colors::from_map(range, map);
            let size = bar.size();
            (
                size,
                Box::new(move |to, corner| bar.draw(to, corner, &colors)),
            )
        }
        LegendKey::Categories(all) => {
            let room = [width, px(MAX_LENGTH * height)];
            let all = all.iter();
            let all = all.map(|swatch| (Some(Rgb(swatch.color)), swatch.label.clone()));
            let entries = LegendEntries::within(room, em_px, all, None);
            let draw_swatch =
                move |to: &mut dyn DrawingSurface, color: &Option<_>, square: Rect| {
                    if let Some(color) = color {
                        to.rect(square.grown(line_px(em_px)), LINE);
                        to.rect(square, *color);
                    }
                };
            let size = entries.size();
            (
                size,
                Box::new(move |to, corner| entries.draw(to, corner, draw_swatch)),
            )
        }
    }
}

/// Covers a rectangle with translucent paper.
fn pale(picture: &mut RgbImage, rect: Rect) {
    for y in rect.y as i64..rect.bottom() as i64 {
        for x in rect.x as i64..rect.right() as i64 {
            pixels::blend(picture, [x, y], Rgb([PAPER; 3]), OPACITY);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::ticks::Scale;
    use super::*;

    /// Each category is in the list with its color, or the list says how many more there are.
    #[test]
    fn every_category_that_has_room_has_its_swatch() {
        for (n, n_shown) in [(1_u8, 1), (5, 5), (40, 16)] {
            let swatch = |i: u8| Swatch {
                label: i.to_string(),
                color: [200, i, 7],
            };
            let mut picture = RgbImage::new(400, 300);
            let key = LegendKey::Categories((0..n).map(swatch).collect());
            let title = String::new();
            draw_legends(&mut picture, &[ColorLegend { title, key }]);
            let tops = |i: u8| {
                picture
                    .enumerate_pixels()
                    .find(|(.., p)| p.0 == [200, i, 7])
            };
            let shown: Vec<u32> = (0..n).map_while(|i| tops(i).map(|(_, y, _)| y)).collect();
            assert_eq!(shown.len(), n_shown, "{n}");
            assert!(shown.is_sorted_by(|a, b| a < b), "{shown:?}");
        }
    }

    /// A title is broken into lines and does not cover the picture.
    #[test]
    fn a_long_title_leaves_the_picture_visible() {
        let mut picture = RgbImage::new(600, 400);
        let key = LegendKey::Range {
            map: Palette::default(),
            range: Range::between(Scale::Linear, [0.0, 1.0], [true, true]),
        };
        let title = "the mean temperature of the coolant at the outlet in kelvin".to_owned();
        draw_legends(&mut picture, &[ColorLegend { title, key }]);
        let painted = picture.enumerate_pixels().filter(|(.., p)| p.0 != [0; 3]);
        let left = painted.map(|(x, ..)| x).min().unwrap();
        assert!(left > 400, "{left}");
    }

    #[test]
    fn bars_stay_in_the_picture_whatever_its_size() {
        let legend = |title: &str, ends, scale| ColorLegend {
            title: title.to_owned(),
            key: LegendKey::Range {
                map: Palette::default(),
                range: Range::between(scale, ends, [true, true]),
            },
        };
        let swatches = |n: u8| ColorLegend {
            title: "rock".to_owned(),
            key: LegendKey::Categories(
                (0..n)
                    .map(|i| Swatch {
                        label: "a long name of a kind of rock ".repeat(usize::from(i)),
                        color: [i; 3],
                    })
                    .collect(),
            ),
        };
        let legends = [
            legend("temperature (K)", [290.0, 345.0], Scale::Linear),
            legend(
                "a title that is too long for any picture",
                [1e-9, 1e20],
                Scale::Logarithmic,
            ),
            legend("", [-1e30, 1e30], Scale::Linear),
            legend("speed", [3.0, 3.1], Scale::Linear),
            swatches(0),
            swatches(1),
            swatches(200),
        ];
        for (width, height) in [
            (1, 1),
            (96, 96),
            (96, 4000),
            (4000, 96),
            (400, 300),
            (1920, 1080),
        ] {
            let mut picture = RgbImage::new(width, height);
            draw_legends(&mut picture, &legends);
            let is_drawn = picture.pixels().any(|pixel| pixel.0 != [0; 3]);
            assert!(is_drawn || width.min(height) < 300, "{width} x {height}");
        }
    }
}
