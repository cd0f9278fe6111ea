//! ParaView states of a folder that has moved.

use std::io::Write;
use std::path::{Path, PathBuf, absolute};

use crate::paraview::relocated;
use crate::summary::{self, Summary};
use host::files;
use host::folder::{Replace, WriteError, lock_folder, write_file};
use host::provenance;

/// Longest state that is read, in bytes: a hundred times the longest template.
const MAX_BYTES: u64 = 16 << 20;

/// Writes the ParaView states in a folder anew, with the paths of the files that lie beside them,
/// and the summary that lists them, also if one of them cannot be written. Returns the number of
/// states that had other paths.
///
/// # Errors
/// The folder cannot be read, is in use by another run, or a file cannot be written.
pub fn relocate_states(folder: &Path) -> Result<u64, WriteError> {
    let fail = |error| WriteError::new(folder, error);
    let entries = folder.read_dir().map_err(fail)?;
    let _lock = lock_folder(folder)?;
    let absolute = absolute(folder).map_err(fail)?;
    let place = folder.join(summary::FILE);
    let mut summary = Summary::read(&place).ok();
    let mut n_written = 0;
    let mut relocate = |path: PathBuf| {
        if path.extension().is_none_or(|extension| extension != "pvsm") || !path.is_file() {
            return Ok(());
        }
        let state =
            files::read_text(&path, MAX_BYTES).map_err(|error| WriteError::new(&path, error))?;
        let moved = relocated(&state, &absolute);
        // A state that the user has saved is left as it is.
        if moved == state || !state.contains(provenance::KEY) {
            return Ok(());
        }
        let written = write_file(&path, Replace::Marked, |out| {
            out.write_all(moved.as_bytes())
        })?;
        let listed = summary.iter_mut().flat_map(|summary| &mut summary.files);
        for file in listed.filter(|file| path.ends_with(&file.name)) {
            (file.bytes, file.checksum) = (written.bytes, Some(written.checksum));
        }
        n_written += 1;
        Ok(())
    };
    let states = entries
        .map(|entry| relocate(entry.map_err(fail)?.path()))
        .fold(Ok(()), Result::and);
    if let Some(summary) = summary.filter(|_| n_written > 0) {
        write_file(&place, Replace::Marked, |out| summary.write(out))?;
    }
    states.map(|()| n_written)
}
