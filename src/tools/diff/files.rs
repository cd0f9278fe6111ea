//! Writes the files of a diff.

use std::io;

use rayon::prelude::*;
use serde::Serialize;

use super::file::{DiffFile, DiffJob};
use super::gate::Gate;
use super::json::{self, DiffJson};
use super::{Diff, Side, map, state, volume};
use host::folder::{FileWriter, OutputFolder, Own, WriteError, Written};
use host::provenance::{Hasher, RunId};

/// In the order of the report.
const FILES: [DiffFile; 4] = [map::FILE, volume::FILE, state::FILE, json::FILE];

/// Writes the files of a diff and returns them in the order of the report.
///
/// # Errors
/// The first file that could not be written; then no file of the folder has changed.
pub fn write(
    diff: &Diff,
    sides: &[Side; 2],
    gate: Option<&Gate>,
    folder: &OutputFolder,
) -> Result<Vec<Written>, WriteError> {
    let names = FILES.map(|file| file.name);
    let json = DiffJson::new(diff, sides, gate);
    write_files(&names, &json, folder, |name, run, out| {
        let job = DiffJob {
            diff,
            sides,
            folder,
            gate,
            run,
        };
        let file = FILES.iter().find(|file| file.name == name);
        file.map_or(Ok(()), |file| (file.write)(&job, out))
    })
}

/// Writes the files of a comparison with these names; `write` gets the name of the file, and the ID
/// of the comparison, which the file has to hold. Removes the other files of an earlier comparison.
pub(super) fn write_files(
    names: &[&str],
    comparison: &impl Serialize,
    folder: &OutputFolder,
    write: impl Fn(&str, RunId, &mut FileWriter) -> io::Result<()> + Sync,
) -> Result<Vec<Written>, WriteError> {
    let run = run_id(comparison);
    let staging = folder.stage_files()?;
    let stage = |name: &&str| staging.stage(*name, |out| write(name, run, out));
    let files: Vec<Written> = names.par_iter().map(stage).collect::<Result<_, _>>()?;
    staging.commit(&files, &own())?;
    Ok(files)
}

/// Returns the ID of a comparison: the hash of its JSON.
fn run_id(comparison: &impl Serialize) -> RunId {
    let mut hasher = Hasher::default();
    // Fails neither in the hasher nor by keys that are not text.
    let _ = serde_json::to_writer(&mut hasher, comparison);
    hasher.checksum().into()
}

/// Checks that [`write()`] would not overwrite a file of another program.
///
/// # Errors
/// The first such file.
pub fn refuse_foreign(folder: &OutputFolder) -> Result<(), WriteError> {
    folder.refuse_foreign(&own())
}

fn own() -> Own {
    Own::Marked(FILES.iter().map(|file| file.name).collect())
}
