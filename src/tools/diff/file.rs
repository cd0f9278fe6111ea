//! The row of a file of a diff: its name, and its writer.

use std::io;

use super::{Diff, Gate, Side};
use host::folder::{FileWriter, OutputFolder};
use host::provenance::RunId;

/// A file of a diff. Its source file defines it; `files.rs` lists all.
pub struct DiffFile {
    /// Name of the file in the folder.
    pub name: &'static str,
    pub(super) write: fn(&DiffJob, &mut FileWriter) -> io::Result<()>,
}

/// Inputs of the writers.
pub(super) struct DiffJob<'a> {
    pub(super) diff: &'a Diff,
    pub(super) sides: &'a [Side; 2],
    pub(super) folder: &'a OutputFolder,
    pub(super) gate: Option<&'a Gate>,
    /// The ID that the file has to hold.
    pub(super) run: RunId,
}
