//! How a file is written, whatever is in it.

use super::Codec;
use crate::provenance::RunId;

/// How a file is written, whatever is in it.
#[derive(Debug, Clone, Copy)]
pub struct Encoding {
    /// What its arrays are compressed by.
    pub codec: Codec,
    /// The run that writes it, if it is to say so.
    pub run: Option<RunId>,
}

impl From<Codec> for Encoding {
    /// Of a file that names no run.
    fn from(codec: Codec) -> Self {
        Self { codec, run: None }
    }
}
