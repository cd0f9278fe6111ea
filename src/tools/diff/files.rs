//! Writes the files of a diff.

use std::io;

use rayon::prelude::*;
use serde_json::Value;

use super::file::{DiffFile, DiffJob};
use super::gate::Gate;
use super::{Diff, Side, json, map, state, to_json, volume};
use base::folder::{FileWriter, OutputFolder, Own, WriteError, Written};
use base::provenance::{self, RunId, checksum};

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
    let json = to_json(diff, sides, gate);
    write_files(&names, json, folder, |name, json, run, out| {
        let job = DiffJob {
            diff,
            sides,
            folder,
            json,
            run,
        };
        let file = FILES.iter().find(|file| file.name == name);
        file.map_or(Ok(()), |file| (file.write)(&job, out))
    })
}

/// Writes the files of a comparison with these names; `write` gets the name of the file, the
/// comparison as JSON with the ID, and the ID, which the file has to hold. Removes the other files
/// of an earlier comparison.
pub(super) fn write_files(
    names: &[&str],
    mut json: Value,
    folder: &OutputFolder,
    write: impl Fn(&str, &Value, RunId, &mut FileWriter) -> io::Result<()> + Sync,
) -> Result<Vec<Written>, WriteError> {
    let run: RunId = checksum(json.to_string().as_bytes()).into();
    if let Some(entries) = json.as_object_mut() {
        // In front: a file is recognized by its first bytes.
        entries.shift_insert(0, provenance::KEY.to_owned(), serde_json::json!(run));
    }
    let staging = folder.stage_files()?;
    let stage = |name: &&str| staging.stage(*name, |out| write(name, &json, run, out));
    let files: Vec<Written> = names.par_iter().map(stage).collect::<Result<_, _>>()?;
    staging.commit(&files, &own())?;
    Ok(files)
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
