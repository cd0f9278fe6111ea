//! Texels in memory.

use glam::Vec3;

use crate::color::Transfer;

/// Texels as they are stored: red, green, blue and opacity.
#[derive(Debug, Clone, PartialEq)]
pub enum Texels {
    /// Four bytes each. Those of colors are numbers of this transfer function.
    Bytes(Vec<[u8; 4]>, Transfer),
    /// Linear light, finite and at least 0.
    Floats(Vec<[f32; 4]>),
}

impl Texels {
    /// Number of texels.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Bytes(texels, _) => texels.len(),
            Self::Floats(texels) => texels.len(),
        }
    }

    /// Whether none is transparent.
    pub(super) fn are_opaque(&self) -> bool {
        match self {
            Self::Bytes(texels, _) => texels.iter().all(|&[.., opacity]| opacity == u8::MAX),
            Self::Floats(texels) => texels.iter().all(|&[.., opacity]| opacity == 1.0),
        }
    }

    /// Their memory in bytes.
    pub(super) fn n_bytes(&self) -> u64 {
        match self {
            Self::Bytes(texels, _) => size_of_val(&texels[..]) as u64,
            Self::Floats(texels) => size_of_val(&texels[..]) as u64,
        }
    }

    /// Appends texels of linear light and opacity, rounded to bytes if these are bytes.
    pub(super) fn append(&mut self, light: &[[f32; 4]]) {
        match self {
            Self::Floats(texels) => texels.extend(light),
            Self::Bytes(texels, transfer) => {
                texels.extend(light.iter().map(|&[r, g, b, a]| {
                    let [r, g, b] = transfer.bytes(Vec3::new(r, g, b));
                    let [a, ..] = Transfer::Linear.bytes(Vec3::splat(a));
                    [r, g, b, a]
                }));
            }
        }
    }

    /// Multiplies all colors by one, each channel from 0 to 1.
    pub fn multiply(&mut self, color: Vec3) {
        if color == Vec3::ONE {
            return;
        }
        match self {
            Self::Floats(texels) => {
                for [r, g, b, _] in texels {
                    [*r, *g, *b] = (Vec3::new(*r, *g, *b) * color).to_array();
                }
            }
            Self::Bytes(texels, transfer) => {
                let light = transfer.light_of_bytes();
                for [r, g, b, _] in texels {
                    let texel = Vec3::from([*r, *g, *b].map(|number| light[usize::from(number)]));
                    [*r, *g, *b] = transfer.bytes(texel * color);
                }
            }
        }
    }

    /// Makes room for so many more.
    pub(super) fn reserve(&mut self, n_more: usize) {
        match self {
            Self::Floats(texels) => texels.reserve_exact(n_more),
            Self::Bytes(texels, _) => texels.reserve_exact(n_more),
        }
    }

    /// Linear light and opacity of texel `i`.
    #[inline(always)]
    pub(super) fn get(&self, i: usize) -> [f32; 4] {
        match self {
            Self::Floats(texels) => texels[i],
            Self::Bytes(texels, transfer) => {
                let light = transfer.light_of_bytes();
                let [r, g, b, a] = texels[i].map(usize::from);
                let opacity = Transfer::Linear.light_of_bytes();
                [light[r], light[g], light[b], opacity[a]]
            }
        }
    }
}
