//! Verifies output folders, for `raycost check DIR`.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::{Failure, shown};
use base::folder::{SUMMARY, is_unfinished};
use base::text::Diagnostic;
use base::text::numbers::counted;
use output::results::{read_unchanged, verify};
use output::summary::{Partial, Summary};
use tools::series::{FRAMES, FrameSeries, frame_folder};

/// Returns the outputs in a folder: itself, or the folders of its frames; `None` if it has none.
pub(super) fn outputs_in(folder: &Path) -> Option<Vec<PathBuf>> {
    let is_output = |folder: &Path| is_unfinished(folder) || folder.join(SUMMARY).exists();
    if is_output(folder) {
        return Some(vec![folder.to_owned()]);
    }
    let entries = fs::read_dir(folder.join(FRAMES)).ok()?.flatten();
    let folders = entries.map(|entry| entry.path());
    let mut frames: Vec<PathBuf> = folders.filter(|frame| is_output(frame)).collect();
    frames.sort();
    Some(frames).filter(|frames| !frames.is_empty())
}

/// An output whose files are as they were written.
pub(super) struct WholeOutput {
    folder: PathBuf,
    n_files: u64,
    /// `None` for a still.
    n_frames: Option<u64>,
    /// The folders of pictures with missing tiles.
    partial: Vec<(PathBuf, Partial)>,
}

impl WholeOutput {
    /// Returns the lines of the report.
    pub(super) fn lines(&self) -> String {
        let note = |(part, partial): &(PathBuf, _)| format!("note    {}: {partial}\n", shown(part));
        let notes: String = self.partial.iter().map(note).collect();
        let files = files(self.n_files, self.n_frames);
        format!("output  {} is whole: {files}\n{notes}", shown(&self.folder))
    }

    /// Returns the report for other programs.
    pub(super) fn json(&self) -> Value {
        let partial = self.partial.iter();
        let partial = partial
            .map(|(part, missing)| json!({ "out": part.to_string_lossy(), "partial": missing }));
        json!({
            "out": self.folder.to_string_lossy(),
            "n_files": self.n_files,
            "n_frames": self.n_frames,
            "partial": partial.collect::<Vec<_>>(),
        })
    }
}

/// Returns the number of files, and of the frames that they belong to.
fn files(n_files: u64, n_frames: Option<u64>) -> String {
    let files = counted(n_files, "file");
    match n_frames {
        None => files,
        Some(n) => format!("{files} in {}", counted(n, "frame")),
    }
}

/// Compares the files of output folders, which are `folder` or its frames, with their summaries,
/// and the files beside frames with these.
///
/// # Errors
/// A file that has changed since it was written, or a frame that is missing.
pub(super) fn verified(folder: &Path, parts: &[PathBuf]) -> Result<WholeOutput, Failure> {
    let (mut n, mut broken, mut missing) = (0, Vec::new(), Vec::new());
    let mut summaries = Vec::new();
    for part in parts {
        let within = part.strip_prefix(folder).unwrap_or(Path::new(""));
        let verdicts = read_unchanged(&[part], || verify(part))?;
        let summary = Summary::read(&part.join(SUMMARY)).ok();
        if let Some(partial) = summary.as_ref().and_then(|summary| summary.partial) {
            missing.push((part.clone(), partial));
        }
        summaries.extend(summary);
        n += verdicts.len() as u64;
        broken.extend(verdicts.iter().filter_map(|verdict| {
            let name = within.join(&verdict.name);
            Some(format!("{}: {}", name.display(), verdict.fault.as_ref()?))
        }));
    }
    let n_frames = (parts != [folder]).then_some(parts.len() as u64);
    if n_frames.is_some() {
        broken.extend(faults_of_series(folder, &summaries));
    }
    if broken.is_empty() {
        return Ok(WholeOutput {
            folder: folder.to_owned(),
            n_files: n,
            n_frames,
            partial: missing,
        });
    }
    let (shown, files) = (shown(folder), files(n, n_frames));
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
