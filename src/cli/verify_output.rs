//! Verifies output folders, for `raycost check DIR`.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::render::{OF_ANOTHER_RUN, go_on};
use super::{Failure, shell_word, shown};
use crate::job::UNFINISHED;
use base::numbers::counted;
use host::folder::{SUMMARY, is_unfinished};
use host::text::Diagnostic;
use output::results::{read_unchanged, verify};
use output::summary::{Partial, Summary};
use render::checkpoint::{CheckpointFile, PARTS};
use tools::series::{FRAMES, FrameSeries, frame_folder, frame_number, strays};

/// Returns the outputs in a folder: itself, or the folders of its frames; `None` if it has none.
///
/// # Errors
/// It has none, but what a rendering has begun.
pub(super) fn outputs_in(folder: &Path) -> Result<Option<Vec<PathBuf>>, Diagnostic> {
    let is_output = |folder: &Path| is_unfinished(folder) || folder.join(SUMMARY).exists();
    if is_output(folder) {
        return Ok(Some(vec![folder.to_owned()]));
    }
    let entries = fs::read_dir(folder.join(FRAMES)).into_iter().flatten();
    let mut folders: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    folders.sort();
    let (frames, others): (Vec<_>, Vec<_>) =
        folders.into_iter().partition(|frame| is_output(frame));
    if !frames.is_empty() {
        return Ok(Some(frames));
    }
    let mut places = [folder.to_owned()].into_iter().chain(others);
    places
        .find_map(|place| begun_in(&place, folder))
        .map_or(Ok(None), Err)
}

/// Returns the message about a folder of the output `out` that has no files of a picture yet: only
/// finished tiles.
fn begun_in(folder: &Path, out: &Path) -> Option<Diagnostic> {
    let tiles = folder.join(UNFINISHED);
    let (what, help) = if let Ok(tiles) = CheckpointFile::open(&tiles) {
        let n_tiles = counted(tiles.n_tiles() as u64, "finished tile");
        let help = go_on(Path::new(&tiles.header.scene));
        (format!("{n_tiles} of an interrupted run"), help)
    } else if folder.join(PARTS).is_dir() {
        let help = format!(
            "when all parts are there: `raycost merge {}`",
            shell_word(out)
        );
        ("parts of a picture".to_owned(), help)
    } else {
        return None;
    };
    let message = format!("`{}` has {what}, and no output yet", shown(folder));
    Some(Diagnostic::new(message).with_help(help))
}

/// An output whose files are as they were written.
pub(super) struct WholeOutput {
    folder: PathBuf,
    n_files: u64,
    /// `None` for a still.
    n_frames: Option<u64>,
    /// The folders of pictures with missing tiles.
    partial: Vec<(PathBuf, Partial)>,
    /// Sentences about what does not belong to it.
    left: Vec<String>,
}

impl WholeOutput {
    /// Returns the lines of the report.
    pub(super) fn lines(&self) -> String {
        let note = |(part, partial): &(PathBuf, _)| format!("note    {}: {partial}\n", shown(part));
        let partial: String = self.partial.iter().map(note).collect();
        let left = self.left.iter().map(|left| format!("note    {left}\n"));
        let left: String = left.collect();
        let files = count_files(self.n_files, self.n_frames);
        format!(
            "output  {} is whole: {files}\n{partial}{left}",
            shown(&self.folder)
        )
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
            "left": self.left,
        })
    }
}

/// Returns the number of files, and of the frames that they belong to.
fn count_files(n_files: u64, n_frames: Option<u64>) -> String {
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
pub(super) fn verify_whole(folder: &Path, parts: &[PathBuf]) -> Result<WholeOutput, Failure> {
    let n_frames = (parts != [folder]).then(|| n_frames_of(folder, parts));
    let is_played = |part: &&PathBuf| match (n_frames, frame_number(part)) {
        (Some(n_frames), Some(number)) => number < n_frames,
        _ => true,
    };
    let parts: Vec<&PathBuf> = parts.iter().filter(is_played).collect();
    let (mut n, mut broken, mut missing) = (0, Vec::new(), Vec::new());
    let mut summaries = Vec::new();
    for &part in &parts {
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
    if let Some(n_frames) = n_frames {
        broken.extend(faults_of_series(folder, n_frames, &summaries));
    }
    let n_whole = n_frames.map(|_| parts.len() as u64);
    if broken.is_empty() {
        return Ok(WholeOutput {
            folder: folder.to_owned(),
            n_files: n,
            n_frames: n_whole,
            partial: missing,
            left: n_frames
                .and_then(|n_frames| strays(folder, n_frames))
                .into_iter()
                .chain(parts.iter().filter_map(|part| unfinished(part)))
                .collect(),
        });
    }
    let (shown, files) = (shown(folder), count_files(n, n_whole));
    let message = format!("`{shown}` is damaged: {} of {files}", broken.len());
    Err(Diagnostic::new(message)
        .with_note(broken.join("\n"))
        .with_help("render the scene again, or copy the folder again")
        .into())
}

/// Returns the number of frames of the animation that was rendered last; an older version wrote it
/// only into the frames.
fn n_frames_of(folder: &Path, parts: &[PathBuf]) -> u32 {
    let of_part = |part: &PathBuf| Some(Summary::read(&part.join(SUMMARY)).ok()?.frame?.n_frames);
    FrameSeries::n_frames_in(folder)
        .or_else(|| parts.iter().find_map(of_part))
        .unwrap_or(parts.len() as u32)
}

/// Returns the sentence about the tiles of an interrupted run in the folder of an output.
fn unfinished(part: &Path) -> Option<String> {
    let path = part.join(UNFINISHED);
    let is_left = path.is_file();
    is_left.then(|| format!("{} {OF_ANOTHER_RUN}", shown(&path)))
}

/// Returns the problems of an animation of `n_frames`, except for the files of its frames: one line
/// each.
fn faults_of_series(folder: &Path, n_frames: u32, summaries: &[Summary]) -> Vec<String> {
    let mut series = FrameSeries::new(String::new(), n_frames);
    let mut numbers = BTreeSet::new();
    for summary in summaries {
        numbers.extend(summary.frame.as_ref().map(|frame| frame.number));
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
