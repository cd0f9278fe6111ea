//! Copies of a picture at half the size, a quarter and so on: mip levels.
//!
//! Williams, "Pyramidal Parametrics", SIGGRAPH 1983.

use super::half::Half;
use super::texels::{Texels, light_of, rgba_light};

/// One size of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct MipLevel {
    /// Numbers of columns and rows.
    pub(super) size: [u32; 2],
    /// The index of the first texel among those of all levels.
    pub(super) first: usize,
}

impl MipLevel {
    pub(super) fn n_texels(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }
}

/// The texels of the smaller copies, level by level: linear light and opacity in the channels of the
/// whole picture. Bytes would be up to 3 % too dark or too bright for a mean of dark texels.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum SmallerTexels {
    Gray(Vec<[Half; 1]>),
    Rgb(Vec<[Half; 3]>),
    Rgba(Vec<[Half; 4]>),
    Floats(Vec<[f32; 4]>),
}

impl SmallerTexels {
    /// Returns linear light and opacity of texel `i`.
    #[inline(always)]
    pub(super) fn get(&self, i: usize) -> [f32; 4] {
        match self {
            Self::Floats(texels) => texels[i],
            Self::Rgba(texels) => texels[i].map(Half::get),
            Self::Rgb(texels) => {
                let [r, g, b] = texels[i].map(Half::get);
                [r, g, b, 1.0]
            }
            Self::Gray(texels) => {
                let [gray] = texels[i].map(Half::get);
                [gray, gray, gray, 1.0]
            }
        }
    }

    /// Returns the memory in bytes.
    pub(super) fn n_bytes(&self) -> u64 {
        let n_bytes = match self {
            Self::Gray(texels) => size_of_val(&texels[..]),
            Self::Rgb(texels) => size_of_val(&texels[..]),
            Self::Rgba(texels) => size_of_val(&texels[..]),
            Self::Floats(texels) => size_of_val(&texels[..]),
        };
        n_bytes as u64
    }
}

/// Returns all levels of a picture with these texels, the whole picture first, and the texels of the
/// smaller copies, down to one texel.
pub(super) fn build(size: [u32; 2], whole: &Texels) -> (Vec<MipLevel>, SmallerTexels) {
    let mut levels = vec![MipLevel { size, first: 0 }];
    let all = &mut levels;
    let smaller = match whole {
        Texels::Floats(texels) => {
            SmallerTexels::Floats(build_of(all, |i| texels[i], |light| light))
        }
        Texels::Bytes(texels, transfer) => {
            let light = |i: usize| rgba_light(texels[i], *transfer);
            SmallerTexels::Rgba(build_of(all, light, halves))
        }
        Texels::Rgb(texels, transfer) => {
            let light = |i: usize| light_of(texels[i], *transfer);
            SmallerTexels::Rgb(build_of(all, light, halves))
        }
        Texels::Gray(texels, transfer) => {
            let light = |i: usize| light_of([texels[i]], *transfer);
            SmallerTexels::Gray(build_of(all, light, halves))
        }
    };
    (levels, smaller)
}

fn halves<const C: usize>(light: [f32; C]) -> [Half; C] {
    light.map(Half::nearest)
}

/// Adds the smaller levels to that of the whole picture, whose texels have the linear light `whole`;
/// returns their texels as `stored`.
fn build_of<T, const C: usize>(
    levels: &mut Vec<MipLevel>,
    whole: impl Fn(usize) -> [f32; C],
    stored: impl Fn([f32; C]) -> T,
) -> Vec<T> {
    // A third of the texels, and a few more if sides are not powers of two or differ much.
    let mut texels = Vec::with_capacity(levels[0].n_texels() / 3);
    // The level before, not yet rounded.
    let mut before: Option<Vec<[f32; C]>> = None;
    let mut from = levels[0];
    while from.size != [1, 1] {
        let to = MipLevel {
            size: from.size.map(|side| (side / 2).max(1)),
            first: from.first + from.n_texels(),
        };
        let smaller = match &before {
            None => reduced(&whole, from.size, to.size),
            Some(before) => reduced(|i| before[i], from.size, to.size),
        };
        texels.extend(smaller.iter().map(|light| stored(*light)));
        before = Some(smaller);
        levels.push(to);
        from = to;
    }
    texels
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
