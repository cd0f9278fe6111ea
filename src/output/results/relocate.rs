//! ParaView states of a folder that has moved.

use std::io::Write;
use std::path::{Path, PathBuf, absolute};

use crate::paraview::relocated;
use crate::summary::{self, Summary};
use host::files;
use host::folder::{Replace, WriteError, lock_folder, refuse_foreign_file, write_file};
use host::provenance::{self, checksum};

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
    let (mut states, mut result) = (Vec::new(), Ok(()));
    for entry in entries {
        match moved_state(entry.map_err(fail)?.path(), &absolute) {
            Ok(state) => states.extend(state),
            Err(error) => result = result.and(Err(error)),
        }
    }
    if !states.is_empty() {
        // Before the states: if this run is killed, the next one writes those that are missing.
        list_states(&folder.join(summary::FILE), &states)?;
    }
    for state in &states {
        let text = state.text.as_bytes();
        let written = write_file(&state.path, Replace::Marked, |out| out.write_all(text));
        result = result.and(written.map(drop));
    }
    result.map(|()| states.len() as u64)
}

/// A state, and its text with the paths of its folder.
struct MovedState {
    path: PathBuf,
    text: String,
}

/// Returns a file if it is a state with the paths of another folder.
///
/// # Errors
/// It cannot be read or replaced.
fn moved_state(path: PathBuf, folder: &Path) -> Result<Option<MovedState>, WriteError> {
    if path.extension().is_none_or(|extension| extension != "pvsm") || !path.is_file() {
        return Ok(None);
    }
    let old = files::read_text(&path, MAX_BYTES).map_err(|error| WriteError::new(&path, error))?;
    let text = relocated(&old, folder);
    // A state that the user has saved is left as it is.
    if text == old || !old.contains(provenance::KEY) {
        return Ok(None);
    }
    refuse_foreign_file(&path, Replace::Marked)?;
    Ok(Some(MovedState { path, text }))
}

/// Writes the lengths and checksums of states to the summary, if there is one.
fn list_states(place: &Path, states: &[MovedState]) -> Result<(), WriteError> {
    let Ok(mut summary) = Summary::read(place) else {
        return Ok(());
    };
    for MovedState { path, text } in states {
        let listed = summary.files.iter_mut();
        for file in listed.filter(|file| path.ends_with(&file.name)) {
            file.bytes = text.len() as u64;
            file.checksum = Some(checksum(text.as_bytes()));
        }
    }
    write_file(place, Replace::Marked, |out| summary.write(out)).map(drop)
}
