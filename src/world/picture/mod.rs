//! Pictures as functions: colors at any point between the texels.
//!
//! A [`Picture`] has the texels of a file and copies at half the size, a quarter, and so on.
//! [`Sampling`] selects the filter of a lookup.

mod texels;
mod half;
mod levels;
mod wrap;
#[cfg(test)]
mod tests;

use base::keywords;
use levels::{MipLevel, SmallerTexels};
use math::simd::{Arithmetic, Real};
pub use texels::Texels;
pub use wrap::Wrap;

/// A rectangle of texels: red, green and blue as linear light, and the opacity.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// The whole picture, with sides from 1 to [`Picture::MAX_SIDE`], and its smaller
    /// copies, down to one texel.
    levels: Vec<MipLevel>,
    /// The texels of the whole picture, row by row, row 0 on top.
    texels: Texels,
    /// The texels of its smaller copies.
    smaller: SmallerTexels,
    /// True if no texel is transparent.
    is_opaque: bool,
}

/// The lookup of a picture between its texels and beyond its edges.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Sampling {
    /// The filter between the texels.
    pub filter: TexelFilter,
    /// The continuation beyond the edges.
    pub wrap: Wrap,
}

keywords! {
    /// The filter between the texels of a picture.
    #[derive(Default)]
    pub enum TexelFilter {
        /// Between texels, and between the two copies closest to the ray's footprint.
        #[default]
        Trilinear = "trilinear",
        /// Between the four nearest texels of the whole picture.
        Bilinear = "bilinear",
        /// The nearest texel.
        Nearest = "nearest",
    }
}

impl Picture {
    /// Maximum number of columns and of rows: all texel coordinates are then exact as 32-bit
    /// floats, with eight more bits for the position between two.
    pub const MAX_SIDE: u32 = 1 << 16;

    /// Creates a picture of these texels, row by row, row 0 on top; `None` if a side is 0 or too
    /// large, or if there are not `width * height` texels.
    pub fn new(size: [u32; 2], texels: Texels) -> Option<Self> {
        let n_texels = size[0] as usize * size[1] as usize;
        let is_usable = size.iter().all(|side| (1..=Self::MAX_SIDE).contains(side));
        (is_usable && texels.len() == n_texels).then(|| Self::with_levels(size, texels))
    }

    fn with_levels(size: [u32; 2], texels: Texels) -> Self {
        let (levels, smaller) = levels::build(size, &texels);
        Self {
            is_opaque: texels.are_opaque(),
            levels,
            texels,
            smaller,
        }
    }

