//! A rendering → files, one writer a file.
//!
//! Takes the film and all that led to it; gives the files of [`Artifact`] in
//! one folder. All are written into a folder of their own first and take their
//! places together at the end: a run that fails or is killed leaves the old
//! files.

pub(crate) mod cost_picture;
mod artifact;
mod accounts;
mod bounding_sphere;
mod cell;
mod folder;
pub mod format;
mod hardware;
mod heatmap;
mod measure;
mod objects;
mod picture;
mod profile;
mod resources;
pub(crate) mod run;
pub(crate) mod rgb_png;
pub(crate) mod state;
mod stages;
mod summary;
mod trace_events;
mod traced;
pub(crate) mod vtk;

use std::time::Duration;

pub use accounts::Accounts;
pub use artifact::Artifact;
pub(crate) use cell::{text_cell, text_of_cell};
pub use folder::{OutputFolder, WriteError};
pub(crate) use folder::{
    Own, Replace, Scratch, StagedFile, checksum_of, lock_folder, refuse_file, settle, target,
    write_file,
};
pub use hardware::{Counts, HardwareCounters};
pub use objects::Group;
pub(crate) use objects::{FILE as OBJECTS, rows_per_thing};
pub use profile::{NoProfiler, Profiler};
pub use resources::SystemWork;
pub use run::{Checksum, RunId};
pub use stages::{Stage, Stages};
pub(crate) use summary::{FILE as SUMMARY, is_whole};
pub use summary::{Threads, build, machine};
pub use traced::{Traced, refuse_foreign_traced, write_rays, write_traced};
pub use vtk::Encoding;
pub(crate) use vtk::{FRAME, HITS};
pub use vtk::{write_frame, write_hits, write_nodes, write_surface, write_tiles};

use rayon::prelude::*;

use state::States;

use crate::accel::BvhStatistics;
use crate::attribution::CostAttribution;
use crate::config::Config;
use crate::cost::Meter;
use crate::film::Film;
use crate::render::{Overhead, Repeat};
use crate::scene::Scene;
use crate::schedule::Schedule;

/// A finished rendering and what is known of it.
#[derive(Debug)]
pub struct Rendering<'a> {
    /// The scene file as the user typed it.
    pub scene_file: &'a str,
    /// The scene's name: the file's stem.
    pub name: &'a str,
    /// What the file says, the command line's changes included.
    pub config: &'a Config,
    /// The scene in world space.
    pub scene: &'a Scene,
    /// The hierarchy's size, if there is one.
    pub bvh: Option<BvhStatistics>,
    /// What measured the pixels.
    pub meter: &'a Meter,
    /// The pixels.
    pub film: &'a Film,
    /// When each tile of them was rendered.
    pub schedule: &'a Schedule,
    /// Each time that they were rendered.
    pub repeats: &'a [Repeat],
    /// What measuring them costs, where that was asked.
    pub overhead: Option<Overhead>,
    /// What things cost, if that is asked for.
    pub attribution: Option<&'a CostAttribution>,
    /// What has watched the run, if that was asked.
    pub profiler: Option<&'a Profiler>,
    /// How many threads rendered.
    pub threads: Threads,
}

impl Rendering<'_> {
    /// Time on the wall of one rendering: the median where there are several,
    /// and of the two in the middle the longer one.
    pub fn median_wall(&self) -> Duration {
        let mut walls: Vec<Duration> = self.repeats.iter().map(|repeat| repeat.wall).collect();
        walls.sort_unstable();
        walls.get(walls.len() / 2).copied().unwrap_or_default()
    }
}

/// A file that was written.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Written {
    /// Its name in the folder.
    pub file: &'static str,
    /// Its length.
    pub bytes: u64,
    /// Its checksum.
    pub checksum: Checksum,
    /// Time on the wall from the first byte to the last, in milliseconds, while
    /// other files were written, too.
    pub write_ms: f64,
}

/// Writes every file of the rendering on the current rayon pool; gives them in
/// their order, with `summary.json` last. Files of an earlier run that this
/// one does not write are removed.
///
/// # Errors
/// The first file that could not be written; then no file has changed.
pub fn write(
    rendering: &Rendering,
    folder: &OutputFolder,
    mut stages: Stages,
) -> Result<(Vec<Written>, Stages), WriteError> {
    let states = States::new(rendering, folder);
    let run = RunId::of(rendering);
    let staging = folder.stage_files()?;
    let wanted: Vec<Artifact> = Artifact::ALL
        .into_iter()
        .filter(|artifact| artifact.is_wanted(rendering.config))
        .collect();
    let stage = |artifact: &Artifact| {
        staging.stage(artifact.file_name(), |out| {
            artifact.write(rendering, &stages, &states, run, out)
        })
    };
    let mut files: Vec<StagedFile> = wanted.par_iter().map(stage).collect::<Result<_, _>>()?;
    stages.end("write");
    // Last but one, since it shows the writing of the others.
    if let Some(profiler) = rendering.profiler {
        let file = staging.stage(profile::FILE, |out| {
            profiler.write(rendering.name, run, out)
        })?;
        files.push(file);
        stages.end("profile");
    }

    let mut written: Vec<Written> = files.iter().map(StagedFile::written).collect();
    let summary = staging.stage(summary::FILE, |out| {
        summary::write(rendering, &stages, &written, run, out)
    })?;
    written.push(summary.written());
    files.push(summary);
    staging.commit(&files, &own())?;
    Ok((written, stages))
}

/// Makes sure that no file in the folder is someone else's of a name that
/// [`write()`] writes or removes: only files that the `summary.json` of an
/// earlier run lists are raycost's.
///
/// # Errors
/// Such a file.
pub fn refuse_foreign(folder: &OutputFolder) -> Result<(), WriteError> {
    folder.refuse_foreign(&own())
}

fn own() -> Own {
    let names = Artifact::ALL.into_iter().map(Artifact::file_name);
    Own::Listed(names.chain([profile::FILE, summary::FILE]).collect())
}
