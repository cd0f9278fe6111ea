//! The files of a rendering, one row each.

use std::io::{self, Seek, Write};

use super::states::States;
use super::{
    Rendering, frame, heatmap, hits, nodes, objects, picture, surface, tiles, trace_events,
};
use crate::attribution::CostAttribution;
use crate::config::{Config, OptionalOutput};
use crate::instruments::Stages;
use crate::provenance::{self, RunId};
use crate::vtk::Encoding;

/// A file of the output folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Artifact {
    /// `image.png`: the picture.
    Image,
    /// `cost.png`: the cost of each pixel as a picture with a color bar.
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
    /// `bvh.pvsm`: a ParaView state that shows the most expensive of them.
    BvhState,
}

impl Artifact {
    /// All files but `profile.svg`, which shows the making of them, and
    /// `summary.json`, which describes them.
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
            Self::Hits => hits::FILE,
            Self::Frame => frame::FILE,
            Self::GeometryState => "geometry.pvsm",
            Self::HeatmapState => "heatmap.pvsm",
            Self::OverviewState => "overview.pvsm",
            Self::Tiles => tiles::FILE,
            Self::Trace => trace_events::FILE,
            Self::ScheduleState => "schedule.pvsm",
            Self::Objects => objects::FILE,
            Self::Surface => surface::FILE,
            Self::SurfaceState => "surface.pvsm",
            Self::Bvh => nodes::FILE,
            Self::BvhState => "bvh.pvsm",
        }
    }

    /// Whether it is written for a scene: there is something to write, and it
    /// is asked for if it is not a file of every run.
    pub fn is_wanted(self, config: &Config) -> bool {
        match self {
            Self::Image | Self::Hits | Self::Frame | Self::GeometryState => true,
            Self::Cost | Self::HeatmapState | Self::OverviewState => config.cost.has_counters(),
            Self::Tiles | Self::Trace | Self::ScheduleState => {
                config.output.has(OptionalOutput::Schedule)
            }
            Self::Objects => config.output.has(OptionalOutput::Objects),
            Self::Surface | Self::SurfaceState => config.output.has(OptionalOutput::Surface),
            Self::Bvh | Self::BvhState => config.output.has(OptionalOutput::Bvh),
        }
    }

    pub(super) fn write(
        self,
        rendering: &Rendering,
        stages: &Stages,
        states: &States,
        run: RunId,
        out: &mut (impl Write + Seek),
    ) -> io::Result<()> {
        let film = rendering.film;
        let encoding = Encoding {
            codec: rendering.config.compress,
            run: Some(run),
        };
        let state = match self {
            Self::Image => return picture::write(film, run, states, out),
            Self::Cost => return heatmap::write(rendering, run, out),
            Self::Hits => return hits::write(film, encoding, out),
            Self::Frame => return frame::write(film, encoding, out),
            Self::Tiles => return tiles::write(rendering.schedule, film.cost, encoding, out),
            Self::Trace => return trace_events::write(rendering, stages, run, out),
            Self::Objects | Self::Surface | Self::Bvh => {
                return match rendering.attribution {
                    Some(attribution) => self.write_of(attribution, rendering, encoding, out),
                    None => Ok(()),
                };
            }
            Self::GeometryState => states.geometry(),
            Self::HeatmapState => states.heatmap(),
            Self::OverviewState => states.overview(),
            Self::ScheduleState => states.schedule(),
            Self::SurfaceState => states.surface(),
            Self::BvhState => states.bvh(),
        };
        out.write_all(provenance::stamped(&state, run).as_bytes())
    }

    /// Writes a file of the cost attribution.
    fn write_of(
        self,
        attribution: &CostAttribution,
        rendering: &Rendering,
        encoding: Encoding,
        out: &mut (impl Write + Seek),
    ) -> io::Result<()> {
        let cost = rendering.film.cost;
        match (self, &attribution.primitives, &attribution.hierarchy) {
            (Self::Objects, ..) => objects::write(rendering, attribution, out),
            (Self::Surface, Some(visits), _) => {
                surface::write(rendering.scene, visits, cost, encoding, out)
            }
            (Self::Bvh, _, Some(hierarchy)) => {
                nodes::write(hierarchy, rendering.config.output.bvh, cost, encoding, out)
            }
            _ => Ok(()),
        }
    }
}
