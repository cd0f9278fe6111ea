//! `summary.json`: the scene, the machine, and the total cost.
//!
//! One set of types describes the file: [`crate::writers`] fills them in and writes them, and
//! readers of an output folder get them back from [`Summary::read`]. A reader ignores unknown keys.
//! An optional field is null or absent if the run did not measure it, or if that version of raycost
//! did not write it.

mod cost;
mod other_runs;
mod partial;
mod program;
mod ranks;
mod read;
mod scene;
mod timing;
mod write;

pub use cost::{ClockSection, CostSection, FileEntry, ScheduleSection};
pub use other_runs::{OtherRuns, OtherRunsOfFile};
pub use partial::Partial;
pub use program::{Build, Machine, Threads};
pub use ranks::{RankEntry, RanksSection};
pub(crate) use read::read_json;
pub use read::{MAX_BYTES, read_value};
pub use scene::{
    AccelerationSection, CameraSection, FilmSection, FrameSection, ImageSection, KernelEntry,
    ObjectEntry, SceneSection,
};
pub use timing::{RepeatsSection, StageEntry, ThreadTime};
pub use write::is_whole;

use serde::{Deserialize, Serialize};

pub use host::folder::SUMMARY as FILE;
use host::provenance::RunId;
use vtk::Codec;

/// The contents of `summary.json`, in the order of its keys. The file ends with one more key: the
/// checksum of all bytes before it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// The version of raycost that rendered.
    pub raycost: String,
    /// The ID of the run, which is in its other files too.
    #[serde(rename = "raycost_run")]
    pub run: Option<RunId>,
    /// The scene file.
    pub scene: SceneSection,
    /// The frame of an animated scene; left out for a still.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<FrameSection>,
    /// The missing parts; left out if the output is complete.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub partial: Option<Partial>,
    /// Size and sampling of the picture.
    pub image: ImageSection,
    /// The conversion from light to the numbers of the picture; left out if these are proportional
    /// to it, with the factor 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub film: Option<FilmSection>,
    /// Positions of the pixels in world space.
    pub camera: Option<CameraSection>,
    /// The objects in the order of the scene file. The array `object` of the
    /// pixels holds indices into this list.
    pub objects: Vec<ObjectEntry>,
    /// The names of the materials. The array `material` of the pixels holds
    /// indices into this list.
    pub materials: Vec<String>,
    /// The number of primitives in the scene.
    pub n_primitives: u64,
    /// The number of instances of instanced meshes, each of whose triangles counts once among the
    /// primitives; left out if there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub n_instances: Option<u64>,
    /// The number of triangles without area, which are not in the scene.
    pub n_degenerate_triangles: Option<u64>,
    /// The acceleration structure.
    pub acceleration: AccelerationSection,
    /// The machine that rendered.
    pub machine: Machine,
    /// The build of raycost that rendered.
    pub build: Option<Build>,
    /// The number of threads.
    pub threads: Threads,
    /// The MPI ranks that rendered; left out for a single process that no launcher has started.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ranks: Option<RanksSection>,
    /// The tiles of other runs; left out if there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub other_runs: Option<OtherRuns>,
    /// The stages of the run in their order.
    pub stages: Vec<StageEntry>,
    /// The repeated renderings of the picture.
    pub repeats: Option<RepeatsSection>,
    /// The breakdown of the threads' time; `None` if pixels were not timed.
    pub thread_time: Option<ThreadTime>,
    /// The limits of the times, a sentence each.
    #[serde(default)]
    pub time_notes: Vec<String>,
    /// Why there are no hardware counters; `None` if there are.
    pub no_hardware_counters: Option<String>,
    /// Why no energy was measured; `None` if it was.
    #[serde(default)]
    pub no_energy: Option<String>,
    /// Peak resident memory of the process in bytes; `None` if the system does
    /// not report it.
    pub peak_memory_bytes: Option<u64>,
    /// The number of pixels.
    pub n_pixels: Option<u64>,
    /// The number of pixels whose camera rays hit an object.
    pub n_hits: u64,
    /// The number of pixels whose noise fell below the limit of adaptive sampling before their last
    /// sample; left out without adaptive sampling, without counters, and if no pixel may get more
    /// samples than the least number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub n_below_noise: Option<u64>,
    /// The measured cost of the whole picture.
    pub cost: CostSection,
    /// The distribution of tiles to threads.
    pub schedule: Option<ScheduleSection>,
    /// The compression of the VTK files.
    pub compress: Option<Codec>,
    /// The arrays of cloud and frame that the scene chose; left out if they have all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arrays: Option<Vec<String>>,
    /// The files of the run except the summary itself.
    #[serde(default)]
    pub files: Vec<FileEntry>,
}
