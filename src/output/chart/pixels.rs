//! Draws on the pixels of a picture.

use image::{Rgb, RgbImage};

use super::surface::{Anchor, DrawingSurface, PixelPosition, Rect, mixed};
use super::text::Style;

impl DrawingSurface for RgbImage {
    fn rect(&mut self, rect: Rect, color: Rgb<u8>) {
        let [width, height] = [self.width() as usize, self.height() as usize];
        // The casts saturate.
        let rows = rect.y.round() as usize..(rect.bottom().round() as usize).min(height);
        let end = (rect.right().round() as usize).min(width);
        let start = (rect.x.round() as usize).min(end);
        let (pixels, _) = self.as_chunks_mut::<3>();
        for y in rows {
            pixels[y * width..][start..end].fill(color.0);
        }
    }

    fn line(&mut self, points: &[PixelPosition], width: f32, color: Rgb<u8>) {
        for (&a, &b) in points.iter().zip(points.iter().skip(1)) {
            let depth = |at| width / 2.0 - distance_to_line(at, a, b);
            fill(self, &[a, b], width, color, depth);
        }
    }

    fn ring(&mut self, center: PixelPosition, radius: f32, width: f32, color: Rgb<u8>) {
        let depth = |at| width / 2.0 - (distance(at, center) - radius).abs();
        fill(self, &[center], radius + width, color, depth);
    }

    fn triangle(&mut self, corners: [PixelPosition; 3], color: Rgb<u8>) {
        let [a, b, c] = corners;
        let orientation = cross(a, b, c).signum();
        let depth = |at| {
            let inside = [(a, b), (b, c), (c, a)]
                .map(|(from, to)| orientation * cross(from, to, at) / distance(from, to));
            inside.into_iter().fold(f32::INFINITY, f32::min)
        };
        fill(self, &corners, 0.0, color, depth);
    }

    fn text(&mut self, text: &str, [x, y]: PixelPosition, anchor: Anchor, style: &Style) {
        let before = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => style.width(text) / 2.0,
            Anchor::End => style.width(text),
        };
        let start = if style.is_turned {
            [x, y + before]
        } else {
            [x - before, y]
        };
        let [x, y] = start.map(|along| along.round() as i64);
        style.rasterize(text, |[column, row], coverage| {
            blend(self, [x + column, y + row], style.color, coverage);
        });
    }
}

/// Mixes `color` into one pixel; `coverage` is from 0 to 1, which replaces the pixel.
pub fn blend(picture: &mut RgbImage, [x, y]: [i64; 2], color: Rgb<u8>, coverage: f32) {
    let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else {
        return;
    };
    if let Some(pixel) = picture.get_pixel_mut_checked(x, y) {
        for (old, new) in pixel.0.iter_mut().zip(color.0) {
            *old = mixed(*old, new, coverage);
        }
    }
}

/// Fills a shape within `reach` of the box around `points`. `depth` is the distance of a position
/// to its outline, negative outside; a pixel's coverage follows from the depth of its center.
fn fill(
    picture: &mut RgbImage,
    points: &[PixelPosition],
    reach: f32,
    color: Rgb<u8>,
    depth: impl Fn(PixelPosition) -> f32,
) {
    let ends = [picture.width(), picture.height()];
    let [columns, rows] = [0, 1].map(|axis| {
        let along = || points.iter().map(|point| point[axis]);
        let low = along().fold(f32::INFINITY, f32::min) - reach - 1.0;
        let high = along().fold(f32::NEG_INFINITY, f32::max) + reach + 1.0;
        low as u32..(high as u32 + 1).min(ends[axis])
    });
    for y in rows {
        for x in columns.clone() {
            let coverage = (depth([x as f32 + 0.5, y as f32 + 0.5]) + 0.5).clamp(0.0, 1.0);
            if coverage > 0.0 {
                blend(picture, [x.into(), y.into()], color, coverage);
            }
        }
    }
}

/// Returns twice the signed area of the triangle `from`, `to`, `at`.
fn cross(from: PixelPosition, to: PixelPosition, at: PixelPosition) -> f32 {
    (to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0])
}

fn distance(a: PixelPosition, b: PixelPosition) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Returns the distance to the nearest point between two ends.
fn distance_to_line(at: PixelPosition, a: PixelPosition, b: PixelPosition) -> f32 {
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    let along = (at[0] - a[0]) * dx + (at[1] - a[1]) * dy;
    let share = (along / (dx * dx + dy * dy).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    distance(at, [a[0] + share * dx, a[1] + share * dy])
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;

    use super::*;

    const WHITE: Rgb<u8> = Rgb([255; 3]);

    type Draw = fn(&mut RgbImage);

    #[test]
    fn shapes_cover_their_areas() {
        let shapes: [(Draw, f32); 5] = [
            (
                |to| to.triangle([[2.0, 3.0], [17.5, 5.0], [8.0, 16.0]], WHITE),
                94.75,
            ),
            (|to| to.rect(Rect::around([5.0, 7.0], 3.0), WHITE), 36.0),
            (|to| to.disk([10.2, 9.7], 6.0, WHITE), PI * 36.0),
            (|to| to.ring([10.0, 10.0], 6.0, 2.0, WHITE), PI * 24.0),
            // With round ends.
            (
                |to| to.line(&[[3.0, 4.0], [11.0, 10.0]], 2.0, WHITE),
                20.0 + PI,
            ),
        ];
        for (draw, area) in shapes {
            let mut picture = RgbImage::new(20, 20);
            draw(&mut picture);
            let found: f32 = picture.pixels().map(|p| f32::from(p.0[0]) / 255.0).sum();
            assert!(
                (found - area).abs() < 0.02 * area + 0.5,
                "{found}, not {area}"
            );
        }
    }

    #[test]
    fn shapes_are_clipped_to_the_picture() {
        let mut picture = RgbImage::new(2, 2);
        picture.rect(Rect::between([1.0, 1.0], [9.0, 9.0]), WHITE);
        picture.triangle([[-9.0, -9.0], [-2.0, -2.0], [-9.0, -2.0]], WHITE);
        picture.line(&[[-9.0, 3.5], [9.0, 3.5]], 2.0, WHITE);
        let inked = picture.pixels().map(|pixel| pixel.0[0]).collect::<Vec<_>>();
        assert_eq!(inked, [0, 0, 0, 255]);
    }
}
