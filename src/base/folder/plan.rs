//! The plan of a commit, which the next run reads if this one is killed.

use std::fs;
use std::io;
use std::iter;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::disk::{self, change};
use crate::files;

/// The folder of new files in a workspace; after an exchange, the old folder.
pub(super) const NEW: &str = "new";
/// The folder of old files in a workspace that are replaced one by one.
pub(super) const OLD: &str = "old";
/// The file of the plan in a workspace.
pub(super) const PLAN: &str = "plan.json";
/// Longest plan that is read, in bytes: room for the names of several thousand files.
const MAX_PLAN: u64 = 64 << 20;

/// The steps of a commit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct CommitPlan {
    /// The name of the output folder.
    pub(super) folder: String,
    /// The inode number of the folder of new files.
    pub(super) staged: u64,
    /// The names of the new files.
    pub(super) new: Vec<String>,
    /// The names of raycost's old files, which are replaced or removed.
    pub(super) old: Vec<String>,
    /// The names of foreign files, which remain; `None` if they prevent an exchange.
    pub(super) kept: Option<Vec<String>>,
}

impl CommitPlan {
    /// Reads the plan in a workspace; `None` if it is missing, incomplete, or has a path in place
    /// of a name.
    pub(super) fn read(workspace: &Path) -> Option<Self> {
        let text = files::read(&workspace.join(PLAN), MAX_PLAN).ok()?;
        let this: Self = serde_json::from_slice(&text).ok()?;
        let is_name = |name: &String| Path::new(name).file_name() == Some(name.as_ref());
        let mut names = iter::once(&this.folder).chain(&this.old).chain(&this.new);
        names.all(is_name).then_some(this)
    }

    /// Writes the plan to a workspace, and flushes it to the disk if requested.
    pub(super) fn write(&self, workspace: &Path, sync: bool) -> io::Result<()> {
        let (path, text) = (workspace.join(PLAN), serde_json::to_vec(self)?);
        change(|| fs::write(&path, text))?;
        if sync {
            disk::sync(&path)?;
            disk::sync(workspace)?;
        }
        Ok(())
    }
}