    /// Returns the numbers of columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.levels[0].size
    }

    /// Returns true if no texel is transparent.
    pub fn is_opaque(&self) -> bool {
        self.is_opaque
    }

    /// Returns the memory in bytes.
    pub fn n_bytes(&self) -> u64 {
        self.texels.n_bytes() + self.smaller.n_bytes()
    }

    /// Returns red, green, blue and opacity at a point: `u` goes from 0 at the left edge to 1 at
    /// the right one, `v` from 0 at the lower edge to 1 at the upper one. `footprint` is the side
    /// of the square to average, in units of `u` and `v`.
    pub fn at(&self, sampling: Sampling, [u, v]: [f32; 2], footprint: f32) -> [f32; 4] {
        let wrap = sampling.wrap;
        let place = [wrap.folded(u), 1.0 - wrap.folded(v)];
        match sampling.filter {
            TexelFilter::Nearest => self.nearest(place),
            TexelFilter::Bilinear => self.between(self.levels[0], [wrap; 2], place),
            TexelFilter::Trilinear => self.filtered(wrap, place, footprint),
        }
    }

    /// Returns red, green, blue and opacity of an equirectangular picture at a point: linearly
    /// between its texels, and around from its right edge to the left.
    pub fn around(&self, [u, v]: [f32; 2]) -> [f32; 4] {
        let wraps = [Wrap::Repeat, Wrap::Clamp];
        let place = [Wrap::Repeat.folded(u), 1.0 - Wrap::Clamp.folded(v)];
        self.between(self.levels[0], wraps, place)
    }

    /// Returns the largest copy with at most this number of texels: the numbers of columns and
    /// rows, and the texels row by row, row 0 on top.
    pub fn reduced(&self, n_texels: usize) -> ([u32; 2], impl Iterator<Item = [f32; 4]>) {
        let is_small = |level: &&MipLevel| level.n_texels() <= n_texels;
        let last = self.levels[self.levels.len() - 1];
        let level = *self.levels.iter().find(is_small).unwrap_or(&last);
        let texels = level.first..level.first + level.n_texels();
        (level.size, texels.map(|i| self.get(i)))
    }

    /// Returns the picture for other devices: the number of its copies; for each its columns, its
    /// rows and the index of its first texel; then the four values of all texels.
    ///
    /// # Errors
    /// An index has more than 32 bits.
    pub fn words(&self) -> Result<impl Iterator<Item = u32>, &'static str> {
        let last = self.levels[self.levels.len() - 1];
        if u32::try_from(last.first).is_err() {
            return Err("a picture of more than 2^32 texels");
        }
        let levels = self.levels.iter();
        let levels = levels.flat_map(|level| [level.size[0], level.size[1], level.first as u32]);
        let n_texels = self.levels.iter().map(MipLevel::n_texels).sum();
        let texels = (0..n_texels).flat_map(|i| self.get(i).map(f32::to_bits));
        let n_levels = std::iter::once(self.levels.len() as u32);
        Ok(n_levels.chain(levels).chain(texels))
    }

    fn nearest(&self, [x, y]: [f32; 2]) -> [f32; 4] {
        let whole = self.levels[0];
        let [width, height] = whole.size;
        self.texel(whole, nearest(x, width), nearest(y, height))
    }

    /// Returns the mean of the four nearest texels, weighted by their distance.
    fn between(&self, level: MipLevel, [wrap_x, wrap_y]: [Wrap; 2], [x, y]: [f32; 2]) -> [f32; 4] {
        let [width, height] = level.size;
        let ([left, right], across) = wrap_x.neighbors(x, width);
        let ([upper, lower], down) = wrap_y.neighbors(y, height);
        let texel = |column, row| self.texel(level, column, row);
        let above = mix(texel(left, upper), texel(right, upper), across);
        let below = mix(texel(left, lower), texel(right, lower), across);
        mix(above, below, down)
    }

    /// Interpolates between the levels whose texels are next smaller and next larger than the
    /// footprint.
    fn filtered(&self, wrap: Wrap, place: [f32; 2], footprint: f32) -> [f32; 4] {
        let [width, height] = self.levels[0].size.map(|side| side as f32);
        let n_texels = footprint * (width * height).sqrt();
        let last = self.levels.len() - 1;
        // False for NaN.
        if n_texels > 1.0 && last > 0 {
            let level = Arithmetic::min(libm::log2f(n_texels), last as f32);
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
        self.get(level.first + row as usize * width as usize + column as usize)
    }

    /// Returns linear light and opacity of texel `i` of all levels.
    #[inline(always)]
    fn get(&self, i: usize) -> [f32; 4] {
        match i.checked_sub(self.levels[0].n_texels()) {
            None => self.texels.get(i),
            Some(i) => self.smaller.get(i),
        }
    }
}

/// One white texel.
impl Default for Picture {
    fn default() -> Self {
        Self::with_levels([1, 1], Texels::Floats(vec![[1.0; 4]]))
    }
}

/// Returns the texel, of `n` in a row, that contains a position from 0 to 1.
#[inline(always)]
fn nearest(place: f32, n: u32) -> u32 {
    (Real::floor(place * n as f32) as u32).min(n - 1)
}

/// Interpolates linearly between `a` at 0 and `b` at 1.
#[inline(always)]
fn mix(a: [f32; 4], b: [f32; 4], place: f32) -> [f32; 4] {
    let mut mixed = a;
    for (channel, b) in mixed.iter_mut().zip(b) {
        *channel += (b - *channel) * place;
    }
    mixed
}
