//! Reading a summary.

use std::io;
use std::ops::Range;
use std::path::Path;

use serde::de::DeserializeOwned;

use super::Summary;
use host::available_memory;
use host::files;
use host::text::Diagnostic;
use scene::yaml::{Fault, Source};

/// Maximum length of a summary in bytes: enough for a million objects with short names.
pub const MAX_BYTES: u64 = 256 << 20;

/// Maximum bytes of memory per byte of JSON text: a value for every other byte.
const MEMORY_PER_BYTE: u64 = 40;

impl Summary {
    /// Reads a summary.
    ///
    /// # Errors
    /// The file cannot be read, or a line is not as raycost writes it.
    pub fn read(path: &Path) -> Result<Self, Diagnostic> {
        let what = "a summary of a rendering";
        read_value(path, MAX_BYTES, what, "render the scene again")
    }
}

/// Reads a JSON file of raycost. `what` names its content, and `help` advises how to make it.
///
/// # Errors
/// The file cannot be read, or a line is not as raycost writes it.
pub fn read_value<T: DeserializeOwned>(
    path: &Path,
    max_bytes: u64,
    what: &str,
    help: &str,
) -> Result<T, Diagnostic> {
    let name = path.display().to_string();
    let text = read_json(path, max_bytes).map_err(|error| {
        Diagnostic::new(format!("cannot read `{name}`: {error}")).with_help(help)
    })?;
    serde_json::from_str(&text).map_err(|error| {
        let message = format!("`{name}` is not {what}: {error}");
        let fault = Fault::at_bytes(place(&text, &error), message, "not as raycost writes it")
            .with_help(help);
        Source::new(name, text.as_str()).point_at(fault)
    })
}

/// Returns the byte that an error points at; the error's column is in bytes, from 1.
fn place(text: &str, error: &serde_json::Error) -> Range<usize> {
    let lines = text.split_inclusive('\n').take(error.line().max(1) - 1);
    let begin: usize = lines.map(str::len).sum();
    let mut at = (begin + error.column().max(1) - 1).min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at..text.len().min(at + 1)
}

/// Reads the text of a JSON file.
///
/// # Errors
/// The file cannot be read, is longer than `max_bytes`, or its values may not fit into the free
/// memory.
pub(crate) fn read_json(path: &Path, max_bytes: u64) -> io::Result<String> {
    files::read_text(path, max_bytes.min(available_memory() / MEMORY_PER_BYTE))
}

#[cfg(test)]
mod tests {
    use super::super::FILE;
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
        let total = |array| summary.cost.total(array);
        assert_eq!((total("rays"), total("time_ns")), (Some(12.0), None));
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
