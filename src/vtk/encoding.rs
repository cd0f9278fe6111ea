//! The encoding of a file, independent of its content.

use super::Codec;
use crate::provenance::RunId;

/// The encoding of a file, independent of its content.
#[derive(Debug, Clone, Copy)]
pub struct Encoding {
    /// The codec of its arrays.
    pub codec: Codec,
    /// The id of the run, for the attribute `raycost_run`; `None` to omit it.
    pub run: Option<RunId>,
}

impl From<Codec> for Encoding {
    /// An encoding without the id of the run.
    fn from(codec: Codec) -> Self {
        Self { codec, run: None }
    }
}
