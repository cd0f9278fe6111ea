//! The sections on cost, tiles and files.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Number;

use host::folder::Written;
use host::provenance::Checksum;
use render::schedule::Schedule;
use scene::config::{CostMode, RatioMetrics, TileOrder};
use tracer::cost::Clock;

/// The measured cost of the whole picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CostSection {
    /// The cost measured for each pixel.
    pub mode: CostMode,
    /// The traversal kernel: `stream` or `single_ray`.
    pub kernel: Option<String>,
    /// The clock; `None` if pixels were not timed.
    pub clock: Option<ClockSection>,
    /// The sums of the film's arrays, by the arrays' names, in the arrays' units.
    /// `None` without counters; an entry is `None` if it was not measured.
    pub totals: Option<IndexMap<String, Option<Number>>>,
    /// The definitions of the metrics that the scene defines, by their arrays' names; left out if
    /// there are none.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub metrics: IndexMap<String, String>,
    /// Millions of rays per second of wall time, in the median rendering.
    pub mrays_per_second: Option<f64>,
}

/// The clock of a timed run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClockSection {
    /// `tsc`, the time stamp counter of x86-64, or `os`.
    pub source: String,
    /// The cost of a reading in nanoseconds, which is subtracted from every pixel.
    pub overhead_ns: f64,
}

/// The distribution of tiles to threads.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ScheduleSection {
    /// The side of a tile in pixels.
    pub tile_size: u32,
    /// The order in which threads took tiles.
    pub order: TileOrder,
    /// The number of tiles.
    pub n_tiles: u32,
    /// The longest busy time of a thread over the mean of all threads, minus 1.
    pub load_imbalance: Option<f64>,
    /// The fraction of the threads' time spent without a tile.
    pub idle_share: Option<f64>,
}

/// A file of the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FileEntry {
    /// Name in the folder.
    #[serde(rename = "file")]
    pub name: String,
    /// Length in bytes.
    pub bytes: u64,
    /// Checksum.
    pub checksum: Option<Checksum>,
    /// Wall time of writing in milliseconds; other files were written concurrently.
    pub write_ms: Option<f64>,
}

impl CostSection {
    /// Returns the metrics that the scene defines; none if their definitions are damaged.
    pub fn ratio_metrics(&self) -> RatioMetrics {
        let definitions = self.metrics.iter().map(|(name, text)| (&**name, &**text));
        RatioMetrics::parse(definitions).unwrap_or_default()
    }

    /// Returns the sum of an array of the film; `None` if it was not measured.
    pub fn total(&self, array: &str) -> Option<f64> {
        self.totals.as_ref()?.get(array)?.as_ref()?.as_f64()
    }
}

impl From<&Clock> for ClockSection {
    fn from(clock: &Clock) -> Self {
        Self {
            source: clock.source_name().to_owned(),
            overhead_ns: clock.overhead_ns(),
        }
    }
}

impl From<&Schedule> for ScheduleSection {
    fn from(schedule: &Schedule) -> Self {
        let load = schedule.load();
        Self {
            tile_size: schedule.grid.tile_size,
            order: schedule.order,
            n_tiles: schedule.grid.n_tiles(),
            load_imbalance: Some(load.load_imbalance),
            idle_share: Some(load.idle_share),
        }
    }
}

impl From<&Written> for FileEntry {
    fn from(written: &Written) -> Self {
        Self {
            name: written.file.clone(),
            bytes: written.bytes,
            checksum: Some(written.checksum),
            write_ms: Some(written.write_ms),
        }
    }
}
