//! LZ4 blocks.

use super::Compressor;

/// `vtkLZ4DataCompressor`.
#[derive(Debug)]
pub(super) struct Lz4;

impl Compressor for Lz4 {
    fn vtk_class(&self) -> &'static str {
        "vtkLZ4DataCompressor"
    }

    fn label(&self) -> &'static str {
        "LZ4"
    }

    fn max_ratio(&self) -> u64 {
        255
    }

    fn compress(&self, block: &[u8]) -> Vec<u8> {
        lz4_flex::block::compress(block)
    }

    fn decompress(&self, compressed: &[u8], block: &mut [u8]) -> Option<usize> {
        lz4_flex::block::decompress_into(compressed, block).ok()
    }
}
