//! Encoding of a file, for any data set.

use crate::codec::Codec;
use crate::field::Field;
use base::provenance::RunId;

/// Encoding of a file, for any data set.
#[derive(Debug, Clone)]
pub struct Encoding {
    /// The codec of its arrays.
    pub codec: Codec,
    /// The id of the run, for the attribute `raycost_run`; `None` to omit it.
    pub run: Option<RunId>,
    /// The field data besides the units of the arrays.
    pub fields: Vec<Field>,
}

impl From<Codec> for Encoding {
    /// An encoding without the id of the run and without field data.
    fn from(codec: Codec) -> Self {
        Self {
            codec,
            run: None,
            fields: Vec::new(),
        }
    }
}
