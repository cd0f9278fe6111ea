//! Verifies output folders, for `raycost check DIR`.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::{Failure, shown};
use base::folder::SUMMARY;
use base::text::numbers::counted;
use base::text::{self, Diagnostic};
use output::results::{read_unchanged, verify};
use output::summary::Summary;
use tools::series::{FRAMES, FrameSeries, frame_folder};

/// Returns the outputs in a folder: itself, or the folders of its frames; `None` if it has none.
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

/// Compares the files of output folders, which are `folder` or its frames, with their summaries,
/// and the files beside frames with these.
///
/// # Errors
/// A file that has changed since it was written, or a frame that is missing.
pub(super) fn verified(folder: &Path, parts: &[PathBuf]) -> Result<(), Failure> {
    let (mut n, mut broken, mut notes) = (0, Vec::new(), String::new());
    let mut summaries = Vec::new();
    for part in parts {
        let within = part.strip_prefix(folder).unwrap_or(Path::new(""));
        let verdicts = read_unchanged(&[part], || verify(part))?;
        let summary = Summary::read(&part.join(SUMMARY)).ok();
        if let Some(partial) = summary.as_ref().and_then(|summary| summary.partial) {
            notes += &format!("note    {}: {partial}\n", shown(part));
        }
        summaries.extend(summary);
        n += verdicts.len() as u64;
        broken.extend(verdicts.iter().filter_map(|verdict| {
            let name = within.join(&verdict.name);
            Some(format!("{}: {}", name.display(), verdict.fault.as_ref()?))
        }));
    }
    let shown = shown(folder);
    let files = match parts {
        [one] if one == folder => counted(n, "file"),
        frames => {
            broken.extend(faults_of_series(folder, &summaries));
            let n_frames = counted(frames.len() as u64, "frame");
            format!("{} in {n_frames}", counted(n, "file"))
        }
    };
    if broken.is_empty() {
        let text = format!("output  {shown} is whole: {files}\n{notes}");
        return Ok(text::print(&text)?);
    }
    let message = format!("`{shown}` is damaged: {} of {files}", broken.len());
    Err(Diagnostic::new(message)
        .with_note(broken.join("\n"))
        .with_help("render the scene again, or copy the folder again")
        .into())
}

/// Returns the problems of an animation, except for the files of its frames: one line each.
fn faults_of_series(folder: &Path, summaries: &[Summary]) -> Vec<String> {
    let sections = summaries
        .iter()
        .filter_map(|summary| summary.frame.as_ref());
    // Frames of an animation that was longer may be left.
    let n_frames = sections.map(|frame| frame.n_frames).next().unwrap_or(0);
    let mut series = FrameSeries::new(String::new());
    let mut numbers = BTreeSet::new();
    for summary in summaries {
        let section = summary.frame.as_ref();
        let Some(section) = section.filter(|section| section.n_frames == n_frames) else {
            continue;
        };
        numbers.insert(section.number);
        if summary.partial.is_none() {
            series.add(summary);
        }
    }
    let line = |(name, why)| format!("{name}: {why}");
    let mut lines: Vec<String> = series.faults(folder).into_iter().map(line).collect();
    let mut missing = (0..n_frames).filter(|number| !numbers.contains(number));
    if let Some(first) = missing.next() {
        let n_missing = counted(1 + missing.count() as u64, "frame");
        let first = frame_folder(first);
        lines.push(format!(
            "{}: it is missing, {n_missing} in all",
            first.display()
        ));
    }
    lines
}
