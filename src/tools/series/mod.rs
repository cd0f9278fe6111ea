//! The complete frames of an animated scene → files that show them one after the other.
//!
//! Takes the summaries of the frames; writes files beside `frames/` that play them: a `.pvd` for
//! each of their VTK files and one for all, the ParaView states with one range of colors for all
//! frames, a table and a plot of their costs, and a video. Each file takes its place when it is
//! complete.

mod hdf;
mod table;
mod pvd;
mod states;
mod video;

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

pub use video::Video;

use crate::study::RunMetrics;
use base::numbers::counted;
use host::files;
use host::folder::{
    Lock, Replace, WriteError, lock_folder_in_turn, refuse_file, refuse_foreign_file, write_file,
};
use host::provenance::{Hasher, RunId};
use host::text::one_line;
use output::summary::Summary;
use output::writers::{self, StateValues};
use tracer::accel::BvhStatistics;

/// The folder of the frames' folders.
pub const FRAMES: &str = "frames";
/// The prefix of the names of all other files.
const PREFIX: &str = "series";
/// The table.
const TABLE: &str = "series.csv";
/// The video.
const VIDEO: &str = "series.mp4";
/// Longest file beside the frames that is checked, in bytes.
const MAX_FILE: u64 = 256 << 20;

/// Returns the path of a frame's folder, in the folder of the series.
pub fn frame_folder(number: u32) -> PathBuf {
    Path::new(FRAMES).join(format!("{number:04}"))
}

/// Returns the number of the frame whose folder this is; `None` for another folder.
pub fn frame_number(folder: &Path) -> Option<u32> {
    let number = folder.file_name()?.to_str()?.parse().ok()?;
    folder.ends_with(frame_folder(number)).then_some(number)
}

/// Returns the sentence about frames in the folder of a series that its animation, of `n_frames`,
/// does not have; `None` if there are none.
pub fn strays(folder: &Path, n_frames: u32) -> Option<String> {
    let entries = fs::read_dir(folder.join(FRAMES)).ok()?.flatten();
    let numbers = entries.filter_map(|entry| frame_number(&entry.path()));
    let mut strays: Vec<u32> = numbers.filter(|&number| number >= n_frames).collect();
    strays.sort_unstable();
    let first = frame_folder(*strays.first()?);
    let first = first.display();
    let which = match strays.len() as u64 - 1 {
        0 => format!("{first} is left"),
        n => format!("{first} and {} more are left", counted(n, "frame")),
    };
    let played = counted(n_frames.into(), "frame");
    Some(format!(
        "{which} of a longer animation: the series plays {played}, and you may remove the others"
    ))
}

/// The complete frames of an animated scene.
#[derive(Debug)]
pub struct FrameSeries {
    /// The scene's name.
    name: String,
    /// The number of frames of the animation.
    n_in_all: u32,
    frames: Vec<SeriesFrame>,
    /// The values of the states for all frames.
    states: Option<StateValues>,
}

/// A complete frame.
#[derive(Debug)]
struct SeriesFrame {
    number: u32,
    time: f64,
    run: Option<RunId>,
    /// Names of the frame's files.
    files: Vec<String>,
    metrics: RunMetrics,
    bvh: Option<BvhStatistics>,
}

impl FrameSeries {
    /// Creates a series without frames of an animation of `n_frames`; `name` is the scene's name.
    pub fn new(name: String, n_frames: u32) -> Self {
        Self {
            name,
            n_in_all: n_frames,
            frames: Vec::new(),
            states: None,
        }
    }

    /// Returns the number of frames of the animation whose series was written into a folder; `None`
    /// without a series, or if an older version wrote it.
    pub fn n_frames_in(folder: &Path) -> Option<u32> {
        let text = files::read(&folder.join(pvd::ALL), MAX_FILE).ok()?;
        pvd::n_frames_in(&String::from_utf8_lossy(&text))
    }

    /// Checks that no file of another program has a name of the series' files.
    ///
    /// # Errors
    /// The first such file.
    pub fn refuse_foreign(folder: &Path) -> Result<(), WriteError> {
        let of_frames = writers::files().flat_map(|file| {
            let state = format!("{PREFIX}_{}", file.name);
            [state, pvd::name_of(file.name)]
        });
        let is_hdf = |name: &String| hdf::FILES.iter().any(|(of_hdf, _)| name == of_hdf);
        let own = [TABLE, "series.svg", pvd::ALL].map(str::to_owned);
        for name in own
            .into_iter()
            .chain(of_frames.filter(|name| !is_hdf(name)))
        {
            refuse_foreign_file(&folder.join(name), Replace::Marked)?;
        }
        // Videos and HDF5 files do not identify their program; the table beside them does.
        for name in hdf::FILES.map(|(name, _)| name).into_iter().chain([VIDEO]) {
            let file = folder.join(name);
            if file.symlink_metadata().is_ok() && !folder.join(TABLE).exists() {
                return Err(refuse_file(&file));
            }
        }
        Ok(())
    }

