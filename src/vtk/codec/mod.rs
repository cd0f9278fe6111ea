//! The `compress` section, and the compressors of VTK, one file each.
//!
//! To add a codec, add a file that implements [`Compressor`], its `mod` line, and
//! its variant and arm in [`Codec`].

mod lz4;
mod zlib;

use std::fmt::Debug;
use std::io::{self, Read};

use base::{Keyword, keywords};

/// Bytes of a block before compression; the last block of an array may be shorter. Larger blocks do
/// not compress better, and leave fewer blocks for the threads.
pub(crate) const BLOCK: usize = 1 << 18;

keywords! {
    /// The compression of the arrays in VTK files. All of them are lossless.
    ///
    /// ```
    /// # use raycost_vtk::Codec;
    /// let compress: Codec = serde_yaml::from_str("zlib").unwrap();
    /// # assert_eq!(compress, Codec::Zlib);
    /// ```
    #[derive(Default)]
    pub enum Codec {
        /// Read by every reader of VTK files
        #[default]
        None = "none",
        /// Fast; read by VTK and ParaView
        Lz4 = "lz4",
        /// Smaller; read by vtk.js, too
        Zlib = "zlib",
    }
}

impl Codec {
    /// Returns the compressor; `None` for raw arrays.
    pub fn compressor(self) -> Option<&'static dyn Compressor> {
        match self {
            Self::None => None,
            Self::Lz4 => Some(&lz4::Lz4),
            Self::Zlib => Some(&zlib::Zlib),
        }
    }

    /// Returns the name of the compression for people; `None` for raw arrays.
    pub fn label(self) -> Option<&'static str> {
        self.compressor().map(Compressor::label)
    }

    /// Returns the largest compression ratio that the format permits.
    pub fn max_ratio(self) -> u64 {
        self.compressor().map_or(1, Compressor::max_ratio)
    }
}

/// Compresses blocks, each independently of the others.
pub trait Compressor: Debug + Sync {
    /// Returns the VTK class that reads the blocks.
    fn vtk_class(&self) -> &'static str;

    /// Returns the name for people.
    fn label(&self) -> &'static str;

    /// Returns the largest compression ratio that the format permits.
    fn max_ratio(&self) -> u64;

    /// Compresses a block.
    fn compress(&self, block: &[u8]) -> Vec<u8>;

    /// Decompresses into `block`, and returns the number of bytes written; `None`
    /// if `compressed` is damaged or too long for `block`.
    fn decompress(&self, compressed: &[u8], block: &mut [u8]) -> Option<usize>;
}

impl dyn Compressor {
    /// Returns the compressor with the VTK class `name`, if raycost has it.
    pub fn of_vtk_class(name: &str) -> Option<&'static Self> {
        let codecs = Codec::KEYWORDS.iter();
        let mut compressors = codecs.filter_map(|codec| codec.compressor());
        compressors.find(|compressor| compressor.vtk_class() == name)
    }

    /// Decompresses a block of known length.
    ///
    /// # Errors
    /// `InvalidData` if `compressed` is not a block of `block.len()` bytes.
    pub fn decompress_exact(&self, compressed: &[u8], block: &mut [u8]) -> io::Result<()> {
        if self.decompress(compressed, block) == Some(block.len()) {
            Ok(())
        } else {
            Err(io::ErrorKind::InvalidData.into())
        }
    }

    /// Reads a block of `length` bytes by way of `compressed`, and decompresses it.
    ///
    /// # Errors
    /// `UnexpectedEof` if the bytes end early; the errors of
    /// [`decompress_exact`](Self::decompress_exact).
    pub(crate) fn decompress_from(
        &self,
        from: &mut impl Read,
        length: u64,
        compressed: &mut Vec<u8>,
        block: &mut [u8],
    ) -> io::Result<()> {
        compressed.clear();
        from.take(length).read_to_end(compressed)?;
        if (compressed.len() as u64) < length {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        self.decompress_exact(compressed, block)
    }
}

#[cfg(test)]
pub(crate) fn compressors() -> impl Iterator<Item = &'static dyn Compressor> {
    let codecs = Codec::KEYWORDS.iter();
    codecs.filter_map(|codec| codec.compressor())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_of_another_length_or_content_is_refused() {
        let block: Vec<u8> = (0..1000_u32).map(|i| (i * i) as u8).collect();
        for compressor in compressors() {
            let compressed = compressor.compress(&block);
            let mut result = vec![0; 1000];
            compressor
                .decompress_exact(&compressed, &mut result)
                .unwrap();
            assert_eq!(result, block, "{compressor:?}");
            let is_block = |compressed: &[u8], n| {
                let result = compressor.decompress_exact(compressed, &mut vec![0; n]);
                result.is_ok()
            };
            assert!(!is_block(&compressed, 999) && !is_block(&compressed, 1001));
            assert!(!is_block(&compressed[..compressed.len() - 1], 1000) && !is_block(&[], 1000));
        }
    }

    /// The space reserved on the disk relies on it.
    #[test]
    fn no_block_is_smaller_than_the_largest_ratio_permits() {
        for compressor in compressors() {
            let n_bytes = compressor.compress(&[0; BLOCK]).len() as u64;
            assert!(
                n_bytes * compressor.max_ratio() >= BLOCK as u64,
                "{compressor:?}"
            );
        }
    }

    #[test]
    fn a_vtk_class_names_its_compressor() {
        for compressor in compressors() {
            let found = <dyn Compressor>::of_vtk_class(compressor.vtk_class()).unwrap();
            assert_eq!(found.label(), compressor.label());
        }
        assert!(<dyn Compressor>::of_vtk_class("vtkLZMADataCompressor").is_none());
    }
}
