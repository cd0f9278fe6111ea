//! The encoding of a file: its codec, the ID of its run and its field data.

use crate::codec::Codec;
use crate::field::Field;
use host::provenance::RunId;

/// The encoding of a file, for any data set.
#[derive(Debug, Clone)]
pub struct Encoding {
    /// The codec of the arrays.
    pub codec: Codec,
    /// The id of the run, for the attribute `raycost_run`; `None` to omit it.
    pub run: Option<RunId>,
    /// The field data besides the units of the arrays.
    pub fields: Vec<Field>,
}

impl From<Codec> for Encoding {
    /// Creates an encoding without the ID of a run and without field data.
    fn from(codec: Codec) -> Self {
        Self {
            codec,
            run: None,
            fields: Vec::new(),
        }
    }
}
