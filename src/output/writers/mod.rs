//! A rendering → the files of [`files`] in a folder, one writer per file.
//!
//! The files are written to a temporary folder and moved together at the end: a run
//! that fails or is killed leaves the old files.

mod file;
mod bands;
mod bounding_sphere;
mod distances;
mod fields;
mod frame;
mod hdf;
mod heatmap;
mod hits;
mod lanes;
mod layers;
mod nodes;
mod objects;
mod picture;
mod points;
mod profile;
mod reduced_map;
mod rays;
mod run;
mod state_files;
mod states;
mod summary;
mod surface;
mod survey;
mod thread_time;
mod tiles;
mod trace_events;
mod traced;

use std::path::Path;
use std::time::Duration;

pub(crate) use bands::HITS as HITS_PVTU;
pub use bands::{BandRows, Bands};
pub use bands::{FRAME as FRAME_PVTI, is_piece};
pub use fields::run as run_fields;
pub use file::{OutputFile, Request};
pub use frame::FILE as FRAME_VTI;
pub use frame::write as write_frame;
pub(crate) use heatmap::write_bare as write_bare_map;
pub(crate) use hits::FILE as HITS_VTU;
pub use hits::vertices;
pub use hits::write as write_hits;
pub(crate) use layers::BLOCKS_MEMORY as LAYERS_MEMORY;
pub use nodes::write as write_nodes;
pub use objects::Group;
pub(crate) use objects::{FILE as OBJECTS_CSV, rows_per_thing};
pub(crate) use picture::write_bare as write_bare_picture;
pub use rays::Traced;
pub(crate) use reduced_map::side as map_side;
pub use state_files::{GEOMETRY, HEATMAP};
pub use summary::totals;
pub use surface::write as write_surface;
pub use survey::Survey;
pub use thread_time::{thread_time, time_notes};
pub use tiles::write as write_tiles;
pub use traced::STATE as RAYS_STATE;
pub use traced::{refuse_foreign_traced, write_rays, write_traced};

use rayon::prelude::*;

use file::{FileContent, WriterInput};
use states::States;
pub use states::{StateValues, with_time_in_subject};

use crate::summary::{Build, FrameSection, OtherRuns, Partial, RanksSection, Threads};
use host::folder::{OutputFolder, Own, Replace, WriteError, Written, write_file};
use math::simd::Simd;
use math::statistics::upper_median;
use render::attribution::CostAttribution;
use render::film::Film;
use render::instruments::{Profiler, Stages};
use render::lanes::IdleLanes;
use render::schedule::Schedule;
use render::tiles::Repeat;
use scene::build::Sensor;
use scene::config::{Config, OptionalOutput, Traversal};
use tracer::accel::BvhStatistics;
use tracer::cost::{Meter, UsedDevice};
use world::camera::ImagePlane;
use world::scene::Scene;

/// Files that are written in parallel.
struct FileGroup {
    /// The stage that ends with this group, if any.
    stage: Option<&'static str>,
    files: &'static [OutputFile],
}

/// All output files in the order of the summary. A group is written after the groups before it.
const GROUPS: [FileGroup; 3] = [
    FileGroup {
        stage: Some("write"),
        files: &[
            picture::FILE,
            heatmap::FILE,
            hits::FILE,
            frame::FILE,
            bands::HITS,
            bands::FRAME,
            hdf::HITS,
            hdf::FRAME,
            state_files::GEOMETRY,
            state_files::HEATMAP,
            state_files::OVERVIEW,
            layers::FILE,
            tiles::FILE,
            trace_events::FILE,
            state_files::SCHEDULE,
            objects::FILE,
            lanes::FILE,
            surface::FILE,
            state_files::SURFACE,
            nodes::FILE,
            state_files::BVH,
        ],
    },
    // Shows the writing of the other files.
    FileGroup {
        stage: Some("profile"),
        files: &[profile::FILE],
    },
    // Lists the other files.
    FileGroup {
        stage: None,
        files: &[summary::FILE],
    },
];

/// Returns all files that a rendering may have, in the order of the summary.
pub fn files() -> impl Iterator<Item = &'static OutputFile> {
    GROUPS.iter().flat_map(|group| group.files)
}

/// Returns the template of a ParaView state; `None` for another file.
pub fn state_template(name: &str) -> Option<&'static str> {
    match files().find(|file| file.name == name)?.content {
        FileContent::State(template) => Some(template),
        FileContent::Written(_) | FileContent::AtPath(_) => None,
    }
}

