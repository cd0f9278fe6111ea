//! Some rows of a film as a structure of arrays.

use std::ops::Range;

use glam::Vec3;

use super::{Pixel, Rendered};
use crate::config::CostMode;

/// Some rows of a film. Every array is row-major, `width * n_rows` long, with the
/// uppermost row first. Arrays of times are empty without times.
#[derive(Debug, Clone, Default, PartialEq)]
#[expect(missing_docs, reason = "`columns` documents each array")]
pub struct Strip {
    /// The index of the uppermost row; row 0 is at the top of the film.
    pub first_row: u32,
    /// Number of rows.
    pub n_rows: u32,
    pub rgb: Vec<[u8; 3]>,
    /// The point of the pixel's hit in world space; NaN without a hit.
    pub position: Vec<Vec3>,
    pub normal: Vec<Vec3>,
    pub distance: Vec<f32>,
    pub footprint: Vec<f32>,
    pub object: Vec<i32>,
    pub material: Vec<i32>,
    pub time_ns: Vec<f32>,
    /// Empty where no spread was asked for.
    pub time_mad_ns: Vec<f32>,
    pub n_rejected: Vec<u8>,
}

impl Strip {
    pub(super) fn new(first_row: u32, n_rows: u32, width: u32, cost: CostMode) -> Self {
        let n = n_rows as usize * width as usize;
        let n_times = if cost.has_time() { n } else { 0 };
        Self {
            first_row,
            n_rows,
            rgb: vec![[0; 3]; n],
            position: vec![Vec3::ZERO; n],
            normal: vec![Vec3::ZERO; n],
            distance: vec![0.0; n],
            footprint: vec![0.0; n],
            object: vec![0; n],
            material: vec![0; n],
            time_ns: vec![0.0; n_times],
            time_mad_ns: Vec::new(),
            n_rejected: vec![0; n_times],
        }
    }

    /// Writes the pixels `row` of `rendered`, which are adjacent in a row, to the
    /// indices from `first` on of every array.
    pub fn put(&mut self, first: usize, rendered: &Rendered, row: Range<usize>) {
        let places = first..first + row.len();
        self.put_surfaces(places.clone(), &rendered.pixels[row.clone()]);
        if !rendered.times.is_empty() {
            let times = &rendered.times[row];
            fill(&mut self.time_ns[places.clone()], times, |time| time.ns);
            fill(&mut self.n_rejected[places], times, |time| {
                time.is_rejected.into()
            });
        }
    }

    fn put_surfaces(&mut self, places: Range<usize>, pixels: &[Pixel]) {
        // Array by array: one bounds check each, and contiguous writes.
        macro_rules! put {
            ($field:ident, $value:expr) => {
                fill(&mut self.$field[places.clone()], pixels, $value)
            };
        }
        put!(rgb, |pixel| to_rgb8(pixel.color));
        put!(position, |pixel| pixel.position);
        put!(normal, |pixel| pixel.normal);
        put!(distance, |pixel| pixel.distance);
        put!(footprint, |pixel| pixel.footprint);
        put!(object, |pixel| pixel.object);
        put!(material, |pixel| pixel.material);
    }
}

/// Writes one value of each element of `from`.
#[inline(always)]
fn fill<S, T>(places: &mut [T], from: &[S], value: impl Fn(&S) -> T) {
    for (place, from) in places.iter_mut().zip(from) {
        *place = value(from);
    }
}

/// The color clamped to 0..1 and rounded to 8 bits per channel, without gamma.
pub(crate) fn to_rgb8(color: Vec3) -> [u8; 3] {
    (color.clamp(Vec3::ZERO, Vec3::ONE) * 255.0)
        .to_array()
        .map(rounded)
}

/// The integer nearest to a number from 0 to 255, halves rounded up: that of
/// `f32::round`, which is a function call on x86-64 without SSE 4.1.
#[inline(always)]
fn rounded(channel: f32) -> u8 {
    let whole = channel as u8;
    // The difference is exact: it is less than 1.
    whole + u8::from(channel - f32::from(whole) >= 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_equals_that_of_the_standard_library() {
        let halves = (0..255).map(|whole| whole as f32 + 0.5);
        let close = halves.flat_map(|half| [half.next_down(), half, half.next_up()]);
        let everywhere = (0..=255_000).map(|thousandth| thousandth as f32 / 1000.0);
        for channel in close.chain(everywhere) {
            assert_eq!(rounded(channel), channel.round() as u8, "{channel}");
        }
    }
}
