//! `summary.json`, as far as it is needed; other keys are passed over.

use std::ops::Range;
use std::path::Path;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::read_json;
use crate::config::CostMode;
pub(super) use crate::folder::SUMMARY as FILE;
use crate::provenance::{Checksum, RunId};
use crate::text::Diagnostic;
use crate::yaml::{Fault, Source};

/// Longest summary that is read, in bytes: a short name for each of a million
/// objects fits.
pub(super) const MAX_BYTES: u64 = 256 << 20;

/// What was done, on what, and what it cost in all.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Summary {
    /// The version of raycost that rendered.
    pub raycost: String,
    /// The run, as its files name it; `None` of versions that gave none.
    #[serde(rename = "raycost_run")]
    pub run: Option<RunId>,
    /// The files that it wrote, but for the summary itself.
    #[serde(default)]
    pub files: Vec<ListedFile>,
    /// The scene.
    pub scene: SceneName,
    /// The picture's size and sampling.
    pub image: Image,
    /// Where the pixels lie in the world.
    pub camera: Option<Camera>,
    /// The objects in the file's order: `object` is an index into them.
    pub objects: Vec<Object>,
    /// The materials' names: `material` is an index into them.
    pub materials: Vec<String>,
    /// Primitives in the scene.
    pub n_primitives: u64,
    /// How hits were found.
    pub acceleration: Acceleration,
    /// On what.
    pub machine: Machine,
    /// How many threads rendered.
    pub threads: Threads,
    /// The parts of the run in their order.
    pub stages: Vec<Stage>,
    /// The times of a picture that was rendered more than once.
    pub repeats: Option<Repeats>,
    /// How many pixels see something.
    pub n_hits: u64,
    /// What was measured.
    pub cost: Cost,
}

/// A file of the run.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct ListedFile {
    /// Its name in the folder.
    #[serde(rename = "file")]
    pub name: String,
    /// Its length.
    pub bytes: u64,
    /// Its checksum; `None` of versions that gave none.
    pub checksum: Option<Checksum>,
}

/// A scene's names.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct SceneName {
    /// The file's stem.
    pub name: String,
    /// The file as the user typed it.
    pub file: String,
}

/// A picture's size and sampling.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Image {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Samples a pixel.
    pub samples_per_pixel: u32,
    /// Seed of the sampling pattern.
    pub seed: u64,
}

/// Where the pixels lie in the world. There is an `eye` or a `direction`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Where all rays come from.
    pub eye: Option<[f32; 3]>,
    /// Where all rays go, a unit vector.
    pub direction: Option<[f32; 3]>,
    /// The sample point of the pixel on top left.
    pub origin: [f32; 3],
    /// From one column's sample point to the next one's.
    pub right: [f32; 3],
    /// From one row's sample point to that of the row below.
    pub down: [f32; 3],
}

/// An object of the scene file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Object {
    /// Its name, where it has one.
    pub name: Option<String>,
    /// Its shape: `sphere`, `mesh`, …
    pub kind: String,
    /// The names of its materials.
    pub materials: Vec<String>,
}

/// How hits were found.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Acceleration {
    /// `bvh` or `brute_force`.
    pub kind: String,
    /// `fast`, `balanced` or `high`, of a BVH.
    pub quality: Option<String>,
}

/// What rendered, as far as it could be told.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Machine {
    /// The operating system with its version.
    pub os: Option<String>,
    /// `x86_64`, `aarch64`, …
    pub arch: String,
    /// The processor's name.
    pub cpu: Option<String>,
}

/// How many threads rendered.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Threads {
    /// In this run.
    pub used: usize,
    /// That the machine has.
    pub available: usize,
}

/// A part of the run and its time.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Stage {
    /// What was done.
    pub name: String,
    /// Time on the wall, in milliseconds.
    pub wall_ms: f64,
    /// Time of all threads together, in milliseconds.
    pub cpu_ms: f64,
}

/// The times of a picture that was rendered more than once.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Repeats {
    /// How often.
    pub n: usize,
    /// The sum of all pixels' times of each, in nanoseconds.
    pub busy_ns: Vec<f64>,
    /// Time on the wall of each, in milliseconds.
    pub wall_ms: Vec<f64>,
}

/// What was measured, and the sums of it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Cost {
    /// Which arrays there are.
    pub mode: CostMode,
    /// What took the time, if anything did.
    pub clock: Option<Clock>,
    /// The sums of the frame's arrays by the arrays' names; `None` without
    /// counters, and a `None` within where time was not taken.
    pub totals: Option<IndexMap<String, Option<f64>>>,
}

/// The clock of a timed run.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Clock {
    /// `tsc` or `os`.
    pub source: String,
    /// What it costs to read, in nanoseconds; taken off every pixel.
    pub overhead_ns: f64,
}

impl Summary {
    /// Reads a summary.
    ///
    /// # Errors
    /// A diagnostic that points at the line where it is none.
    pub fn read(path: &Path) -> Result<Self, Diagnostic> {
        let name = path.display().to_string();
        let text = read_json(path, MAX_BYTES)
            .map_err(|error| Diagnostic::new(format!("cannot read `{name}`: {error}")))?;
        serde_json::from_str(&text).map_err(|error| {
            let message = format!("`{name}` is no summary of a rendering: {error}");
            let fault = Fault::of_bytes(place(&text, &error), message, "not as raycost writes it")
                .with_help("render the scene again");
            Source::new(name, text.as_str()).point_at(fault)
        })
    }
}

/// The byte that an error points at; its column counts bytes from 1.
fn place(text: &str, error: &serde_json::Error) -> Range<usize> {
    let lines = text.split_inclusive('\n').take(error.line().max(1) - 1);
    let begin: usize = lines.map(str::len).sum();
    let mut at = (begin + error.column().max(1) - 1).min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at..text.len().min(at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUMMARY: &str = r#"{
  "raycost": "0.1.0",
  "scene": { "name": "a", "file": "a.yaml" },
  "image": { "width": 4, "height": 3, "samples_per_pixel": 1, "seed": 0, "new": 1 },
  "objects": [{ "name": null, "kind": "sphere", "materials": ["blue"] }],
  "materials": ["blue"],
  "n_primitives": 1,
  "acceleration": { "kind": "brute_force", "quality": null, "bvh": null },
  "machine": { "os": null, "arch": "x86_64", "cpu": null },
  "threads": { "used": 2, "available": 2 },
  "stages": [],
  "n_hits": 7,
  "cost": { "mode": "counters", "clock": null, "totals": { "time_ns": null, "rays": 12 } }
}"#;

    fn read(text: &str) -> Result<Summary, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(FILE);
        std::fs::write(&path, text).unwrap();
        Summary::read(&path).map_err(|error| error.to_string())
    }

    #[test]
    fn unknown_keys_are_passed_over() {
        let summary = read(SUMMARY).unwrap();
        assert_eq!((summary.image.width, summary.n_hits), (4, 7));
        let totals = summary.cost.totals.unwrap();
        assert_eq!((totals["rays"], totals["time_ns"]), (Some(12.0), None));
    }

    #[test]
    fn a_mistake_is_shown_with_its_line() {
        let error = read(&SUMMARY.replace("\"height\": 3", "\"height\": -3")).unwrap_err();
        assert!(error.contains("no summary of a rendering"), "{error}");
        assert!(error.contains("summary.json:4:"), "{error}");
        for n in 0..SUMMARY.len() {
            assert!(read(&SUMMARY[..n]).is_err());
        }
        assert!(read("ü").unwrap_err().contains("line 1"));
    }
}
