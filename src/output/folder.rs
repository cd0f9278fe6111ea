//! The folder that the files go to, changed as a whole or not at all.

use std::fmt;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use tempfile::NamedTempFile;

use super::stages::milliseconds;
use super::{Written, format};
use crate::host::advice;

/// Bytes that go to the system at one go: many rows, and yet within the cache.
const BUFFER: usize = 1 << 16;

/// A folder that files can be written to.
#[derive(Debug, Clone)]
pub struct OutputFolder {
    path: PathBuf,
}

/// A whole file that waits to take its name; without it, it goes.
#[derive(Debug)]
pub(crate) struct StagedFile {
    name: &'static str,
    n_bytes: u64,
    write_ms: f64,
    temporary: NamedTempFile,
}

/// A file or folder that could not be written.
#[derive(Debug)]
pub struct WriteError {
    path: PathBuf,
    error: io::Error,
}

impl WriteError {
    fn new(path: impl Into<PathBuf>, error: io::Error) -> Self {
        Self {
            path: path.into(),
            error,
        }
    }

    /// What to do about it.
    pub fn help(&self) -> &'static str {
        if let Some(advice) = advice(&self.error) {
            return advice;
        }
        match self.error.kind() {
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                "choose a folder that you may write to with `--out`"
            }
            _ => "choose another folder with `--out`",
        }
    }
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot write `{}`: {}", self.path.display(), self.error)
    }
}

impl std::error::Error for WriteError {}

impl OutputFolder {
    /// Makes the folder if it is not there, and makes sure that files can be
    /// written to it and that `n_bytes` are free.
    ///
    /// # Errors
    /// What keeps files from being written.
    pub fn create(path: &Path, n_bytes: u64) -> Result<Self, WriteError> {
        let fail = |error| WriteError::new(path, error);
        std::fs::create_dir_all(path).map_err(fail)?;
        // Absolute, since ParaView may be started from anywhere.
        let path = std::path::absolute(path).map_err(fail)?;
        temporary_in(&path).map_err(fail)?;
        let free = fs4::available_space(&path).map_err(fail)?;
        if free < n_bytes {
            let message = format!(
                "{} are free, {} or more are needed",
                format::bytes(free),
                format::bytes(n_bytes)
            );
            return Err(fail(io::Error::new(io::ErrorKind::StorageFull, message)));
        }
        Ok(Self { path })
    }

    /// Removes what this process has not finished writing, as far as that
    /// goes: for a process that is about to be stopped.
    pub fn remove_unfinished(&self) {
        let prefix = temporary_prefix();
        for entry in std::fs::read_dir(&self.path)
            .into_iter()
            .flatten()
            .flatten()
        {
            if entry.file_name().to_string_lossy().starts_with(&prefix) {
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }

    /// The absolute path of a file in the folder.
    pub fn path_of(&self, file: &str) -> PathBuf {
        self.path.join(file)
    }

    /// Writes a file that will be called `name`.
    ///
    /// # Errors
    /// What `write` or the system says.
    pub(crate) fn stage(
        &self,
        name: &'static str,
        write: impl FnOnce(&mut BufWriter<&mut NamedTempFile>) -> io::Result<()>,
    ) -> Result<StagedFile, WriteError> {
        let fail = |error| WriteError::new(self.path_of(name), error);
        let start = Instant::now();
        let mut temporary = temporary_in(&self.path).map_err(fail)?;
        let n_bytes = fill(&mut temporary, write).map_err(fail)?;
        Ok(StagedFile {
            name,
            n_bytes,
            write_ms: milliseconds(start.elapsed()),
            temporary,
        })
    }

    /// Gives all files their names, and removes what an earlier run left under
    /// the `stale` ones.
    ///
    /// # Errors
    /// The first name that could not be given.
    pub(crate) fn commit(
        &self,
        files: Vec<StagedFile>,
        stale: impl Iterator<Item = &'static str>,
    ) -> Result<(), WriteError> {
        let paths = files.iter().map(|file| self.path_of(file.name));
        if let Some(path) = paths.into_iter().find(|path| path.is_dir()) {
            return Err(WriteError::new(path, io::ErrorKind::IsADirectory.into()));
        }
        for file in files {
            let path = self.path_of(file.name);
            file.temporary
                .persist(&path)
                .map_err(|error| WriteError::new(path, error.error))?;
        }
        for name in stale {
            let path = self.path_of(name);
            match std::fs::remove_file(&path) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    return Err(WriteError::new(path, error));
                }
                _ => {}
            }
        }
        Ok(())
    }
}

