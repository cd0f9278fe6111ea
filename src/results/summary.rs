//! The part of `summary.json` that raycost reads; other keys are ignored.

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

/// Most bytes of a summary; a million objects with short names fit.
pub(super) const MAX_BYTES: u64 = 256 << 20;

/// The content of `summary.json`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Summary {
    /// The version of raycost that rendered.
    pub raycost: String,
    /// The id of the run, which its files repeat; `None` in files of versions
    /// without ids.
    #[serde(rename = "raycost_run")]
    pub run: Option<RunId>,
    /// The files of the run except the summary itself.
    #[serde(default)]
    pub files: Vec<ListedFile>,
    /// The scene.
    pub scene: SceneName,
    /// The picture's size and sampling.
    pub image: Image,
    /// The pixels' positions in world space.
    pub camera: Option<Camera>,
    /// The objects in the file's order: `object` is an index into them.
    pub objects: Vec<Object>,
    /// The materials' names: `material` is an index into them.
    pub materials: Vec<String>,
    /// Primitives in the scene.
    pub n_primitives: u64,
    /// The acceleration structure.
    pub acceleration: Acceleration,
    /// The machine.
    pub machine: Machine,
    /// The number of threads.
    pub threads: Threads,
    /// The stages of the run in their order.
    pub stages: Vec<Stage>,
    /// The times of the repeats; `None` if the picture was rendered once.
    pub repeats: Option<Repeats>,
    /// The number of pixels with a hit.
    pub n_hits: u64,
    /// The measured cost.
    pub cost: Cost,
}

/// A file of the run.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct ListedFile {
    /// Its name in the folder.
    #[serde(rename = "file")]
    pub name: String,
    /// Its length in bytes.
    pub bytes: u64,
    /// Its checksum; `None` in files of versions without checksums.
    pub checksum: Option<Checksum>,
}

/// The names of a scene.
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
    /// Samples per pixel.
    pub samples_per_pixel: u32,
    /// Seed of the sampling pattern.
    pub seed: u64,
}

/// The pixels' positions in world space. A camera has either an `eye` or a `direction`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// The common origin of all rays, of a perspective camera.
    pub eye: Option<[f32; 3]>,
    /// The common direction of all rays, a unit vector, of an orthographic camera.
    pub direction: Option<[f32; 3]>,
    /// The sample point of the top left pixel.
    pub origin: [f32; 3],
    /// The vector from a sample point to that of the next column.
    pub right: [f32; 3],
    /// The vector from a sample point to that of the row below.
    pub down: [f32; 3],
}

/// An object of the scene file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Object {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Its shape: `sphere`, `mesh`, …
    pub kind: String,
    /// The names of its materials.
    pub materials: Vec<String>,
}

/// The acceleration structure.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Acceleration {
    /// `bvh` or `brute_force`.
    pub kind: String,
    /// `fast`, `balanced` or `high`, of a BVH.
    pub quality: Option<String>,
}

/// The machine, as far as the system reports it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Machine {
    /// The operating system with its version.
    pub os: Option<String>,
    /// `x86_64`, `aarch64`, …
    pub arch: String,
    /// The processor's name.
    pub cpu: Option<String>,
}

/// Numbers of threads.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Threads {
    /// The number that rendered.
    pub used: usize,
    /// The number that the machine offers.
    pub available: usize,
}

/// A stage of the run and its time.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Stage {
    /// Its name.
    pub name: String,
    /// Wall time in milliseconds.
    pub wall_ms: f64,
    /// CPU time of all threads in milliseconds.
    pub cpu_ms: f64,
}

/// The times of the repeats of a picture.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Repeats {
    /// The number of repeats.
    pub n: usize,
    /// For each repeat the sum of all pixels' times, in nanoseconds.
    pub busy_ns: Vec<f64>,
    /// For each repeat the wall time, in milliseconds.
    pub wall_ms: Vec<f64>,
}

/// The measured cost and its totals.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Cost {
    /// The mode of measurement.
    pub mode: CostMode,
    /// The clock; `None` without times.
    pub clock: Option<Clock>,
    /// The totals of the frame's arrays by the arrays' names; `None` without
    /// counters. A value is `None` if it was not measured.
    pub totals: Option<IndexMap<String, Option<f64>>>,
}

/// The clock of a timed run.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Clock {
    /// `tsc` or `os`.
    pub source: String,
    /// The cost of one reading in nanoseconds, which is subtracted from every pixel's
    /// time.
    pub overhead_ns: f64,
}

impl Summary {
    /// Reads a summary.
    ///
    /// # Errors
    /// The file cannot be read, or is not a summary: points at the line.
    pub fn read(path: &Path) -> Result<Self, Diagnostic> {
        let name = path.display().to_string();
        let text = read_json(path, MAX_BYTES)
            .map_err(|error| Diagnostic::new(format!("cannot read `{name}`: {error}")))?;
        serde_json::from_str(&text).map_err(|error| {
            let message = format!("`{name}` is not a summary of a rendering: {error}");
            let fault = Fault::of_bytes(place(&text, &error), message, "not as raycost writes it")
                .with_help("render the scene again");
            Source::new(name, text.as_str()).point_at(fault)
        })
    }
}

/// Returns the byte that an error points at; its column counts bytes from 1.
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
    fn unknown_keys_are_ignored() {
        let summary = read(SUMMARY).unwrap();
        assert_eq!((summary.image.width, summary.n_hits), (4, 7));
        let totals = summary.cost.totals.unwrap();
        assert_eq!((totals["rays"], totals["time_ns"]), (Some(12.0), None));
    }

    #[test]
    fn a_mistake_is_shown_with_its_line() {
        let error = read(&SUMMARY.replace("\"height\": 3", "\"height\": -3")).unwrap_err();
        assert!(error.contains("not a summary of a rendering"), "{error}");
        assert!(error.contains("summary.json:4:"), "{error}");
        for n in 0..SUMMARY.len() {
            assert!(read(&SUMMARY[..n]).is_err());
        }
        assert!(read("ü").unwrap_err().contains("line 1"));
    }
}
