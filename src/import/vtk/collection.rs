//! Lists of files over time, `.pvd`.

use super::super::{FileFault, Result};
use super::document::{number_or, parse, required};

/// The files of a time step: its parts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ListedStep {
    /// Paths relative to the list's folder, at least one.
    pub(crate) files: Vec<String>,
    pub(crate) time: f64,
}

impl ListedStep {
    /// Creates a time step of one file.
    pub(crate) fn new(file: String, time: f64) -> Self {
        let files = vec![file];
        Self { files, time }
    }
}

/// Returns the time steps of a `.pvd` in the order of their times, as ParaView does: files of the
/// same time are its parts, and files without a time are of time 0.
pub(crate) fn read(bytes: &[u8]) -> Result<Vec<ListedStep>> {
    let (root, _) = parse(bytes)?;
    let collection = root.child("Collection").ok_or_else(|| {
        FileFault::new(
            "it is not a collection of files",
            "a `.pvd` as ParaView writes it",
        )
    })?;
    let step = collection.children_named("DataSet").map(|entry| {
        let time = number_or(entry, "timestep", 0.0)?;
        Ok(ListedStep::new(required(entry, "file")?.to_owned(), time))
    });
    let mut parts = step.collect::<Result<Vec<ListedStep>>>()?;
    parts.sort_by(|a, b| a.time.total_cmp(&b.time));
    let mut steps: Vec<ListedStep> = Vec::new();
    for part in parts {
        match steps.last_mut().filter(|step| step.time == part.time) {
            Some(step) => step.files.extend(part.files),
            None => steps.push(part),
        }
    }
    Ok(steps)
}
