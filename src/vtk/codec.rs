//! The `compress` section.

use serde::{Deserialize, Serialize};

/// The compression of the arrays in VTK files. All of them are lossless.
///
/// ```
/// # use raycost::vtk::Codec;
/// let compress: Codec = raycost::yaml::from_str("zlib").unwrap();
/// # assert_eq!(compress, Codec::Zlib);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case", expecting = "`none`, `lz4` or `zlib`")]
pub enum Codec {
    /// No compression: supported by every reader of VTK files
    #[default]
    None,
    /// Fast; supported by ParaView and other programs built on VTK
    Lz4,
    /// Smaller; also supported by meshio and vtk.js
    Zlib,
}

impl Codec {
    /// Returns the largest compression ratio that the format permits.
    pub fn max_ratio(self) -> u64 {
        match self {
            Self::None => 1,
            Self::Lz4 => 255,
            Self::Zlib => 1032,
        }
    }
}
