//! The per-pixel cost map as a self-explaining picture: title, subtitle, map, colour bar, footer.
//!
//! Takes one value a pixel, gives an RGB picture that can be read without any other
//! tool. Cost spans decades, so the colours (Inferno, perceptually uniform) follow the logarithm.
//! `range` decides which values the colours span, so that one interrupted pixel does not flatten
//! the rest; the footer and the tips of the colour bar say what was cut off. What a pixel's cost
//! changed by is drawn the same way, in colours that part at zero.

// In the order of the data; each uses only those above it.
mod canvas;
mod census;
mod range;
mod colours;
mod ticks;
mod label;
mod footer;
mod text;
mod bar;
mod layout;

use image::RgbImage;

use canvas::{GREY_INK, INK, LINE, PAPER};
use colours::Colours;
use layout::Layout;
pub use range::{Range, Scale};
use text::Style;
pub use ticks::{Ticks, ticks, ticks_around_zero};

/// What the picture shows.
#[derive(Clone, Copy, Debug)]
pub struct CostMap<'a> {
    /// One value a pixel, row-major, `width * height`, row 0 on top. Infinite and NaN values, on a
    /// logarithmic scale also zero, negative and subnormal ones, are drawn mid-grey.
    pub values: &'a [f32],
    /// How the values are spread over the colours.
    pub scale: Scale,
    /// Pixels a row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Headline, say "spheres: time per pixel"; cut with an ellipsis where it does not fit.
    pub title: &'a str,
    /// Unit of the values. "ns" is labelled in ns, µs, ms and s; the values of any other unit, say
    /// "node visits", in k, M and G, and the footer names the unit.
    pub unit: &'a str,
    /// Grey line under the title, say "400 x 300, median 412 ns"; empty for none.
    pub subtitle: &'a str,
}

/// Draws `map` with its heading, colour bar and footer.
///
/// One value becomes a square of n by n picture pixels, n the smallest integer that makes the
/// longer side of the map at least 600 pixels. Text is 2 % of that side, within 14 to 160 pixels.
/// The same map gives the same picture, and no value of any kind makes this panic.
pub fn draw(map: &CostMap) -> RgbImage {
    debug_assert_eq!(map.values.len(), map.width as usize * map.height as usize);
    let range = Range::on(map.scale, map.values);
    let colours = Colours::over(&range);
    let layout = Layout::of(map, &range);

    let mut picture = RgbImage::new(layout.width, layout.height);
    picture.fill(PAPER);
    paint_text(&mut picture, map, &range, &layout);
    paint_map(&mut picture, map, &colours, &layout);
    layout.bar.paint(&mut picture, layout.bar_corner, &colours);
    picture
}

/// Paints title, subtitle and footer.
fn paint_text(picture: &mut RgbImage, map: &CostMap, range: &Range, layout: &Layout) {
    let footer = footer::line(map.unit, range);
    let lines = [
        (map.title, layout::TITLE_EM, INK, layout.title_baseline),
        (map.subtitle, 1.0, GREY_INK, layout.subtitle_baseline),
        (&footer, layout::FOOTER_EM, GREY_INK, layout.footer_baseline),
    ];
    for (line, size_em, colour, baseline) in lines {
        let style = Style::new(size_em * layout.em_px, colour);
        let line = style.fitted(line, layout.text_width);
        style.paint(picture, &line, layout.map.x, baseline);
    }
}

/// Paints the frame and the values, each magnified to a square.
fn paint_map(picture: &mut RgbImage, map: &CostMap, colours: &Colours, layout: &Layout) {
    let at = layout.map;
    let frame = at.grown(canvas::line_px(layout.em_px));
    canvas::fill_rect(picture, frame, LINE);

    let (width, n_copies) = (map.width as usize, layout.magnification as usize);
    let picture_width = picture.width() as usize;
    let in_map = at.x as usize..at.right() as usize;
    let (pixels, _) = picture.as_chunks_mut::<3>();
    let rows = pixels[at.y as usize * picture_width..].chunks_mut(picture_width * n_copies);
    for (rows, values) in rows.zip(map.values.chunks(width)) {
        let (first, copies) = rows.split_at_mut(picture_width);
        let first = &mut first[in_map.clone()];
        for (square, &value) in first.chunks_mut(n_copies).zip(values) {
            square.fill(colours.of(value).0);
        }
        for copy in copies.chunks_mut(picture_width) {
            copy[in_map.clone()].copy_from_slice(first);
        }
    }
}

#[cfg(test)]
mod tests;
