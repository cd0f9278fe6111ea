//! An output folder → its summary and the arrays of its VTK files.
//!
//! [`Results::open`] reads the summary; arrays are read on request. Missing, damaged or mismatched
//! files are errors that say what to do. The reader supports only the VTK XML files that
//! [`crate::writers`] writes: arrays in appended raw data, with or without compressed blocks.

mod objects;
mod relocate;
mod verify;
mod arrays;
mod pieces;
mod frame_file;
mod hits_file;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

pub use arrays::{ArrayInfo, LoadedArray};
pub use frame_file::{FrameFile, FramePiece};
pub use hits_file::{HitsFile, HitsPiece};
pub use objects::ObjectsTable;
pub use relocate::relocate_states;
pub use verify::{Verdict, complete_frame, verify};

use crate::summary::{self, FileEntry, ImageSection, Summary};
use crate::writers::{FRAME_PVTI, FRAME_VTI, HITS_PVTU, HITS_VTU, is_piece};
use base::numbers::{count, counted};
use base::stop;
use host::advice;
use host::files;
use host::folder::is_unfinished;
use host::provenance::checksum;
use host::text::Diagnostic;

/// The folder of the first frame within the folder of an animated scene.
const FIRST_FRAME: &str = "frames/0000";

/// An output folder whose summary has been read.
#[derive(Debug, Clone)]
pub struct Results {
    folder: PathBuf,
    /// The content of `summary.json`.
    pub summary: Summary,
}

impl Results {
    /// Opens a folder and reads its `summary.json`.
    ///
    /// # Errors
    /// The folder does not exist, or was not written by `raycost render`.
    pub fn open(folder: &Path) -> Result<Self, Diagnostic> {
        let shown = folder.display();
        let hint = "give a folder that `raycost render` wrote, such as out/seed_sphere";
        let metadata = folder.metadata().map_err(|error| {
            Diagnostic::new(format!("cannot read the folder `{shown}`: {error}"))
                .with_help(advice(&error).unwrap_or(hint))
        })?;
        if !metadata.is_dir() {
            let message = format!("`{shown}` is a file, not an output folder");
            return Err(Diagnostic::new(message).with_help(hint));
        }
        let path = folder.join(summary::FILE);
        if is_unfinished(folder) {
            let message = format!("`{shown}` has only a part of its files, and no summary.json");
            let note = "a run that replaced them one by one was killed, or is still at work";
            let help = "render again: that replaces what there is";
            return Err(Diagnostic::new(message).with_note(note).with_help(help));
        }
        if !path.exists() {
            let message = format!("`{shown}` holds no output: it has no summary.json");
            let help = match folder.join(FIRST_FRAME) {
                frame if frame.is_dir() => format!("give one of its frames: {}", frame.display()),
                _ => hint.to_owned(),
            };
            return Err(Diagnostic::new(message).with_help(help));
        }
        Ok(Self {
            folder: folder.to_owned(),
            summary: Summary::read(&path)?,
        })
    }

