//! Verifies an output folder by the lengths and checksums in its summary.

use std::path::Path;

use rayon::prelude::*;

use super::Results;
use crate::summary::{self, FileEntry, FrameSection, Summary, is_whole, read_json};
use base::numbers::count;
use host::folder::checksum_of;
use host::text::Diagnostic;

/// The result for one file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verdict {
    /// Name in the folder.
    pub name: String,
    /// The difference from the file that was written; `None` if there is none.
    pub fault: Option<String>,
}

/// Verifies every file that the folder's summary lists, and the summary itself.
///
/// # Errors
/// The folder does not hold an output, or its summary cannot be read.
pub fn verify(folder: &Path) -> Result<Vec<Verdict>, Diagnostic> {
    let results = Results::open(folder)?;
    let files = results.summary.files.par_iter();
    let verdict = |file: &FileEntry| Verdict {
        name: file.name.clone(),
        fault: fault(folder, file).err(),
    };
    let mut verdicts: Vec<Verdict> = files.map(verdict).collect();
    verdicts.push(Verdict {
        name: summary::FILE.to_owned(),
        fault: fault_of_summary(folder),
    });
    Ok(verdicts)
}

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

fn fault(folder: &Path, listed: &FileEntry) -> Result<(), String> {
    let is_name = Path::new(&listed.name).file_name() == Some(listed.name.as_ref());
    if !is_name {
        return Err("this is not a file name".to_owned());
    }
    let path = folder.join(&listed.name);
    let at = path.symlink_metadata().map_err(|_| "it is missing")?;
    if !at.is_file() {
        return Err("it is not a regular file".to_owned());
    }
    if at.len() != listed.bytes {
        let (found, expected) = (count(at.len()), count(listed.bytes));
        return Err(format!("it has {found} bytes instead of {expected}"));
    }
    let Some(expected) = listed.checksum else {
        return Ok(());
    };
    match checksum_of(&path) {
        Ok(found) if found == expected => Ok(()),
        Ok(found) => Err(format!("its checksum is {found} instead of {expected}")),
        Err(error) => Err(format!("it cannot be read: {error}")),
    }
}

fn fault_of_summary(folder: &Path) -> Option<String> {
    match read_json(&folder.join(summary::FILE), summary::MAX_BYTES) {
        Err(error) => Some(format!("it cannot be read: {error}")),
        // Summaries of older versions have no checksum.
        Ok(text) => (is_whole(&text) == Some(false)).then(|| "it was changed".to_owned()),
    }
}
