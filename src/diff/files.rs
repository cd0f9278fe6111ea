//! The files of a diff.

use std::io::Write;

use rayon::prelude::*;

use super::gate::Gate;
use super::{Diff, Side, map, state, to_json, volume};
use crate::folder::{OutputFolder, Own, StagedFile, WriteError, Written};
use crate::provenance::{self, RunId, checksum, stamped};

/// The files, in the order of the report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Artifact {
    /// The change as a picture.
    Png,
    /// The change as an image of many arrays.
    Vti,
    /// A ParaView state that shows them.
    State,
    /// All that the report says, and more.
    Json,
}

const ALL: [Artifact; 4] = [
    Artifact::Png,
    Artifact::Vti,
    Artifact::State,
    Artifact::Json,
];

impl Artifact {
    fn file_name(self) -> &'static str {
        match self {
            Self::Png => "diff.png",
            Self::Vti => volume::FILE,
            Self::State => "diff.pvsm",
            Self::Json => "diff.json",
        }
    }
}

/// Writes the files of a diff; gives them in their order.
///
/// # Errors
/// The first file that could not be written; then no file has changed.
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
    let stage = |artifact: &Artifact| {
        staging.stage(artifact.file_name(), |out| match artifact {
            Artifact::Png => map::write(diff, sides, run, out),
            Artifact::Vti => volume::write(diff, sides, run, out),
            Artifact::State => out.write_all(stamped(&state::text(diff, folder), run).as_bytes()),
            Artifact::Json => {
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

/// Makes sure that no file in the folder is someone else's of a name that
/// [`write()`] writes.
///
/// # Errors
/// Such a file.
pub fn refuse_foreign(folder: &OutputFolder) -> Result<(), WriteError> {
    folder.refuse_foreign(&own())
}

fn own() -> Own {
    Own::Marked(ALL.into_iter().map(Artifact::file_name).collect())
}
