//! The `compress` section.

use serde::{Deserialize, Serialize};

/// How the arrays of VTK files are compressed. What they hold is the same with
/// each.
///
/// ```
/// # use raycost::config::Codec;
/// let compress: Codec = raycost::yaml::from_str("zlib").unwrap();
/// # assert_eq!(compress, Codec::Zlib);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case", expecting = "`none`, `lz4` or `zlib`")]
pub enum Codec {
    /// Not at all: every reader of VTK files reads them
    #[default]
    None,
    /// Fast; for ParaView and what is made of VTK alone
    Lz4,
    /// Smaller; for these, meshio and vtk.js, too
    Zlib,
}

impl Codec {
    /// How many bytes one byte of a compressed array can stand for at most, by
    /// its format.
    pub fn max_ratio(self) -> u64 {
        match self {
            Self::None => 1,
            Self::Lz4 => 255,
            Self::Zlib => 1032,
        }
    }
}
