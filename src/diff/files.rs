//! The files of a diff.

use std::io::Write;

use rayon::prelude::*;

use super::gate::Gate;
use super::{Diff, Side, map, state, to_json, volume};
use crate::output::{OutputFolder, StagedFile, WriteError, Written};

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
    let stage = |artifact: &Artifact| {
        folder.stage(artifact.file_name(), |out| match artifact {
            Artifact::Png => map::write(diff, sides, out),
            Artifact::Vti => volume::write(diff, sides, out),
            Artifact::State => out.write_all(state::text(diff, folder).as_bytes()),
            Artifact::Json => {
                serde_json::to_writer_pretty(&mut *out, &to_json(diff, sides, gate))?;
                writeln!(out)
            }
        })
    };
    let files: Vec<StagedFile> = ALL.par_iter().map(stage).collect::<Result<_, _>>()?;
    let written = files.iter().map(StagedFile::written).collect();
    folder.commit(files, std::iter::empty())?;
    Ok(written)
}