impl StagedFile {
    /// What to say of it.
    pub(crate) fn written(&self) -> Written {
        Written {
            file: self.name,
            bytes: self.n_bytes,
            write_ms: self.write_ms,
        }
    }
}

/// Writes a single file, which takes its name when it is whole; gives its
/// length in bytes.
///
/// # Errors
/// What `write` or the system says; then an old file is still there.
pub(crate) fn write_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut NamedTempFile>) -> io::Result<()>,
) -> Result<u64, WriteError> {
    let fail = |error| WriteError::new(path, error);
    if path.is_dir() {
        return Err(fail(io::ErrorKind::IsADirectory.into()));
    }
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let mut temporary = temporary_in(folder).map_err(fail)?;
    let n_bytes = fill(&mut temporary, write).map_err(fail)?;
    temporary.persist(path).map_err(|error| fail(error.error))?;
    Ok(n_bytes)
}

/// Writes all of a file; gives its length in bytes.
fn fill(
    temporary: &mut NamedTempFile,
    write: impl FnOnce(&mut BufWriter<&mut NamedTempFile>) -> io::Result<()>,
) -> io::Result<u64> {
    let mut out = BufWriter::with_capacity(BUFFER, &mut *temporary);
    write(&mut out)?;
    out.flush()?;
    drop(out);
    Ok(temporary.as_file().metadata()?.len())
}

/// A file without a name of its own yet, removed when dropped.
fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    let prefix = temporary_prefix();
    builder.prefix(&prefix).suffix(".part");
    // As any file that a program makes: the default is for secrets.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// How the names of this process's temporary files begin.
fn temporary_prefix() -> String {
    format!(".raycost-{}-", std::process::id())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(path: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(path).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn files_appear_together_at_the_end() {
        let temporary = tempfile::tempdir().unwrap();
        let read = |name| std::fs::read(temporary.path().join(name)).unwrap();
        std::fs::write(temporary.path().join("old"), "old").unwrap();
        std::fs::write(temporary.path().join("stale"), "stale").unwrap();
        let folder = OutputFolder::create(temporary.path(), 0).unwrap();
        let file = folder.stage("old", |out| out.write_all(b"newer")).unwrap();
        assert_eq!(file.written().bytes, 5);
        assert_eq!(read("old"), b"old");
        let stale = ["stale", "never was"].into_iter();
        folder.commit(vec![file], stale).unwrap();
        assert_eq!(names(temporary.path()), ["old"]);
        assert_eq!(read("old"), b"newer");
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let temporary = tempfile::tempdir().unwrap();
        std::fs::write(temporary.path().join("old"), "old").unwrap();
        let folder = OutputFolder::create(temporary.path(), 0).unwrap();
        let full = || io::Error::from(io::ErrorKind::StorageFull);
        let error = folder
            .stage("old", |out| out.write_all(b"half").and(Err(full())))
            .unwrap_err();
        assert!(error.to_string().contains("old"), "{error}");
        assert!(error.help().contains("free some space"));
        assert_eq!(names(temporary.path()), ["old"]);
        assert_eq!(std::fs::read(temporary.path().join("old")).unwrap(), b"old");
    }

    #[test]
    fn a_folder_in_the_way_is_found_before_any_file_changes() {
        let temporary = tempfile::tempdir().unwrap();
        std::fs::create_dir(temporary.path().join("taken")).unwrap();
        let folder = OutputFolder::create(temporary.path(), 0).unwrap();
        let stage = |name| folder.stage(name, |out| out.write_all(b"x")).unwrap();
        let files = vec![stage("free"), stage("taken")];
        let error = folder.commit(files, [].into_iter()).unwrap_err();
        assert!(error.to_string().contains("taken"), "{error}");
        assert_eq!(names(temporary.path()), ["taken"]);
    }

    #[test]
    fn a_stopped_process_leaves_nothing_unfinished() {
        let temporary = tempfile::tempdir().unwrap();
        let folder = OutputFolder::create(temporary.path(), 0).unwrap();
        let file = folder.stage("half", |out| out.write_all(b"x")).unwrap();
        assert_eq!(names(temporary.path()).len(), 1);
        folder.remove_unfinished();
        assert!(names(temporary.path()).is_empty());
        drop(file);
    }

    #[test]
    fn a_full_disk_is_seen_before_anything_is_written() {
        let temporary = tempfile::tempdir().unwrap();
        let error = OutputFolder::create(temporary.path(), u64::MAX).unwrap_err();
        assert!(error.to_string().contains("are needed"), "{error}");
    }
}
