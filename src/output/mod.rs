//! A rendering → files, one writer a file.
//!
//! Takes the film and all that led to it; gives the files of [`Artifact`] in
//! one folder. All are written beside their final names first and take them
//! together at the end: a run that fails or is killed leaves the old files.

mod cost_picture;
mod folder;
pub mod format;
mod heatmap;
mod picture;
mod state;
mod summary;
mod vtk;

use std::io::{self, Write};

pub use folder::{OutputFolder, WriteError};
pub use summary::{Stage, Stages, Threads};
pub use vtk::{write_frame, write_hits};

use crate::accel::BvhStatistics;
use crate::config::Config;
use crate::cost::Clock;
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
    /// The clock of the pixels' times; `None` if none were taken.
    pub clock: Option<&'a Clock>,
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
    /// `cost.png`: the time of each pixel as a picture with a colour bar.
    Cost,
    /// `hits.vtu`: the hit points as a cloud.
    Hits,
    /// `frame.vti`: all pixels as an image of many arrays.
    Frame,
    /// `geometry.pvsm`: a ParaView state that shows the cloud.
    GeometryState,
    /// `heatmap.pvsm`: a ParaView state that shows the cost.
    HeatmapState,
}

/// A file that was written.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Written {
    /// Its name in the folder.
    pub file: &'static str,
    /// Its length.
    pub bytes: u64,
}

impl Artifact {
    /// All files but `summary.json`, which tells of them.
    pub const ALL: [Self; 6] = [
        Self::Image,
        Self::Cost,
        Self::Hits,
        Self::Frame,
        Self::GeometryState,
        Self::HeatmapState,
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
        }
    }

    /// Whether there is nothing to say without measured costs.
    pub fn needs_cost(self) -> bool {
        matches!(self, Self::Cost | Self::HeatmapState)
    }

    fn write(
        self,
        rendering: &Rendering,
        folder: &OutputFolder,
        out: &mut impl Write,
    ) -> io::Result<()> {
        match self {
            Self::Image => picture::write(rendering, folder, out),
            Self::Cost => heatmap::write(rendering, out),
            Self::Hits => vtk::write_hits(rendering.film, out),
            Self::Frame => vtk::write_frame(rendering.film, out),
            Self::GeometryState => state::write_geometry(rendering, folder, out),
            Self::HeatmapState => state::write_heatmap(rendering, folder, out),
        }
    }
}

/// Writes every file of the rendering; gives them in their order, with
/// `summary.json` last. Files of an earlier run that this one has no data for
/// are removed.
///
/// # Errors
/// The first file that could not be written; then no file has changed.
pub fn write(
    rendering: &Rendering,
    mut folder: OutputFolder,
    mut stages: Stages,
) -> Result<(Vec<Written>, Stages), WriteError> {
    let mut written = Vec::new();
    for artifact in Artifact::ALL {
        let file = artifact.file_name();
        if artifact.needs_cost() && !rendering.film.has_cost {
            folder.remove_on_commit(file);
            continue;
        }
        let bytes = folder.stage(file, |folder, out| artifact.write(rendering, folder, out))?;
        written.push(Written { file, bytes });
    }
    stages.end("write");
    let bytes = folder.stage(summary::FILE, |_, out| {
        summary::write(rendering, &stages, &written, out)
    })?;
    written.push(Written {
        file: summary::FILE,
        bytes,
    });
    folder.commit()?;
    Ok((written, stages))
}
