//! A rendering → files, one writer a file.
//!
//! Takes the film and all that led to it; gives the files of [`Artifact`] in
//! one folder. All are written beside their final names first and take them
//! together at the end: a run that fails or is killed leaves the old files.

mod cost_picture;
mod folder;
mod hardware;
pub mod format;
mod heatmap;
mod measure;
mod picture;
mod resources;
mod rgb_png;
mod state;
mod summary;
mod vtk;

use std::io::{self, Write};

pub(crate) use cost_picture::{Ticks, ticks};
pub use folder::{OutputFolder, WriteError};
pub use hardware::{Counts, HardwareCounters};
pub use resources::SystemWork;
pub use summary::{Stage, Stages, Threads, build, machine};
pub use vtk::{write_frame, write_hits};

use rayon::prelude::*;

use folder::StagedFile;
use state::States;

use crate::accel::BvhStatistics;
use crate::config::{Config, CostMode};
use crate::cost::Meter;
use crate::film::Film;
use crate::scene::Scene;

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
    /// How many threads rendered.
    pub threads: Threads,
}

/// A file of the output folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Artifact {
    /// `image.png`: the picture.
    Image,
    /// `cost.png`: what each pixel cost as a picture with a colour bar.
    Cost,
    /// `hits.vtu`: the hit points as a cloud.
    Hits,
    /// `frame.vti`: all pixels as an image of many arrays.
    Frame,
    /// `geometry.pvsm`: a ParaView state that shows the cloud.
    GeometryState,
    /// `heatmap.pvsm`: a ParaView state that shows the cost.
    HeatmapState,
    /// `overview.pvsm`: a ParaView state that shows picture, cost and cloud.
    OverviewState,
}

/// A file that was written.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Written {
    /// Its name in the folder.
    pub file: &'static str,
    /// Its length.
    pub bytes: u64,
    /// Time on the wall from the first byte to the last, in milliseconds, while
    /// other files were written, too.
    pub write_ms: f64,
}

impl Artifact {
    /// All files but `summary.json`, which tells of them.
    pub const ALL: [Self; 7] = [
        Self::Image,
        Self::Cost,
        Self::Hits,
        Self::Frame,
        Self::GeometryState,
        Self::HeatmapState,
        Self::OverviewState,
    ];

    /// Its name in the folder.
    pub fn file_name(self) -> &'static str {
        match self {
            Self::Image => "image.png",
            Self::Cost => "cost.png",
            Self::Hits => vtk::HITS,
            Self::Frame => vtk::FRAME,
            Self::GeometryState => "geometry.pvsm",
            Self::HeatmapState => "heatmap.pvsm",
            Self::OverviewState => "overview.pvsm",
        }
    }

    /// Whether there is something to write for a film of this mode.
    pub fn has_data(self, cost: CostMode) -> bool {
        cost.has_counters()
            || !matches!(self, Self::Cost | Self::HeatmapState | Self::OverviewState)
    }

    fn write(self, rendering: &Rendering, states: &States, out: &mut impl Write) -> io::Result<()> {
        match self {
            Self::Image => picture::write(rendering.film, states, out),
            Self::Cost => heatmap::write(rendering, out),
            Self::Hits => vtk::write_hits(rendering.film, out),
            Self::Frame => vtk::write_frame(rendering.film, out),
            Self::GeometryState => out.write_all(states.geometry().as_bytes()),
            Self::HeatmapState => out.write_all(states.heatmap().as_bytes()),
            Self::OverviewState => out.write_all(states.overview().as_bytes()),
        }
    }
}

/// Writes every file of the rendering on the current rayon pool; gives them in
/// their order, with `summary.json` last. Files of an earlier run that this
/// one has no data for are removed.
///
/// # Errors
/// The first file that could not be written; then no file has changed.
pub fn write(
    rendering: &Rendering,
    folder: &OutputFolder,
    mut stages: Stages,
) -> Result<(Vec<Written>, Stages), WriteError> {
    let states = States::new(rendering, folder);
    let (wanted, stale): (Vec<_>, Vec<_>) = Artifact::ALL
        .into_iter()
        .partition(|artifact| artifact.has_data(rendering.film.cost));
    let stage = |artifact: &Artifact| {
        folder.stage(artifact.file_name(), |out| {
            artifact.write(rendering, &states, out)
        })
    };
    let mut files: Vec<StagedFile> = wanted.par_iter().map(stage).collect::<Result<_, _>>()?;
    stages.end("write");

    let mut written: Vec<Written> = files.iter().map(StagedFile::written).collect();
    let summary = folder.stage(summary::FILE, |out| {
        summary::write(rendering, &stages, &written, out)
    })?;
    written.push(summary.written());
    files.push(summary);
    folder.commit(files, stale.into_iter().map(Artifact::file_name))?;
    Ok((written, stages))
}
