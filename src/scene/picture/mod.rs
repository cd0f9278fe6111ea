//! Pictures as functions: colors at any point between the texels.
//!
//! A [`Picture`] has the texels of a file and the same again at half the size, a quarter,
//! and so on. [`Sampling`] says how one is looked up.

mod levels;
mod texels;
mod wrap;
#[cfg(test)]
mod tests;

use serde::Deserialize;

use levels::MipLevel;
use math::simd::Real;
pub use texels::Texels;
pub use wrap::Wrap;

/// A rectangle of texels: linear light of red, green and blue, and the opacity.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// The whole picture, with sides from 1 to [`Picture::MAX_SIDE`], and its smaller
    /// copies, down to one texel.
    levels: Vec<MipLevel>,
    /// MipLevel by level and row by row, row 0 on top.
    texels: Texels,
    /// Whether no texel is transparent.
    is_opaque: bool,
}

/// How a picture is looked up between its texels and beyond its edges.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Sampling {
    /// Between the texels.
    pub filter: TexelFilter,
    /// Beyond the edges.
    pub wrap: Wrap,
}

/// How a picture is looked up between its texels.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(
    rename_all = "snake_case",
    expecting = "`trilinear`, `bilinear` or `nearest`"
)]
pub enum TexelFilter {
    /// Linearly between the four nearest texels of two copies of the picture, with texels
    /// as large as what one ray stands for.
    #[default]
    Trilinear,
    /// Linearly between the four nearest texels of the whole picture.
    Bilinear,
    /// The nearest texel of the whole picture.
    Nearest,
}

impl Picture {
    /// Largest number of columns and of rows: all coordinates of texels then are exact
    /// numbers of 32 bits, with eight more bits for the place between two.
    pub const MAX_SIDE: u32 = 1 << 16;

    /// A picture of these texels, row by row, row 0 on top; `None` if a side is 0 or too
    /// large, or if these are not `width * height` texels.
    pub fn new(size: [u32; 2], mut texels: Texels) -> Option<Self> {
        let n_texels = size[0] as usize * size[1] as usize;
        let is_usable = size.iter().all(|side| (1..=Self::MAX_SIDE).contains(side));
        (is_usable && texels.len() == n_texels).then(|| Self {
            is_opaque: texels.are_opaque(),
            levels: levels::build(size, &mut texels),
            texels,
        })
    }

    /// Numbers of columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.levels[0].size
    }

    /// Whether no texel is transparent.
    pub fn is_opaque(&self) -> bool {
        self.is_opaque
    }

    /// Its memory in bytes.
    pub fn n_bytes(&self) -> u64 {
        self.texels.n_bytes()
    }

    /// Red, green, blue and opacity at a point: `u` goes from 0 at the left edge to 1 at
    /// the right one, `v` from 0 at the lower edge to 1 at the upper one. `footprint` is
    /// the side of the square that the color is that of, in units of `u` and `v`.
    pub fn at(&self, sampling: Sampling, [u, v]: [f32; 2], footprint: f32) -> [f32; 4] {
        let wrap = sampling.wrap;
        let place = [wrap.folded(u), 1.0 - wrap.folded(v)];
        match sampling.filter {
            TexelFilter::Nearest => self.nearest(place),
            TexelFilter::Bilinear => self.between(self.levels[0], [wrap; 2], place),
            TexelFilter::Trilinear => self.filtered(wrap, place, footprint),
        }
    }

    /// Red, green, blue and opacity of a picture of all directions at a point: linearly
    /// between its texels, and around from its right edge to the left one.
    pub fn around(&self, [u, v]: [f32; 2]) -> [f32; 4] {
        let wraps = [Wrap::Repeat, Wrap::Clamp];
        let place = [Wrap::Repeat.folded(u), 1.0 - Wrap::Clamp.folded(v)];
        self.between(self.levels[0], wraps, place)
    }

    /// The largest of its copies with at most this number of texels: the numbers of columns
    /// and rows, and the texels row by row, row 0 on top.
    pub fn reduced(&self, n_texels: usize) -> ([u32; 2], impl Iterator<Item = [f32; 4]>) {
        let is_small = |level: &&MipLevel| level.n_texels() <= n_texels;
        let last = self.levels[self.levels.len() - 1];
        let level = *self.levels.iter().find(is_small).unwrap_or(&last);
        let texels = level.first..level.first + level.n_texels();
        (level.size, texels.map(|i| self.texels.get(i)))
    }

    fn nearest(&self, [x, y]: [f32; 2]) -> [f32; 4] {
        let whole = self.levels[0];
        let [width, height] = whole.size;
        self.texel(whole, nearest(x, width), nearest(y, height))
    }

    /// The mean of the four nearest texels, weighted by their distance.
    fn between(&self, level: MipLevel, [wrap_x, wrap_y]: [Wrap; 2], [x, y]: [f32; 2]) -> [f32; 4] {
        let [width, height] = level.size;
        let ([left, right], across) = wrap_x.neighbors(x, width);
        let ([upper, lower], down) = wrap_y.neighbors(y, height);
        let texel = |column, row| self.texel(level, column, row);
        let above = mix(texel(left, upper), texel(right, upper), across);
        let below = mix(texel(left, lower), texel(right, lower), across);
        mix(above, below, down)
    }

    /// The mean of the levels whose texels are next smaller and next larger than the
    /// footprint.
    fn filtered(&self, wrap: Wrap, place: [f32; 2], footprint: f32) -> [f32; 4] {
        let [width, height] = self.levels[0].size.map(|side| side as f32);
        let n_texels = footprint * (width * height).sqrt();
        let last = self.levels.len() - 1;
        // Not for NaN.
        if n_texels > 1.0 && last > 0 {
            let level = Real::min(libm::log2f(n_texels), last as f32);
            let finer = (level as usize).min(last - 1);
            let [fine, coarse] = [self.levels[finer], self.levels[finer + 1]];
            return mix(
                self.between(fine, [wrap; 2], place),
                self.between(coarse, [wrap; 2], place),
                level - finer as f32,
            );
        }
        self.between(self.levels[0], [wrap; 2], place)
    }

    #[inline(always)]
    fn texel(&self, level: MipLevel, column: u32, row: u32) -> [f32; 4] {
        let [width, _] = level.size;
        self.texels
            .get(level.first + row as usize * width as usize + column as usize)
    }
}

/// One white texel.
impl Default for Picture {
    fn default() -> Self {
        let mut texels = Texels::Floats(vec![[1.0; 4]]);
        Self {
            levels: levels::build([1, 1], &mut texels),
            texels,
            is_opaque: true,
        }
    }
}

/// The texel of `n` in a row that a place from 0 to 1 is in.
#[inline(always)]
fn nearest(place: f32, n: u32) -> u32 {
    (Real::floor(place * n as f32) as u32).min(n - 1)
}

/// `a` at 0, `b` at 1, linear in between.
#[inline(always)]
fn mix(a: [f32; 4], b: [f32; 4], place: f32) -> [f32; 4] {
    let mut mixed = a;
    for (channel, b) in mixed.iter_mut().zip(b) {
        *channel += (b - *channel) * place;
    }
    mixed
}
