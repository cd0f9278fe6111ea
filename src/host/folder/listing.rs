//! Recognizes files that raycost wrote: a summary lists them, or they contain a mark.

use std::io::{self, Read};
use std::path::Path;

use serde::Deserialize;

use super::SUMMARY;
use crate::files;
use crate::provenance;

/// Length of the start of a file that must contain the mark, in bytes.
const MARKED: u64 = 1 << 16;
/// Longest summary that is read, in bytes.
const MAX_SUMMARY: u64 = 256 << 20;

/// The part of `summary.json` that lists files.
///
/// Not the whole summary: a damaged section elsewhere in it must not turn raycost's own files into
/// foreign ones.
#[derive(Deserialize)]
struct Listing {
    #[serde(rename = "raycost")]
    _version: String,
    files: Vec<Listed>,
}

#[derive(Deserialize)]
struct Listed {
    file: String,
}

/// Returns the names that a summary lists, and its own; none if raycost did not write it.
pub(super) fn listed_in(summary: &Path) -> Vec<String> {
    let text = files::read(summary, MAX_SUMMARY).ok();
    let listing = text.and_then(|text| serde_json::from_slice::<Listing>(&text).ok());
    listing.map_or_else(Vec::new, |listing| {
        let files = listing.files.into_iter().map(|listed| listed.file);
        files.chain([SUMMARY.to_owned()]).collect()
    })
}

/// Returns true if a file contains raycost's mark.
pub(super) fn is_marked(path: &Path) -> io::Result<bool> {
    let mut begin = Vec::new();
    files::open(path)?.take(MARKED).read_to_end(&mut begin)?;
    let key = provenance::KEY.as_bytes();
    Ok(begin.windows(key.len()).any(|bytes| bytes == key))
}
