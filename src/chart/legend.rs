//! Color bars on a picture: what the colors of its surfaces mean.

use image::{Rgb, RgbImage};

use super::bar::Bar;
use super::canvas::{self, Rect, px};
use super::colors::Colors;
use super::label::Unit;
use super::range::{Range, Scale};
use super::text::{CAP_HEIGHT_EM, Style};
use crate::color::Palette;

/// A color bar with a title.
#[derive(Debug, Clone, PartialEq)]
pub struct ColorLegend {
    /// What the numbers are.
    pub title: String,
    /// The colors.
    pub map: Palette,
    /// The numbers of the first and the last color, ascending; positive on a logarithmic
    /// scale.
    pub ends: [f32; 2],
    /// The scale of the numbers.
    pub scale: Scale,
    /// Whether there are numbers below the first and above the last.
    pub clips: [bool; 2],
}

/// Pictures with a shorter side have no room for a color bar.
const MIN_SIDE_PX: u32 = 96;
/// The length of a bar as a fraction of the picture's height.
const LENGTH: f32 = 0.5;
/// The height of a picture in ems, at least.
const MIN_HEIGHT_EM: f32 = 24.0;
/// How much of the picture the paper below a bar hides.
const OPACITY: f32 = 0.75;

/// Draws color bars from the right edge of a picture on, unless it is too small.
pub fn draw_legends(picture: &mut RgbImage, legends: &[ColorLegend]) {
    let (width, height) = picture.dimensions();
    if width.min(height) < MIN_SIDE_PX {
        return;
    }
    let em_px = (width.max(height) as f32 / 55.0).min(height as f32 / MIN_HEIGHT_EM);
    let margin = px(em_px);
    let mut right = width;
    for legend in legends {
        let range = legend.range();
        let length = px(LENGTH * height as f32);
        let bar = Bar::beside([1, length], &range, Unit::named(""), em_px);
        let style = Style::new(em_px, canvas::INK);
        let [bar_width, _] = bar.size();
        let room = right.saturating_sub(4 * margin);
        let title = style.fitted(&legend.title, room);
        let inner = bar_width.max(px(style.width(&title).ceil()));
        let Some(left) = right.checked_sub(inner + 3 * margin) else {
            return;
        };
        let title_px = px(em_px * (CAP_HEIGHT_EM + 1.0));
        let paper = Rect {
            x: left,
            y: (height - length - title_px) / 2 - margin,
            width: inner + 2 * margin,
            height: length + title_px + 2 * margin,
        };
        pale(picture, paper);
        let baseline = paper.y + margin + px(em_px * CAP_HEIGHT_EM);
        style.paint(picture, &title, left + margin, baseline);
        let corner = [left + margin, paper.y + margin + title_px];
        bar.paint(picture, corner, &Colors::of_map(&range, &legend.map));
        right = left;
    }
}

impl ColorLegend {
    fn range(&self) -> Range {
        let [low, high] = self.ends;
        let [below, above] = self.clips.map(u64::from);
        Range {
            scale: self.scale,
            low: low.into(),
            high: high.into(),
            min: low,
            max: high,
            n_below: below,
            n_above: above,
            n_undrawable: 0,
        }
    }
}

fn pale(picture: &mut RgbImage, rect: Rect) {
    for y in rect.y..rect.bottom() {
        for x in rect.x..rect.right() {
            canvas::blend(
                picture,
                x.into(),
                y.into(),
                Rgb([canvas::PAPER; 3]),
                OPACITY,
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_stay_in_the_picture_whatever_its_size() {
        let legend = |title: &str, ends, scale| ColorLegend {
            title: title.to_owned(),
            map: Palette::default(),
            ends,
            scale,
            clips: [true, true],
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
