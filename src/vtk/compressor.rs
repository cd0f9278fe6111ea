//! Blocks of an array and what stands before them, as VTK compresses: each of
//! its compressors packs blocks that know nothing of each other.

use std::io;

use miniz_oxide::deflate::compress_to_vec_zlib;
use miniz_oxide::inflate::decompress_slice_iter_to_slice;

use super::Codec;

/// Bytes of a block before it is compressed; the last one of an array may have
/// fewer. Larger ones pack no better, and fewer threads could share them.
pub(crate) const BLOCK: usize = 1 << 18;

/// miniz_oxide's level: level 3 takes 3.6 times as long and saves 2 to 8 % of the
/// bytes, and zlib-rs takes 1.8 times as long to pack as well.
const ZLIB_LEVEL: u8 = 1;

/// What packs and unpacks a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Compressor {
    Lz4,
    Zlib,
}

impl Compressor {
    /// What the codec compresses with, if it does.
    pub(super) fn of(codec: Codec) -> Option<Self> {
        match codec {
            Codec::None => None,
            Codec::Lz4 => Some(Self::Lz4),
            Codec::Zlib => Some(Self::Zlib),
        }
    }

    /// The VTK class that reads it.
    pub(super) fn vtk_class(self) -> &'static str {
        match self {
            Self::Lz4 => "vtkLZ4DataCompressor",
            Self::Zlib => "vtkZLibDataCompressor",
        }
    }

    /// The compressor of a VTK class, if it is one of ours.
    pub(crate) fn of_vtk_class(name: &str) -> Option<Self> {
        let all = [Self::Lz4, Self::Zlib];
        all.into_iter().find(|each| each.vtk_class() == name)
    }

    /// How many bytes one byte of a packed block stands for at most.
    pub(crate) fn max_ratio(self) -> u64 {
        match self {
            Self::Lz4 => Codec::Lz4.max_ratio(),
            Self::Zlib => Codec::Zlib.max_ratio(),
        }
    }

    /// Packs a block.
    pub(super) fn pack(self, block: &[u8]) -> Vec<u8> {
        match self {
            Self::Lz4 => lz4_flex::block::compress(block),
            Self::Zlib => compress_to_vec_zlib(block, ZLIB_LEVEL),
        }
    }

    /// Unpacks a block of known length.
    ///
    /// # Errors
    /// If that is not what was packed.
    pub(crate) fn unpack(self, packed: &[u8], block: &mut [u8]) -> io::Result<()> {
        let n_bytes = match self {
            Self::Lz4 => lz4_flex::block::decompress_into(packed, block).ok(),
            Self::Zlib => {
                let parts = std::iter::once(packed);
                decompress_slice_iter_to_slice(block, parts, true, false).ok()
            }
        };
        if n_bytes == Some(block.len()) {
            Ok(())
        } else {
            Err(io::ErrorKind::InvalidData.into())
        }
    }
}

/// What stands before the lengths of an array's packed blocks: their number, the
/// length of a block, and that of the last one where it is shorter, else 0.
pub(crate) fn table_head(n_bytes: u64) -> [u64; 3] {
    let block = BLOCK as u64;
    [n_bytes.div_ceil(block), block, n_bytes % block]
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Compressor; 2] = [Compressor::Lz4, Compressor::Zlib];

    #[test]
    fn heads_count_the_last_block() {
        let block = BLOCK as u64;
        assert_eq!(table_head(0), [0, block, 0]);
        assert_eq!(table_head(1), [1, block, 1]);
        assert_eq!(table_head(block), [1, block, 0]);
        assert_eq!(table_head(5 * block + 7), [6, block, 7]);
    }

    #[test]
    fn a_block_of_another_length_or_content_is_no_block() {
        let block: Vec<u8> = (0..1000_u32).map(|i| (i * i) as u8).collect();
        for compressor in ALL {
            let packed = compressor.pack(&block);
            let unpack = |packed: &[u8], n| compressor.unpack(packed, &mut vec![0; n]).is_ok();
            assert!(unpack(&packed, 1000));
            assert!(!unpack(&packed, 999) && !unpack(&packed, 1001));
            assert!(!unpack(&packed[..packed.len() - 1], 1000) && !unpack(&[], 1000));
        }
    }

    /// No format can do better than what the disk is asked for.
    #[test]
    fn zeros_pack_no_better_than_they_can() {
        for (codec, compressor) in [Codec::Lz4, Codec::Zlib].into_iter().zip(ALL) {
            let n_bytes = compressor.pack(&[0; BLOCK]).len() as u64;
            assert!(n_bytes * codec.max_ratio() >= BLOCK as u64, "{codec:?}");
        }
    }
}