    /// Returns the folder's path as the user typed it.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the file of all pixels: `frame.vti`, or `frame.pvti` if it has pieces.
    pub fn frame_name(&self) -> &'static str {
        match self.listed(FRAME_PVTI.name) {
            Some(_) => FRAME_PVTI.name,
            None => FRAME_VTI.name,
        }
    }

    /// Returns the file of the hit points: `hits.vtu`, or `hits.pvtu` if it has pieces.
    pub fn hits_name(&self) -> &'static str {
        match self.listed(HITS_PVTU.name) {
            Some(_) => HITS_PVTU.name,
            None => HITS_VTU.name,
        }
    }

    /// Opens `frame.vti`, or the pieces of `frame.pvti`.
    ///
    /// # Errors
    /// The file is missing, damaged or not written by raycost, or its size differs
    /// from the summary's.
    pub fn frame(&self) -> Result<FrameFile, Diagnostic> {
        let name = self.frame_name();
        let mut frame = FrameFile::open(&self.file(name)?)?;
        frame.set_chosen(self.summary.arrays.as_ref());
        let ImageSection { width, height, .. } = self.summary.image;
        let found = (frame.width(), frame.height());
        if found != (width, height) {
            return Err(self.mixed(format!(
                "{name} has {} x {} pixels, summary.json says {width} x {height}",
                found.0, found.1
            )));
        }
        self.check_run(name, frame.run())?;
        Ok(frame)
    }

    /// Opens `hits.vtu`, or the pieces of `hits.pvtu`.
    ///
    /// # Errors
    /// The file is missing, damaged or not written by raycost, or its number of
    /// points differs from the summary's.
    pub fn hits(&self) -> Result<HitsFile, Diagnostic> {
        let name = self.hits_name();
        let mut hits = HitsFile::open(&self.file(name)?)?;
        hits.set_chosen(self.summary.arrays.as_ref());
        if hits.n_points() as u64 != self.summary.n_hits {
            return Err(self.mixed(format!(
                "{name} has {}, summary.json says {}",
                counted(hits.n_points() as u64, "point"),
                counted(self.summary.n_hits, "hit")
            )));
        }
        self.check_run(name, hits.run())?;
        Ok(hits)
    }

    /// Returns the path of a file in the folder.
    ///
    /// # Errors
    /// The file is missing.
    pub fn file(&self, name: &str) -> Result<PathBuf, Diagnostic> {
        let path = self.folder.join(name);
        if path.is_file() {
            return Ok(path);
        }
        Err(Diagnostic::new(format!("`{}` is missing", path.display())).with_help(self.advice()))
    }

    /// Checks that the file belongs to the summary's run.
    fn check_run(&self, name: &str, run: Option<&str>) -> Result<(), Diagnostic> {
        let expected = self.summary.run.map(|run| run.to_string());
        if run != expected.as_deref() {
            return Err(self.mixed(format!("{name} is not of the run of summary.json")));
        }
        self.check_length(name)?;
        // Lists of pieces belong to their run.
        let files = self.summary.files.iter().map(|file| file.name.as_str());
        files
            .filter(|file| is_piece(file))
            .try_for_each(|piece| self.check_length(piece))
    }

    /// Checks the length of a file against the summary.
    fn check_length(&self, name: &str) -> Result<(), Diagnostic> {
        let path = self.folder.join(name);
        let shown = path.display();
        let Some(listed) = self.listed(name) else {
            return Err(self.mixed(format!("summary.json does not list {name}")));
        };
        let n_bytes = path.metadata().map_or(0, |at| at.len());
        if n_bytes == listed.bytes {
            return Ok(());
        }
        let message = format!(
            "`{shown}` is not as it was written: it has {} bytes instead of {}",
            count(n_bytes),
            count(listed.bytes)
        );
        Err(Diagnostic::new(message).with_help(self.advice()))
    }

    fn listed(&self, name: &str) -> Option<&FileEntry> {
        self.summary.files.iter().find(|file| file.name == name)
    }

    fn mixed(&self, what: String) -> Diagnostic {
        let folder = self.folder.display();
        Diagnostic::new(format!(
            "`{folder}` holds files of different renderings: {what}"
        ))
        .with_help(self.advice())
    }

    fn advice(&self) -> String {
        let scene = &self.summary.scene.file;
        let (folder, frame) = match &self.summary.frame {
            None => (Some(self.folder.as_path()), String::new()),
            // A frame's folder is `frames/NNNN` in the folder of the series.
            Some(frame) => (
                self.folder.ancestors().nth(2),
                format!(" --frames {}", frame.number),
            ),
        };
        let folder = folder.filter(|folder| *folder != Path::new(""));
        let folder = folder.unwrap_or(Path::new(".")).display();
        format!("render it again: raycost render {scene} --out {folder}{frame}")
    }
}

/// Calls `read`, and calls it again while other runs change one of the folders meanwhile, up to a
/// minute.
///
/// # Errors
/// The error of the last call of `read`.
pub fn read_unchanged<T>(
    folders: &[&Path],
    read: impl Fn() -> Result<T, Diagnostic>,
) -> Result<T, Diagnostic> {
    let states = || -> Vec<_> {
        let text =
            |folder: &&Path| files::read(&folder.join(summary::FILE), summary::MAX_BYTES).ok();
        let texts = folders.iter().map(text);
        texts.map(|text| text.map(|text| checksum(&text))).collect()
    };
    let begin = Instant::now();
    loop {
        let before = states();
        let done = read();
        if states() == before || begin.elapsed() > PATIENCE || stop::is_requested() {
            return done;
        }
    }
}

/// Longest time that a reader waits for folders that do not change.
const PATIENCE: Duration = Duration::from_secs(60);

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// Folders may change as often as a loaded machine lets them.
    #[test]
    fn a_folder_that_changes_while_it_is_read_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let summary = folder.path().join(summary::FILE);
        let n_calls = Cell::new(0);
        let done = read_unchanged(&[folder.path()], || {
            n_calls.set(n_calls.get() + 1);
            if n_calls.get() > 50 {
                return Ok(());
            }
            std::fs::write(&summary, n_calls.get().to_string()).unwrap();
            Err(Diagnostic::new("files of two runs"))
        });
        assert!(done.is_ok());
        assert_eq!(n_calls.get(), 51);
    }
}
