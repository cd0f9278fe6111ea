//! Writes the files of a diff.

use std::io::Write;

use rayon::prelude::*;

use super::gate::Gate;
use super::{Diff, Side, map, state, to_json, volume};
use crate::folder::{OutputFolder, Own, StagedFile, WriteError, Written};
use crate::provenance::{self, RunId, checksum, stamped};

/// A file of a diff, in the order of the report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum DiffFile {
    /// The change of one metric as a picture.
    Png,
    /// The change of every metric as ImageData.
    Vti,
    /// A ParaView state that shows them.
    State,
    /// The whole diff as JSON.
    Json,
}

const ALL: [DiffFile; 4] = [
    DiffFile::Png,
    DiffFile::Vti,
    DiffFile::State,
    DiffFile::Json,
];

impl DiffFile {
    fn file_name(self) -> &'static str {
        match self {
            Self::Png => "diff.png",
            Self::Vti => volume::FILE,
            Self::State => "diff.pvsm",
            Self::Json => "diff.json",
        }
    }
}

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
    let staging = folder.stage_files()?;
    let stage = |artifact: &DiffFile| {
        staging.stage(artifact.file_name(), |out| match artifact {
            DiffFile::Png => map::write(diff, sides, run, out),
            DiffFile::Vti => volume::write(diff, sides, run, out),
            DiffFile::State => out.write_all(stamped(&state::text(diff, folder), run).as_bytes()),
            DiffFile::Json => {
                serde_json::to_writer_pretty(&mut *out, &json)?;
                writeln!(out)
            }
        })
    };
    let files: Vec<StagedFile> = ALL.par_iter().map(stage).collect::<Result<_, _>>()?;
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
    Own::Marked(ALL.into_iter().map(DiffFile::file_name).collect())
}
