//! Verifies output folders, for `raycost check DIR`.

use std::fs;
use std::path::{Path, PathBuf};

use super::{Failure, shown};
use crate::folder::SUMMARY;
use crate::results::{read_unchanged, verify};
use crate::series::FRAMES;
use crate::summary::Summary;
use crate::text::numbers::counted;
use crate::text::{self, Diagnostic};

/// The outputs in a folder: itself, or the folders of its frames; `None` if it has none.
pub(super) fn outputs_in(folder: &Path) -> Option<Vec<PathBuf>> {
    if folder.join(SUMMARY).exists() {
        return Some(vec![folder.to_owned()]);
    }
    let entries = fs::read_dir(folder.join(FRAMES)).ok()?.flatten();
    let folders = entries.map(|entry| entry.path());
    let mut frames: Vec<PathBuf> = folders
        .filter(|frame| frame.join(SUMMARY).exists())
        .collect();
    frames.sort();
    Some(frames).filter(|frames| !frames.is_empty())
}

/// Compares the files of output folders, which are `folder` or its frames, with their
/// summaries.
///
/// # Errors
/// A file that is not as it was written.
pub(super) fn verified(folder: &Path, parts: &[PathBuf]) -> Result<(), Failure> {
    let (mut n, mut broken, mut notes) = (0, Vec::new(), String::new());
    for part in parts {
        let within = part.strip_prefix(folder).unwrap_or(Path::new(""));
        let verdicts = read_unchanged(&[part], || verify(part))?;
        let summary = Summary::read(&part.join(SUMMARY)).ok();
        if let Some(partial) = summary.and_then(|summary| summary.partial) {
            notes += &format!("note    {}: {partial}\n", shown(part));
        }
        n += verdicts.len() as u64;
        broken.extend(verdicts.iter().filter_map(|verdict| {
            let name = within.join(&verdict.name);
            Some(format!("{}: {}", name.display(), verdict.fault.as_ref()?))
        }));
    }
    let shown = shown(folder);
    let files = match parts {
        [one] if one == folder => counted(n, "file"),
        frames => format!(
            "{} in {}",
            counted(n, "file"),
            counted(frames.len() as u64, "frame")
        ),
    };
    if broken.is_empty() {
        let text = format!("output  {shown} is whole: {files}\n{notes}");
        return Ok(text::print(&text)?);
    }
    let message = format!(
        "`{shown}` is damaged, {} of {files}:\n{}",
        broken.len(),
        broken.join("\n")
    );
    Err(Diagnostic::new(message)
        .with_help("render the scene again, or copy the folder again")
        .into())
}
