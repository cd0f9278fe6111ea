//! The continuation of pictures beyond their edges.

use base::keywords;
use math::simd::{Arithmetic, Real};

keywords! {
    /// The continuation of a picture beyond its edges.
    #[derive(Default)]
    pub enum Wrap {
        /// Repeated.
        #[default]
        Repeat = "repeat",
        /// The nearest edge continues.
        Clamp = "clamp",
        /// Repeated, every other copy mirrored.
        Mirror = "mirror",
    }
}

impl Wrap {
    /// Maps any position in the plane to the picture, from 0 to 1; 0 for NaN.
    #[inline(always)]
    pub(super) fn folded(self, place: f32) -> f32 {
        let folded = match self {
            Self::Repeat => place - Real::floor(place),
            Self::Clamp => place,
            Self::Mirror => {
                let half = 0.5 * place;
                let in_pair = 2.0 * (half - Real::floor(half));
                1.0 - (1.0 - in_pair).abs()
            }
        };
        // `max` turns NaN into 0, also if it came from infinity.
        Arithmetic::min(Arithmetic::max(folded, 0.0), 1.0)
    }

    /// Returns the texels, of `n` in a row, on both sides of a position from 0 to 1, and the
    /// position between their centers, from 0 to 1.
    #[inline(always)]
    pub(super) fn neighbors(self, place: f32, n: u32) -> ([u32; 2], f32) {
        let at = place * n as f32 - 0.5;
        let before = Real::floor(at);
        let first = before as i32;
        (
            [self.texel(first, n), self.texel(first + 1, n)],
            at - before,
        )
    }

    /// Returns the texel for an index from -1 to `n`.
    #[inline(always)]
    fn texel(self, index: i32, n: u32) -> u32 {
        let last = n as i32 - 1;
        let wrapped = match self {
            Self::Repeat if index < 0 => last,
            Self::Repeat if index > last => 0,
            // A mirrored edge meets itself.
            _ => index.clamp(0, last),
        };
        wrapped as u32
    }
}
