//! Complete frames of animated scenes.

use std::path::Path;

use crate::summary::{self, FrameSection, Summary};

/// Returns the summary of a frame's folder if its files are complete and the same scene would give
/// the same ones; checks their lengths, not their checksums.
pub fn complete_frame(folder: &Path, expected: &FrameSection) -> Option<Summary> {
    let path = folder.join(summary::FILE);
    if !path.is_file() {
        return None;
    }
    let summary = Summary::read(&path).ok()?;
    let found = summary.frame.as_ref()?;
    let is_same = found.fingerprint == expected.fingerprint;
    let is_whole = summary.files.iter().all(|file| {
        let at = folder.join(&file.name).symlink_metadata();
        at.is_ok_and(|at| at.is_file() && at.len() == file.bytes)
    });
    (is_same && is_whole && summary.partial.is_none()).then_some(summary)
}
