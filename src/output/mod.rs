//! A rendering → files, one writer a file.
//!
//! Takes the film and all that led to it; gives the files of [`Artifact`] in
//! one folder. All are written beside their final names first and take them
//! together at the end: a run that fails or is killed leaves the old files.

pub(crate) mod cost_picture;
mod accounts;
mod cell;
mod folder;
pub mod format;
mod hardware;
mod heatmap;
mod measure;
mod objects;
mod picture;
mod profile;
mod reach;
mod resources;
pub(crate) mod rgb_png;
pub(crate) mod state;
mod stages;
mod summary;
mod trace_events;
mod traced;
pub(crate) mod vtk;

use std::io::{self, Seek, Write};
use std::time::Duration;

pub use accounts::Accounts;
pub(crate) use cell::{text_cell, text_of_cell};
pub use folder::{OutputFolder, WriteError};
pub(crate) use folder::{StagedFile, write_file};
pub use hardware::{Counts, HardwareCounters};
pub use objects::Group;
pub(crate) use objects::{FILE as OBJECTS, rows_per_thing};
pub use profile::{NoProfiler, Profiler};
pub use resources::SystemWork;
pub use stages::{Stage, Stages};
pub(crate) use summary::FILE as SUMMARY;
pub use summary::{Threads, build, machine};
pub use traced::{Traced, write_rays, write_traced};
pub(crate) use vtk::{FRAME, HITS};
pub use vtk::{write_frame, write_hits, write_nodes, write_surface, write_tiles};

use rayon::prelude::*;

use state::States;

use crate::accel::BvhStatistics;
use crate::config::{Config, Extra};
use crate::cost::Meter;
use crate::film::Film;
use crate::ledger::Ledger;
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
    pub ledger: Option<&'a Ledger>,
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
    /// `tiles.vti`: when each tile was rendered, and by which thread.
    Tiles,
    /// `trace.json`: the same on a line of time, for Perfetto.
    Trace,
    /// `schedule.pvsm`: a ParaView state that shows the tiles.
    ScheduleState,
    /// `objects.csv`: what each object and each material cost.
    Objects,
    /// `surface.vtu`: what each primitive cost, on the scene's geometry.
    Surface,
    /// `surface.pvsm`: a ParaView state that shows it.
    SurfaceState,
    /// `bvh.vtu`: the boxes of the hierarchy and what each cost.
    Bvh,
    /// `bvh.pvsm`: a ParaView state that shows the dearest of them.
    BvhState,
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
    /// All files but `profile.svg`, which shows the making of them, and
    /// `summary.json`, which tells of them.
    pub const ALL: [Self; 15] = [
        Self::Image,
        Self::Cost,
        Self::Hits,
        Self::Frame,
        Self::GeometryState,
        Self::HeatmapState,
        Self::OverviewState,
        Self::Tiles,
        Self::Trace,
        Self::ScheduleState,
        Self::Objects,
        Self::Surface,
        Self::SurfaceState,
        Self::Bvh,
        Self::BvhState,
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
            Self::Tiles => vtk::TILES,
            Self::Trace => trace_events::FILE,
            Self::ScheduleState => "schedule.pvsm",
            Self::Objects => objects::FILE,
            Self::Surface => vtk::SURFACE,
            Self::SurfaceState => "surface.pvsm",
            Self::Bvh => vtk::NODES,
            Self::BvhState => "bvh.pvsm",
        }
    }

    /// Whether it is written for a scene: there is something to write, and it
    /// is asked for if it is not a file of every run.
    pub fn is_wanted(self, config: &Config) -> bool {
        match self {
            Self::Image | Self::Hits | Self::Frame | Self::GeometryState => true,
            Self::Cost | Self::HeatmapState | Self::OverviewState => config.cost.has_counters(),
            Self::Tiles | Self::Trace | Self::ScheduleState => config.output.has(Extra::Schedule),
            Self::Objects => config.output.has(Extra::Objects),
            Self::Surface | Self::SurfaceState => config.output.has(Extra::Surface),
            Self::Bvh | Self::BvhState => config.output.has(Extra::Bvh),
        }
    }

    fn write(
        self,
        rendering: &Rendering,
        stages: &Stages,
        states: &States,
        out: &mut (impl Write + Seek),
    ) -> io::Result<()> {
        let codec = rendering.config.compress;
        match self {
            Self::Image => picture::write(rendering.film, states, out),
            Self::Cost => heatmap::write(rendering, out),
            Self::Hits => vtk::write_hits(rendering.film, codec, out),
            Self::Frame => vtk::write_frame(rendering.film, codec, out),
            Self::GeometryState => out.write_all(states.geometry().as_bytes()),
            Self::HeatmapState => out.write_all(states.heatmap().as_bytes()),
            Self::OverviewState => out.write_all(states.overview().as_bytes()),
            Self::Tiles => vtk::write_tiles(rendering.schedule, rendering.film.cost, codec, out),
            Self::Trace => trace_events::write(rendering, stages, out),
            Self::ScheduleState => out.write_all(states.schedule().as_bytes()),
            Self::SurfaceState => out.write_all(states.surface().as_bytes()),
            Self::BvhState => out.write_all(states.bvh().as_bytes()),
            Self::Objects | Self::Surface | Self::Bvh => match rendering.ledger {
                Some(ledger) => self.write_of(ledger, rendering, out),
                None => Ok(()),
            },
        }
    }

    /// Writes what is told of a ledger.
    fn write_of(
        self,
        ledger: &Ledger,
        rendering: &Rendering,
        out: &mut (impl Write + Seek),
    ) -> io::Result<()> {
        let (cost, codec) = (rendering.film.cost, rendering.config.compress);
        match (self, &ledger.primitives, &ledger.hierarchy) {
            (Self::Objects, ..) => objects::write(rendering, ledger, out),
            (Self::Surface, Some(visits), _) => {
                vtk::write_surface(rendering.scene, visits, cost, codec, out)
            }
            (Self::Bvh, _, Some(hierarchy)) => {
                vtk::write_nodes(hierarchy, rendering.config.output.bvh, cost, codec, out)
            }
            _ => Ok(()),
        }
    }
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
    let (wanted, stale): (Vec<_>, Vec<_>) = Artifact::ALL
        .into_iter()
        .partition(|artifact| artifact.is_wanted(rendering.config));
    let stage = |artifact: &Artifact| {
        folder.stage(artifact.file_name(), |out| {
            artifact.write(rendering, &stages, &states, out)
        })
    };
    let mut files: Vec<StagedFile> = wanted.par_iter().map(stage).collect::<Result<_, _>>()?;
    stages.end("write");
    // Last but one, since it tells of the writing of the others.
    let mut stale: Vec<&str> = stale.into_iter().map(Artifact::file_name).collect();
    match rendering.profiler {
        Some(profiler) => {
            let file = folder.stage(profile::FILE, |out| profiler.write(rendering.name, out))?;
            files.push(file);
            stages.end("profile");
        }
        None => stale.push(profile::FILE),
    }

    let mut written: Vec<Written> = files.iter().map(StagedFile::written).collect();
    let summary = folder.stage(summary::FILE, |out| {
        summary::write(rendering, &stages, &written, out)
    })?;
    written.push(summary.written());
    files.push(summary);
    folder.commit(files, stale.into_iter())?;
    Ok((written, stages))
}