/// A finished rendering with its inputs and measurements, as the writers see it.
#[derive(Debug)]
pub struct RenderingView<'a> {
    /// The program that renders.
    pub build: Build,
    /// The path of the scene file as the user typed it.
    pub scene_file: &'a str,
    /// The values set on the command line.
    pub settings: Vec<String>,
    /// The scene's name: the file's stem.
    pub name: &'a str,
    /// The frame of an animated scene.
    pub frame: Option<&'a FrameSection>,
    /// The settings of the scene file, as changed by the command line.
    pub config: &'a Config,
    /// The scene in render space.
    pub scene: &'a Scene,
    /// The size of the hierarchy, if there is one.
    pub bvh: Option<BvhStatistics>,
    /// The instruction set.
    pub simd: Simd,
    /// How the rays of waves were traced.
    pub traversal: Traversal,
    /// The device, if it was not the processor alone.
    pub device: Option<&'a UsedDevice>,
    /// The meter of the pixels.
    pub meter: &'a Meter,
    /// The pixels and their cost.
    pub film: &'a Film,
    /// Statistics of all pixels together.
    pub survey: &'a Survey,
    /// The pieces of a picture larger than memory, whose film has no pixels.
    pub bands: Option<Bands<'a>>,
    /// The time span and the thread of each tile.
    pub schedule: &'a Schedule,
    /// The repeated renderings.
    pub repeats: &'a [Repeat],
    /// The missing part, if there is one.
    pub partial: Option<Partial>,
    /// The tiles of other runs, if there are any.
    pub other_runs: Option<&'a OtherRuns>,
    /// The ranks, if there were several.
    pub ranks: Option<&'a RanksSection>,
    /// The cost attribution, if requested.
    pub attribution: Option<&'a CostAttribution>,
    /// The idle lanes, if requested.
    pub lanes: Option<&'a IdleLanes>,
    /// True if cloud and frame are also written as VTKHDF.
    pub vtkhdf: bool,
    /// The profiler, if requested.
    pub profiler: Option<&'a Profiler>,
    /// The number of threads.
    pub threads: Threads,
}

impl RenderingView<'_> {
    /// Returns the image plane of the pixels: for a window, a part of the scene's.
    pub fn image_plane(&self) -> ImagePlane {
        let (plane, image) = (
            Sensor::new(self.scene, self.config).plane,
            &self.config.image,
        );
        match image.window {
            None => plane,
            Some(window) => plane.part(window.origin, [image.width, image.height]),
        }
    }

    /// Returns the number of pixels whose noise fell below the limit of adaptive sampling before
    /// their last sample; `None` if no pixel was compared with one, or without counters.
    pub fn n_below_noise(&self) -> Option<u64> {
        let image = &self.config.image;
        let is_compared = (image.adaptive).is_some_and(|adaptive| {
            adaptive.noise.is_some() && adaptive.min_samples < image.samples_per_pixel
        });
        (is_compared && self.film.cost.has_counters()).then_some(self.survey.n_below_noise)
    }

    /// Returns the wall time of one rendering: the [upper median](upper_median) of several.
    pub fn median_wall(&self) -> Duration {
        let mut walls: Vec<Duration> = self.repeats.iter().map(|repeat| repeat.wall).collect();
        upper_median(&mut walls, Ord::cmp).unwrap_or_default()
    }
}

/// Writes every file of the rendering on the current rayon pool, and removes files of an earlier
/// run that this one does not write. Returns the files in the order of [`files`], and the stages,
/// writing included.
///
/// # Errors
/// The first file that could not be written; then no file has changed.
pub fn write(
    rendering: &RenderingView,
    folder: &OutputFolder,
    stages: &mut Stages,
) -> Result<Vec<Written>, WriteError> {
    let states = States::new(rendering, folder);
    let run = run::id_of(rendering);
    let staging = folder.stage_files()?;
    let request = Request {
        config: rendering.config,
        is_profiled: rendering.profiler.is_some(),
        vtkhdf: rendering.vtkhdf,
        is_stored: rendering.bands.is_some(),
    };
    // Write the pieces of a picture larger than memory.
    let mut written = match rendering.bands {
        None => Vec::new(),
        Some(bands) => {
            let job = WriterInput {
                rendering,
                stages,
                states: &states,
                run,
                written: &[],
            };
            bands.stage(&job, &staging)?
        }
    };
    // Write the other files, group by group.
    for group in &GROUPS {
        let wanted: Vec<&OutputFile> = group
            .files
            .iter()
            .filter(|file| file.is_wanted(&request))
            .collect();
        if wanted.is_empty() {
            continue;
        }
        let job = WriterInput {
            rendering,
            stages,
            states: &states,
            run,
            written: &written,
        };
        let stage = |file: &&OutputFile| file.stage(&job, &staging);
        let staged: Vec<Written> = wanted.par_iter().map(stage).collect::<Result<_, _>>()?;
        written.extend(staged);
        if let Some(name) = group.stage {
            stages.end(name);
        }
    }
    // Replace the files of an earlier run.
    staging.commit(&written, &own(rendering.bands.map(|bands| bands.rows)))?;
    Ok(written)
}

/// Writes only the picture of a rendering whose film has all rows: as OpenEXR if the config says
/// so, otherwise as PNG.
///
/// # Errors
/// The file could not be written; then an old one is unchanged.
pub fn write_picture(rendering: &RenderingView, path: &Path) -> Result<Written, WriteError> {
    let run = run::id_of(rendering);
    write_file(path, Replace::Marked, |out| {
        if rendering.config.output.has(OptionalOutput::Exr) {
            layers::write(rendering, run, out)
        } else {
            picture::write(rendering, &picture::texts_of_run(rendering, run), out)
        }
    })
}

/// Checks that [`write()`] would not overwrite or remove a file of another program: only files that
/// the `summary.json` of an earlier run lists are raycost's.
///
/// # Errors
/// The first file of another program.
pub fn refuse_foreign(folder: &OutputFolder, pieces: Option<BandRows>) -> Result<(), WriteError> {
    folder.refuse_foreign(&own(pieces))
}

/// Returns all files that a run may write or may have written, in these pieces.
fn own(pieces: Option<BandRows>) -> Own {
    let names = files().map(|file| file.name.to_owned());
    let pieces = pieces.map_or(Vec::new(), |rows| rows.names());
    Own::Listed {
        names: names.chain(pieces).collect(),
        is_numbered: bands::is_piece,
    }
}
