//! The ParaView states, one constant each: `geometry.pvsm`, `heatmap.pvsm` and the others.

use super::file::{FileContent, OutputFile};
pub(super) use super::states::GEOMETRY_TEMPLATE;
use scene::config::OptionalOutput;

/// The arrays of the cloud needed by every state that shows it.
pub(super) const SHOWN_OF_CLOUD: [&str; 3] = ["RGB", "footprint", "distance"];

/// The cloud of hit points in its colors and by its cost.
pub const GEOMETRY: OutputFile = OutputFile {
    name: "geometry.pvsm",
    is_wanted: |request| request.has_arrays(&SHOWN_OF_CLOUD),
    content: FileContent::State(GEOMETRY_TEMPLATE),
};

/// The cost of all pixels.
pub const HEATMAP: OutputFile = OutputFile {
    name: "heatmap.pvsm",
    is_wanted: |request| request.n_costs() > 1,
    content: FileContent::State(include_str!("states/heatmap.pvsm")),
};

/// Picture, cost, cloud and histogram on one page.
pub(super) const OVERVIEW: OutputFile = OutputFile {
    name: "overview.pvsm",
    is_wanted: |request| request.n_costs() > 0 && request.has_arrays(&SHOWN_OF_CLOUD),
    content: FileContent::State(include_str!("states/overview.pvsm")),
};

/// The time span and the thread of each tile.
pub(super) const SCHEDULE: OutputFile = OutputFile {
    name: "schedule.pvsm",
    is_wanted: |request| request.has(OptionalOutput::Schedule) && request.has_arrays(&["RGB"]),
    content: FileContent::State(include_str!("states/schedule.pvsm")),
};

/// The scene's surface by its cost.
pub(super) const SURFACE: OutputFile = OutputFile {
    name: "surface.pvsm",
    is_wanted: |request| request.has(OptionalOutput::Surface),
    content: FileContent::State(include_str!("states/surface.pvsm")),
};

/// The boxes of the hierarchy by their cost.
pub(super) const BVH: OutputFile = OutputFile {
    name: "bvh.pvsm",
    is_wanted: |request| request.has(OptionalOutput::Bvh) && request.has_arrays(&SHOWN_OF_CLOUD),
    content: FileContent::State(include_str!("states/bvh.pvsm")),
};
