//! Draws simple shapes onto a picture, clipped to its bounds.

use image::{Rgb, RgbImage};

/// Background, per channel.
pub const PAPER: u8 = 255;
/// Title and tick labels.
pub const INK: Rgb<u8> = Rgb([26; 3]);
/// Subtitle and footer.
pub const GRAY_INK: Rgb<u8> = Rgb([88; 3]);
/// Frames and ticks.
pub const LINE: Rgb<u8> = Rgb([64; 3]);

/// Rounds to whole pixels.
pub fn px(length: f32) -> u32 {
    length.round() as u32
}

/// Returns the thickness of frames and ticks for text of `em_px`.
pub fn line_px(em_px: f32) -> u32 {
    px(em_px / 16.0).max(1)
}

/// A rectangle of pixels; `x` and `y` are its top left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rect {
    /// The first column.
    pub x: u32,
    /// The first row.
    pub y: u32,
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
}

impl Rect {
    /// Returns the first column to its right.
    pub fn right(&self) -> u32 {
        self.x + self.width
    }

    /// Returns the first row below it.
    pub fn bottom(&self) -> u32 {
        self.y + self.height
    }

    /// Adds a border of `border_px` on each side; `x` and `y` must be at least that large.
    pub fn grown(&self, border_px: u32) -> Self {
        Self {
            x: self.x - border_px,
            y: self.y - border_px,
            width: self.width + 2 * border_px,
            height: self.height + 2 * border_px,
        }
    }
}

/// Paints `rect` in `color`.
pub fn fill_rect(picture: &mut RgbImage, rect: Rect, color: Rgb<u8>) {
    let (width, height) = (picture.width(), picture.height());
    let (pixels, _) = picture.as_chunks_mut::<3>();
    for y in rect.y..rect.bottom().min(height) {
        let row = &mut pixels[(y * width) as usize..][..width as usize];
        let end = rect.right().min(width);
        row[rect.x.min(end) as usize..end as usize].fill(color.0);
    }
}

/// Mixes `color` into one pixel; `coverage` is from 0 to 1, which replaces the pixel.
pub fn blend(picture: &mut RgbImage, x: i64, y: i64, color: Rgb<u8>, coverage: f32) {
    let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else {
        return;
    };
    if let Some(pixel) = picture.get_pixel_mut_checked(x, y) {
        for (old, new) in pixel.0.iter_mut().zip(color.0) {
            let mixed = f32::from(*old) + coverage * (f32::from(new) - f32::from(*old));
            *old = mixed.round() as u8;
        }
    }
}

/// Corners of a triangle, x and y in pixels.
pub type PixelTriangle = [[f32; 2]; 3];

/// Paints `triangle` in `color` with smooth edges.
pub fn fill_triangle(picture: &mut RgbImage, triangle: PixelTriangle, color: Rgb<u8>) {
    let span = |axis: usize| {
        let along = triangle.map(|corner| corner[axis]);
        let low = along.into_iter().fold(f32::INFINITY, f32::min);
        let high = along.into_iter().fold(f32::NEG_INFINITY, f32::max);
        low.floor() as i64..high.ceil() as i64
    };
    for y in span(1) {
        for x in span(0) {
            blend(picture, x, y, color, coverage(&triangle, x, y));
        }
    }
}

/// Moves each edge of the triangle inward by `inset_px`, less than the radius of its incircle.
pub fn inset(triangle: PixelTriangle, inset_px: f32) -> PixelTriangle {
    let [a, b, c] = triangle;
    let lengths = [distance(b, c), distance(c, a), distance(a, b)];
    let perimeter: f32 = lengths.iter().sum();
    let radius = edge(a, b, c).abs() / perimeter;
    // Moving all edges by the same distance scales a triangle about the center of its incircle.
    let center =
        [0, 1].map(|i| (lengths[0] * a[i] + lengths[1] * b[i] + lengths[2] * c[i]) / perimeter);
    let shrink = 1.0 - inset_px / radius;
    triangle.map(|corner| [0, 1].map(|i| center[i] + shrink * (corner[i] - center[i])))
}

/// Returns the share of pixel (x, y) inside `triangle`, from 8 x 8 samples.
fn coverage(triangle: &PixelTriangle, x: i64, y: i64) -> f32 {
    const N: usize = 8;
    let [a, b, c] = *triangle;
    let orientation = edge(a, b, c).signum();
    let is_inside = |i: usize| {
        let offset = |k: usize| (k as f32 + 0.5) / N as f32;
        let p = [x as f32 + offset(i % N), y as f32 + offset(i / N)];
        [(a, b), (b, c), (c, a)]
            .iter()
            .all(|&(from, to)| orientation * edge(from, to, p) >= 0.0)
    };
    (0..N * N).filter(|&i| is_inside(i)).count() as f32 / (N * N) as f32
}

/// Returns twice the signed area of the triangle `from`, `to`, `p`.
fn edge(from: [f32; 2], to: [f32; 2], p: [f32; 2]) -> f32 {
    (to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0])
}

fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_covers_its_area() {
        let mut picture = RgbImage::from_pixel(20, 20, Rgb([0; 3]));
        fill_triangle(
            &mut picture,
            [[2.0, 3.0], [17.5, 5.0], [8.0, 16.0]],
            Rgb([255; 3]),
        );
        let area: f32 = picture.pixels().map(|p| f32::from(p.0[0]) / 255.0).sum();
        assert!((area - 94.75).abs() < 1.0, "{area}");
    }

    #[test]
    fn an_inset_right_triangle_keeps_its_distances() {
        let [a, b, c] = inset([[0.0, 0.0], [12.0, 0.0], [0.0, 9.0]], 1.0);
        let expected = [[1.0, 1.0], [9.0, 1.0], [1.0, 7.0]];
        for (got, expected) in [a, b, c].into_iter().zip(expected) {
            assert!(distance(got, expected) < 1e-4, "{got:?} {expected:?}");
        }
    }

    #[test]
    fn shapes_are_clipped_to_the_picture() {
        let mut picture = RgbImage::from_pixel(2, 2, Rgb([PAPER; 3]));
        let rect = Rect {
            x: 1,
            y: 1,
            width: 9,
            height: 9,
        };
        fill_rect(&mut picture, rect, INK);
        fill_triangle(
            &mut picture,
            [[-9.0, -9.0], [-1.0, -1.0], [-9.0, -1.0]],
            INK,
        );
        assert_eq!(*picture.get_pixel(0, 0), Rgb([PAPER; 3]));
        assert_eq!(*picture.get_pixel(1, 1), INK);
    }
}
