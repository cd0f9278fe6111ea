//! The ParaView states, a row each: `geometry.pvsm`, `heatmap.pvsm` and the others.

use super::file::{FileContent, OutputFile};
use super::states::GEOMETRY_TEMPLATE;
use crate::config::OptionalOutput;

/// The cloud of hit points in its colors and by its cost.
pub(crate) const GEOMETRY: OutputFile = OutputFile {
    name: "geometry.pvsm",
    is_wanted: |_| true,
    content: FileContent::State(GEOMETRY_TEMPLATE),
};

/// The cost of all pixels.
pub(crate) const HEATMAP: OutputFile = OutputFile {
    name: "heatmap.pvsm",
    is_wanted: |request| request.has_counters(),
    content: FileContent::State(include_str!("../../paraview/heatmap.pvsm")),
};

/// Picture, cost, cloud and histogram on one page.
pub(super) const OVERVIEW: OutputFile = OutputFile {
    name: "overview.pvsm",
    is_wanted: |request| request.has_counters(),
    content: FileContent::State(include_str!("../../paraview/overview.pvsm")),
};

/// The time span and the thread of each tile.
pub(super) const SCHEDULE: OutputFile = OutputFile {
    name: "schedule.pvsm",
    is_wanted: |request| request.has(OptionalOutput::Schedule),
    content: FileContent::State(include_str!("../../paraview/schedule.pvsm")),
};

/// The scene's surface by its cost.
pub(super) const SURFACE: OutputFile = OutputFile {
    name: "surface.pvsm",
    is_wanted: |request| request.has(OptionalOutput::Surface),
    content: FileContent::State(include_str!("../../paraview/surface.pvsm")),
};

/// The boxes of the hierarchy by their cost.
pub(super) const BVH: OutputFile = OutputFile {
    name: "bvh.pvsm",
    is_wanted: |request| request.has(OptionalOutput::Bvh),
    content: FileContent::State(include_str!("../../paraview/bvh.pvsm")),
};
