//! The folder that the files go to, changed as a whole or not at all.

use std::fmt;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::format;

/// Bytes that go to the system at one go.
const BUFFER: usize = 1 << 20;

/// An output folder, and the files that wait to take their names in it.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    staged: Vec<(&'static str, NamedTempFile)>,
    stale: Vec<&'static str>,
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
        match self.error.kind() {
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                "free some space, or choose another folder with `--out DIR`"
            }
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                "choose a folder that you may write to with `--out DIR`"
            }
            _ => "choose another folder with `--out DIR`",
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
        Ok(Self {
            path,
            staged: Vec::new(),
            stale: Vec::new(),
        })
    }

    /// The absolute path of a file in the folder.
    pub fn path_of(&self, file: &str) -> PathBuf {
        self.path.join(file)
    }

    /// Writes a file that will be called `file`; gives its length in bytes.
    ///
    /// # Errors
    /// What `write` or the system says.
    pub(super) fn stage(
        &mut self,
        file: &'static str,
        write: impl FnOnce(&Self, &mut BufWriter<&mut NamedTempFile>) -> io::Result<()>,
    ) -> Result<u64, WriteError> {
        let fail = |error| WriteError::new(self.path_of(file), error);
        let mut temporary = temporary_in(&self.path).map_err(fail)?;
        let mut out = BufWriter::with_capacity(BUFFER, &mut temporary);
        write(self, &mut out)
            .and_then(|()| out.flush())
            .map_err(fail)?;
        drop(out);
        let n_bytes = temporary.as_file().metadata().map_err(fail)?.len();
        self.staged.push((file, temporary));
        Ok(n_bytes)
    }

    /// Lets `commit` remove what an earlier run left under this name.
    pub(super) fn remove_on_commit(&mut self, file: &'static str) {
        self.stale.push(file);
    }

    /// Gives all staged files their names.
    ///
    /// # Errors
    /// The first name that could not be given.
    pub(super) fn commit(self) -> Result<(), WriteError> {
        for (file, temporary) in self.staged {
            let path = self.path.join(file);
            temporary
                .persist(&path)
                .map_err(|error| WriteError::new(path, error.error))?;
        }
        for file in self.stale {
            let path = self.path.join(file);
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

/// A file without a name of its own yet, removed when dropped.
fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".raycost-").suffix(".part");
    // As any file that a program makes: the default is for secrets.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
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
        std::fs::write(temporary.path().join("old"), "old").unwrap();
        let mut folder = OutputFolder::create(temporary.path(), 0).unwrap();
        let n_bytes = folder
            .stage("old", |_, out| out.write_all(b"newer"))
            .unwrap();
        assert_eq!(n_bytes, 5);
        assert_eq!(std::fs::read(temporary.path().join("old")).unwrap(), b"old");
        folder.remove_on_commit("never was");
        folder.commit().unwrap();
        assert_eq!(names(temporary.path()), ["old"]);
        assert_eq!(
            std::fs::read(temporary.path().join("old")).unwrap(),
            b"newer"
        );
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let temporary = tempfile::tempdir().unwrap();
        std::fs::write(temporary.path().join("old"), "old").unwrap();
        let mut folder = OutputFolder::create(temporary.path(), 0).unwrap();
        let full = || io::Error::from(io::ErrorKind::StorageFull);
        let error = folder
            .stage("old", |_, out| out.write_all(b"half").and(Err(full())))
            .unwrap_err();
        assert!(error.to_string().contains("old"), "{error}");
        assert!(error.help().contains("free some space"));
        drop(folder);
        assert_eq!(names(temporary.path()), ["old"]);
        assert_eq!(std::fs::read(temporary.path().join("old")).unwrap(), b"old");
    }

    #[test]
    fn a_full_disk_is_seen_before_anything_is_written() {
        let temporary = tempfile::tempdir().unwrap();
        let error = OutputFolder::create(temporary.path(), u64::MAX).unwrap_err();
        assert!(error.to_string().contains("are needed"), "{error}");
    }
}
