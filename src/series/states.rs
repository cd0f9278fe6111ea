//! The ParaView states of the frames.

use std::path::PathBuf;

use super::PREFIX;
use crate::output::{StateValues, state_template};
use crate::provenance::{RunId, stamped};

/// The readers of single files, as the templates name them.
const READERS: [&str; 2] = [
    "type=\"XMLImageDataReader\"",
    "type=\"XMLUnstructuredGridReader\"",
];
/// The reader of `.pvd` files.
const COLLECTION_READER: &str = "type=\"PVDReader\"";

/// The states among the files of a frame, for all frames: their names and texts. `path_of`
/// returns the path of the `.pvd` of a VTK file.
pub(super) fn of_files(
    files: &[String],
    values: &StateValues,
    path_of: impl Fn(&str) -> PathBuf,
    run: RunId,
) -> Vec<(String, String)> {
    let state = |file: &String| {
        let template = READERS.iter().fold(state_template(file)?.to_owned(), |text, reader| {
            text.replace(reader, COLLECTION_READER)
        });
        let state = values.filled(&template, &path_of);
        Some((format!("{PREFIX}_{file}"), stamped(&state, run)))
    };
    files.iter().filter_map(state).collect()
}