    /// Adds a frame, whose number is greater than the numbers of the frames before it.
    pub fn add(&mut self, summary: &Summary) {
        let Some(frame) = &summary.frame else {
            return;
        };
        let stages = summary.stages.iter().map(|stage| stage.wall_ms);
        // Names of the series' files follow from these.
        let names = summary.files.iter().map(|file| &file.name);
        let is_known = |name: &&String| writers::files().any(|file| file.name == **name);
        self.frames.push(SeriesFrame {
            number: frame.number,
            time: frame.time,
            run: summary.run,
            files: names.filter(is_known).cloned().collect(),
            metrics: RunMetrics::from_summary(summary, stages.sum()),
            bvh: summary.acceleration.bvh,
        });
        let values: Option<StateValues> = serde_json::from_value(frame.states.clone()).ok();
        self.states = match (&self.states, values) {
            (Some(before), Some(values)) => Some(before.spanning(&values)),
            (before, values) => before.clone().or(values),
        };
    }

    /// Returns the number of frames.
    pub fn n_frames(&self) -> u32 {
        self.frames.len() as u32
    }

    /// Locks the folder of a series; waits while another run has locked it. A run that holds the
    /// lock from before the first [`add`](Self::add) until after [`write`](Self::write) replaces no
    /// series of more frames.
    ///
    /// # Errors
    /// If another run holds the lock for a minute, or an error of the system.
    pub fn lock(folder: &Path) -> Result<Lock, WriteError> {
        lock_folder_in_turn(folder)
    }

    /// Writes the files into the folder of the series, which is [locked](Self::lock), VTKHDF files
    /// only if `vtkhdf`, and removes old ones of these. Returns their names.
    ///
    /// # Errors
    /// If a file of another program has one of their names, or an error of the system.
    pub fn write(&self, folder: &Path, vtkhdf: bool) -> Result<Vec<String>, WriteError> {
        let mut written = Vec::new();
        let mut write = |name: String, bytes: &[u8]| {
            write_file(&folder.join(&name), Replace::Marked, |out| {
                out.write_all(bytes)
            })?;
            written.push(name);
            Ok::<(), WriteError>(())
        };
        for (name, text) in self.texts(folder) {
            write(name, text.as_bytes())?;
        }
        if vtkhdf && !self.frames.is_empty() {
            written.extend(hdf::write(&self.frames, folder)?);
        } else {
            for (name, _) in hdf::FILES {
                let _ = fs::remove_file(folder.join(name));
            }
        }
        Ok(written)
    }

    /// Returns the files beside the frames that [`write`](Self::write) did not write for these
    /// frames, that are truncated, or that list other frames: their names, and the reasons. The
    /// video and files of VTKHDF are not checked.
    pub fn faults(&self, folder: &Path) -> Vec<(String, String)> {
        let run = self.id().to_string();
        let fault = |(name, expected): (String, String)| {
            let why = match files::read(&folder.join(&name), MAX_FILE) {
                Err(error) if error.kind() == ErrorKind::NotFound => "it is missing".to_owned(),
                Err(error) => format!("it cannot be read: {error}"),
                Ok(found) => {
                    let found = String::from_utf8_lossy(&found);
                    let end = expected.lines().next_back()?;
                    let is_entry = |line: &&str| name == TABLE || pvd::is_entry(line);
                    let entries = |text| str::lines(text).filter(is_entry);
                    // The table has the runs of the frames, other files the run of all.
                    if name != TABLE && !found.contains(&run) {
                        "it is not of these frames".to_owned()
                    } else if !found.trim_end().ends_with(end) {
                        "it is cut, or not of these frames".to_owned()
                    } else if !entries(&found).eq(entries(&expected)) {
                        "it was changed".to_owned()
                    } else {
                        return None;
                    }
                }
            };
            Some((name, why))
        };
        self.texts(folder).into_iter().filter_map(fault).collect()
    }

    /// Returns the files beside the frames that are texts, by their names.
    fn texts(&self, folder: &Path) -> Vec<(String, String)> {
        let run = self.id();
        let plot = table::plot(&self.name, &self.frames, run);
        let plot = plot.map(|plot| (format!("{PREFIX}.svg"), plot));
        let table = (TABLE.to_owned(), table::csv(&self.frames));
        [table]
            .into_iter()
            .chain(plot)
            .chain(pvd::collections(&self.frames, self.n_in_all, run))
            .chain(self.states(folder, run))
            .collect()
    }

    /// Returns a hash of the frames' runs.
    fn id(&self) -> RunId {
        let mut hasher = Hasher::default();
        for frame in &self.frames {
            hasher.add(format!("{:?}", (frame.number, frame.time, frame.run)).as_bytes());
        }
        hasher.checksum().into()
    }

    /// Returns the states, by their names.
    fn states(&self, folder: &Path, run: RunId) -> Vec<(String, String)> {
        let (Some(values), [first, ..]) = (&self.states, self.frames.as_slice()) else {
            return Vec::new();
        };
        let end = self.frames.last().map_or(first.time, |last| last.time);
        // Absolute, because ParaView may be started in any folder.
        let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        let path_of = |file: &str| folder.join(pvd::name_of(file));
        states::from_files(&first.files, values, [first.time, end], path_of, run)
    }

    /// Returns the command that shows the frames in ParaView; `None` without states.
    pub fn state(&self) -> Option<String> {
        let first = self.frames.first()?;
        let has = |name: &&&str| first.files.iter().any(|file| file == **name);
        let state = ["heatmap.pvsm", "geometry.pvsm"].iter().find(has)?;
        Some(format!("{PREFIX}_{state}"))
    }

    /// Returns the scene's name for titles.
    pub fn title(&self) -> String {
        one_line(&self.name).into_owned()
    }
}
