//! The section on tiles that other runs rendered.

use serde::{Deserialize, Serialize};

use render::checkpoint::{Checkpoint, TileSource};

/// Tiles taken over from other runs: parts of the picture, or the finished tiles of an interrupted
/// rendering. The stages cover only the run that wrote the summary; the renderings in `repeats` and
/// the schedule include the tiles of all runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OtherRuns {
    /// The number of these tiles, over all renderings.
    pub n_tiles: u64,
    /// One entry per file of tiles.
    pub files: Vec<OtherRunsOfFile>,
}

/// The runs that wrote a file of tiles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OtherRunsOfFile {
    /// The part of the picture, as `3/16`; left out for a whole picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<String>,
    /// The number of tiles.
    pub n_tiles: u64,
    /// The number of runs, each of which continued the one before.
    pub n_runs: usize,
    /// The maximum number of threads of a run.
    pub threads: u32,
    /// Wall time of rendering, summed over all runs, in milliseconds.
    pub wall_ms: f64,
    /// CPU time of rendering, summed over all threads and runs, in milliseconds.
    pub cpu_ms: f64,
}

impl OtherRuns {
    /// Returns the runs whose tiles a rendering has taken over; `None` if there are none.
    pub fn from_checkpoint(checkpoint: &Checkpoint) -> Option<Self> {
        let files = checkpoint.sources().iter().map(Into::into);
        let this = Self {
            n_tiles: checkpoint.n_restored() as u64,
            files: files.collect(),
        };
        (this.n_tiles > 0).then_some(this)
    }
}

impl From<&TileSource> for OtherRunsOfFile {
    fn from(source: &TileSource) -> Self {
        let [wall_ms, cpu_ms] = source.spent_ns().map(|ns| ns as f64 / 1e6);
        Self {
            part: source.file.header.part.map(|part| part.to_string()),
            n_tiles: source.file.n_tiles() as u64,
            n_runs: source.file.sessions.len(),
            threads: source.n_threads(),
            wall_ms,
            cpu_ms,
        }
    }
}
