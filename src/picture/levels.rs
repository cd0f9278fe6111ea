//! Copies of a picture at half the size, a quarter and so on: mip levels.
//!
//! Williams, "Pyramidal Parametrics", SIGGRAPH 1983.

use super::texels::Texels;

/// One of the sizes of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct MipLevel {
    /// Numbers of columns and rows.
    pub(super) size: [u32; 2],
    /// The index of its first texel.
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
    let mut levels = vec![MipLevel { size, first: 0 }];
    // A third of the texels, and a few where sides are not powers of two or far apart.
    texels.reserve(levels[0].n_texels() / 3);
    // Of the level before, not yet rounded to bytes.
    let mut before: Option<Vec<[f32; 4]>> = None;
    let mut from = levels[0];
    while from.size != [1, 1] {
        let to = MipLevel {
            size: from.size.map(|side| (side / 2).max(1)),
            first: from.first + from.n_texels(),
        };
        let smaller = match &before {
            None => reduced(|i| texels.get(i), from.size, to.size),
            Some(texels) => reduced(|i| texels[i], from.size, to.size),
        };
        texels.append(&smaller);
        before = Some(smaller);
        levels.push(to);
        from = to;
    }
    levels
}

/// Each texel is the mean of the rectangle that it covers.
fn reduced(
    texel: impl Fn(usize) -> [f32; 4],
    [width, height]: [u32; 2],
    [columns, rows]: [u32; 2],
) -> Vec<[f32; 4]> {
    let n_covered =
        (f64::from(width) * f64::from(height) / (f64::from(columns) * f64::from(rows))) as f32;
    let mut smaller = Vec::with_capacity(columns as usize * rows as usize);
    for row in 0..rows {
        for column in 0..columns {
            let mut mean = [0.0; 4];
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

/// The texels of `n` in a row that number `i` of `n_fewer` covers, each with the share of
/// it that is covered.
fn covered(i: u32, n_fewer: u32, n: u32) -> impl Iterator<Item = (u32, f32)> {
    let [i, n_fewer, n] = [i, n_fewer, n].map(u64::from);
    // In units of which a texel of the larger picture has `n_fewer`, one of the smaller `n`.
    let (begin, end) = (i * n, (i + 1) * n);
    (begin / n_fewer..end.div_ceil(n_fewer)).map(move |x| {
        let shared = end.min((x + 1) * n_fewer) - begin.max(x * n_fewer);
        (x as u32, shared as f32 / n_fewer as f32)
    })
}
