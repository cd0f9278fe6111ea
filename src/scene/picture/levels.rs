//! Copies of a picture at half the size, a quarter and so on: mip levels.
//!
//! Williams, "Pyramidal Parametrics", SIGGRAPH 1983.

use glam::Vec3;

use super::texels::{Texels, light_of, rgba_bytes, rgba_light};

/// One size of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct MipLevel {
    /// Numbers of columns and rows.
    pub(super) size: [u32; 2],
    /// The index of the first texel.
    pub(super) first: usize,
}

impl MipLevel {
    pub(super) fn n_texels(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }
}

/// Appends smaller copies to the texels of a picture, down to one texel; returns all
/// levels, the whole picture first.
pub(super) fn build(size: [u32; 2], texels: &mut Texels) -> Vec<MipLevel> {
    match texels {
        Texels::Floats(texels) => build_of(size, texels, |light| light, |light| light),
        Texels::Bytes(texels, transfer) => {
            let (light, stored) = (
                |of| rgba_light(of, *transfer),
                |of| rgba_bytes(of, *transfer),
            );
            build_of(size, texels, light, stored)
        }
        Texels::Rgb(texels, transfer) => {
            let stored = |light: [f32; 3]| transfer.bytes(Vec3::from(light));
            build_of(size, texels, |of| light_of(of, *transfer), stored)
        }
        Texels::Gray(texels, transfer) => {
            let stored = |[gray]: [f32; 1]| transfer.bytes(Vec3::splat(gray))[0];
            build_of(size, texels, |of| light_of([of], *transfer), stored)
        }
    }
}

/// Builds the levels for texels of `C` channels, which `light` decodes to linear light, and
/// `stored` encodes.
fn build_of<T: Copy, const C: usize>(
    size: [u32; 2],
    texels: &mut Vec<T>,
    light: impl Fn(T) -> [f32; C],
    stored: impl Fn([f32; C]) -> T,
) -> Vec<MipLevel> {
    let mut levels = vec![MipLevel { size, first: 0 }];
    // A third of the texels, and a few more if sides are not powers of two or differ much.
    texels.reserve_exact(levels[0].n_texels() / 3);
    // The level before, not yet rounded to bytes.
    let mut before: Option<Vec<[f32; C]>> = None;
    let mut from = levels[0];
    while from.size != [1, 1] {
        let to = MipLevel {
            size: from.size.map(|side| (side / 2).max(1)),
            first: from.first + from.n_texels(),
        };
        let smaller = match &before {
            None => reduced(|i| light(texels[i]), from.size, to.size),
            Some(before) => reduced(|i| before[i], from.size, to.size),
        };
        texels.extend(smaller.iter().map(|light| stored(*light)));
        before = Some(smaller);
        levels.push(to);
        from = to;
    }
    levels
}

/// Shrinks a picture: each texel is the mean of the rectangle that it covers.
fn reduced<const C: usize>(
    texel: impl Fn(usize) -> [f32; C],
    [width, height]: [u32; 2],
    [columns, rows]: [u32; 2],
) -> Vec<[f32; C]> {
    let n_covered =
        (f64::from(width) * f64::from(height) / (f64::from(columns) * f64::from(rows))) as f32;
    let mut smaller = Vec::with_capacity(columns as usize * rows as usize);
    for row in 0..rows {
        for column in 0..columns {
            let mut mean = [0.0; C];
            for (y, down) in covered(row, rows, height) {
                for (x, across) in covered(column, columns, width) {
                    let weight = across * down / n_covered;
                    let found = texel(y as usize * width as usize + x as usize);
                    for (mean, channel) in mean.iter_mut().zip(found) {
                        *mean += weight * channel;
                    }
                }
            }
            smaller.push(mean);
        }
    }
    smaller
}

/// Returns the texels, of `n` in a row, that number `i` of `n_fewer` covers, each with its covered
/// share.
fn covered(i: u32, n_fewer: u32, n: u32) -> impl Iterator<Item = (u32, f32)> {
    let [i, n_fewer, n] = [i, n_fewer, n].map(u64::from);
    // In units in which a texel of the larger picture has length `n_fewer`, and of the smaller one
    // `n`.
    let (begin, end) = (i * n, (i + 1) * n);
    (begin / n_fewer..end.div_ceil(n_fewer)).map(move |x| {
        let shared = end.min((x + 1) * n_fewer) - begin.max(x * n_fewer);
        (x as u32, shared as f32 / n_fewer as f32)
    })
}
