//! Texels in memory.

use crate::color::Transfer;

/// Texels as they are stored: red, green, blue and opacity. Byte texels have only the channels of
/// the file, with colors encoded by the transfer function.
#[derive(Debug, Clone, PartialEq)]
pub enum Texels {
    /// One byte per texel, for all three colors.
    Gray(Vec<u8>, Transfer),
    /// Three bytes per texel.
    Rgb(Vec<[u8; 3]>, Transfer),
    /// Four bytes per texel.
    Bytes(Vec<[u8; 4]>, Transfer),
    /// Linear light, finite and at least 0.
    Floats(Vec<[f32; 4]>),
}

/// Returns the linear light of color bytes, and the share for an opacity byte.
#[inline(always)]
pub(super) fn light_of<const C: usize>(bytes: [u8; C], transfer: Transfer) -> [f32; C] {
    let light = transfer.light_of_bytes();
    bytes.map(|byte| light[usize::from(byte)])
}

impl Texels {
    /// Returns the number of texels.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Gray(texels, _) => texels.len(),
            Self::Rgb(texels, _) => texels.len(),
            Self::Bytes(texels, _) => texels.len(),
            Self::Floats(texels) => texels.len(),
        }
    }

    /// Returns true if no texel is transparent.
    pub(super) fn are_opaque(&self) -> bool {
        match self {
            Self::Gray(..) | Self::Rgb(..) => true,
            Self::Bytes(texels, _) => texels.iter().all(|&[.., opacity]| opacity == u8::MAX),
            Self::Floats(texels) => texels.iter().all(|&[.., opacity]| opacity == 1.0),
        }
    }

    /// Returns the memory in bytes.
    pub(super) fn n_bytes(&self) -> u64 {
        let n_bytes = match self {
            Self::Gray(texels, _) => size_of_val(&texels[..]),
            Self::Rgb(texels, _) => size_of_val(&texels[..]),
            Self::Bytes(texels, _) => size_of_val(&texels[..]),
            Self::Floats(texels) => size_of_val(&texels[..]),
        };
        n_bytes as u64
    }

    /// Returns linear light and opacity of texel `i`.
    #[inline(always)]
    pub(super) fn get(&self, i: usize) -> [f32; 4] {
        match self {
            Self::Floats(texels) => texels[i],
            Self::Bytes(texels, transfer) => rgba_light(texels[i], *transfer),
            Self::Rgb(texels, transfer) => {
                let [r, g, b] = light_of(texels[i], *transfer);
                [r, g, b, 1.0]
            }
            Self::Gray(texels, transfer) => {
                let [gray] = light_of([texels[i]], *transfer);
                [gray, gray, gray, 1.0]
            }
        }
    }
}

/// Returns linear light and opacity of four bytes.
#[inline(always)]
pub(super) fn rgba_light([r, g, b, a]: [u8; 4], transfer: Transfer) -> [f32; 4] {
    let ([r, g, b], [a]) = (
        light_of([r, g, b], transfer),
        light_of([a], Transfer::Linear),
    );
    [r, g, b, a]
}
