//! Writes the files of a diff.

use rayon::prelude::*;

use super::file::{DiffFile, DiffJob};
use super::gate::Gate;
use super::{Diff, Side, json, map, state, to_json, volume};
use base::folder::{OutputFolder, Own, StagedFile, WriteError, Written};
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
    let mut json = to_json(diff, sides, gate);
    let run: RunId = checksum(json.to_string().as_bytes()).into();
    if let Some(entries) = json.as_object_mut() {
        // In front: a file is recognized by its first bytes.
        entries.shift_insert(0, provenance::KEY.to_owned(), serde_json::json!(run));
    }
    let job = DiffJob {
        diff,
        sides,
        folder,
        json: &json,
        run,
    };
    let staging = folder.stage_files()?;
    let stage = |file: &DiffFile| staging.stage(file.name, |out| (file.write)(&job, out));
    let files: Vec<StagedFile> = FILES.par_iter().map(stage).collect::<Result<_, _>>()?;
    let written = files.iter().map(StagedFile::written).collect();
    staging.commit(&files, &own())?;
    Ok(written)
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
