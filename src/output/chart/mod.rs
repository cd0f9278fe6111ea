//! The per-pixel cost map as a picture with title, subtitle, map, color bar and footer.
//!
//! [`write()`] takes one value per pixel and writes a PNG. Cost spans decades, so the colors
//! (Inferno, perceptually uniform) follow the logarithm. `range` chooses the range of the colors so
//! that a single interrupted pixel does not compress the rest; the footer and the tips of the color
//! bar show what is clipped. Changes of cost have a diverging scale around zero.

// In the order of the data flow; each module uses only those above it.
pub mod png;
mod text;
mod surface;
mod pixels;
mod svg;
mod ticks;
mod range;
mod colors;
mod label;
mod footer;
mod axis;
mod bar;
mod layout;
mod entries;
mod legend;

use std::io::{self, Write};

use image::RgbImage;
use rayon::prelude::*;

pub use axis::{AxisEdge, LabeledAxis};
use colors::Colors;
pub use entries::LegendEntries;
use host::provenance::{self, RunId};
pub use label::{rounded_number, short_number};
use layout::Layout;
pub use legend::{ColorLegend, LegendKey, Swatch, draw_legends};
pub use range::Range;
use surface::line_px;
pub use surface::{
    Anchor, DrawingSurface, INK, LINE, LINE_EM, PAPER, PixelPosition, Rect, faded, px,
};
pub use svg::SvgPicture;
pub use text::Style;
pub use ticks::{Scale, Ticks};

/// Rows of values that a thread paints at a time.
const ROWS: usize = 32;

/// The contents of a cost picture.
#[derive(Clone, Copy, Debug)]
pub struct CostMap<'a> {
    /// One value per pixel, row-major, `width * height`, row 0 on top. Infinite and NaN values are
    /// drawn mid-gray; on a logarithmic scale, also zero, negative and subnormal values.
    pub values: &'a [f32],
    /// The range of the values, with the scale of the colors.
    pub range: Range,
    /// Pixels per row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// The title, such as "spheres: time per pixel"; long ones take up to four
    /// lines.
    pub title: &'a str,
    /// Unit of the values. "ns" is labeled in ns, µs, ms and s; any other unit, such as "node
    /// visits", in k, M and G, and the footer names it.
    pub unit: &'a str,
    /// The gray line below the title, such as "400 x 300, median 412 ns"; empty for none.
    pub subtitle: &'a str,
}

impl CostMap<'static> {
    /// Creates a map of this size with a title and a subtitle of typical length, without values.
    pub fn typical([width, height]: [u32; 2]) -> Self {
        Self {
            values: &[],
            range: Range::spanning(&[1.0, 1e5]),
            width,
            height,
            title: "still_life: time per pixel",
            unit: "ns",
            subtitle: "720 × 480 pixels, 256 samples per pixel, 16 threads; median 412 ns, sum 1.27 s",
        }
    }
}

/// Writes the picture of `map` as a PNG, with the run's ID if it has one.
///
/// # Errors
/// An error of `out`.
pub fn write(map: &CostMap, run: Option<RunId>, out: &mut impl Write) -> io::Result<()> {
    let picture = draw(map);
    let run = run.map(|run| run.to_string());
    let texts: Vec<_> = run.iter().map(|run| (provenance::KEY, &**run)).collect();
    let size = picture.dimensions().into();
    png::write(size, 3, &texts, out, |rows| rows.write_all(&picture))
}

/// Draws `map` with its title, color bar and footer.
///
/// Each value becomes a square of n by n pixels, where n is the smallest integer for which the
/// longer side of the map has at least 600 pixels. The font size is 2 % of that side, and at most an
/// eighth of the shorter one, within 14 to 160 pixels. The same map gives the same picture, and no
/// value causes a panic.
fn draw(map: &CostMap) -> RgbImage {
    debug_assert_eq!(map.values.len(), map.width as usize * map.height as usize);
    let colors = Colors::over(&map.range);
    let layout = Layout::new(map);

    let mut picture = RgbImage::new(layout.width as u32, layout.height as u32);
    picture.fill(PAPER);
    for text in &layout.texts {
        let at = [layout.map.x, text.baseline];
        picture.lines(&text.lines, at, Anchor::Start, &text.style);
    }
    paint_map(&mut picture, map, &colors, &layout);
    layout.bar.draw(&mut picture, layout.bar_corner, &colors);
    picture
}

/// Paints the frame and the values, each magnified to a square.
fn paint_map(picture: &mut RgbImage, map: &CostMap, colors: &Colors, layout: &Layout) {
    let at = layout.map;
    picture.rect(at.grown(line_px(layout.em_px)), LINE);

    let (width, n_copies) = (map.width as usize, layout.magnification as usize);
    let picture_width = picture.width() as usize;
    let in_map = at.x as usize..at.right() as usize;
    let (pixels, _) = picture.as_chunks_mut::<3>();
    let rows = pixels[at.y as usize * picture_width..].par_chunks_mut(picture_width * n_copies);
    let rows = rows.zip(map.values.par_chunks(width)).with_min_len(ROWS);
    rows.for_each(|(rows, values)| {
        let (first, copies) = rows.split_at_mut(picture_width);
        let first = &mut first[in_map.clone()];
        for (square, color) in first.chunks_exact_mut(n_copies).zip(colors.look_up(values)) {
            square.fill(color.0);
        }
        for copy in copies.chunks_mut(picture_width) {
            copy[in_map.clone()].copy_from_slice(first);
        }
    });
}

#[cfg(test)]
mod tests;
