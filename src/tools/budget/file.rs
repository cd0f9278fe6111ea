//! The file of a budget, `budget.json`.

use std::io::Write;
use std::path::Path;

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use host::folder::{Replace, WriteError, Written, write_file};
use host::provenance::{Checksum, Hasher, RunId};
use host::text::{Diagnostic, shell_word, shown};
use output::summary::{ImageSection, MAX_BYTES, read_value};
use render::attribution::Work;

/// The usual name of the file.
pub const FILE: &str = "budget.json";

/// Version of the format; files of other versions are refused.
const FORMAT: u32 = 1;

/// The totals of some scenes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CostBudget {
    raycost_budget: u32,
    /// A hash of the scenes, so that a change of the file is noticed.
    raycost_run: RunId,
    /// The scenes in the order of the command line.
    pub scenes: Vec<SceneBudget>,
}

/// The totals of a scene, and all that is needed to measure them again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneBudget {
    /// The scene file as the user typed it, relative to the folder of the command.
    pub scene: String,
    /// The flags that changed the scene, such as `--width=100`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub flags: Vec<String>,
    /// The frame of an animated scene, if not the first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<u32>,
    /// Size and sampling of the picture.
    pub image: ImageSection,
    /// A hash of the config and of the files that it names, without the settings that change only
    /// the work, not the picture.
    pub config: Checksum,
    /// The totals of the whole picture, as in `summary.json`.
    pub totals: IndexMap<String, u64>,
    /// The totals of each object by the kinds of rays: a ray counts for the object that the camera
    /// ray of its path hits.
    pub objects: IndexMap<String, IndexMap<String, RayTotals>>,
}

/// The totals of some rays.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RayTotals {
    /// Number of rays.
    pub rays: u64,
    /// BVH nodes visited.
    pub node_visits: u64,
    /// Primitive tests.
    pub primitive_tests: u64,
}

/// The version of a file, whatever else is in it.
#[derive(Deserialize)]
struct BudgetVersion {
    raycost_budget: u32,
}

impl CostBudget {
    /// Creates the budget of some scenes.
    pub fn new(scenes: Vec<SceneBudget>) -> Self {
        Self {
            raycost_budget: FORMAT,
            raycost_run: hash(&scenes),
            scenes,
        }
    }

    /// Reads a budget.
    ///
    /// # Errors
    /// The file cannot be read, is not a budget of this version, or was changed.
    pub fn read(path: &Path) -> Result<Self, Diagnostic> {
        let help = "write one: `raycost budget SCENE`";
        let refused = |why: String| {
            let update = format!(
                "measure it anew: `raycost budget SCENE --out {}`",
                shell_word(path)
            );
            Err(Diagnostic::new(why).with_help(update))
        };
        let name = shown(path);
        let BudgetVersion { raycost_budget } = read_value(path, MAX_BYTES, "a budget", help)?;
        if raycost_budget != FORMAT {
            return refused(format!(
                "`{name}` has version {raycost_budget} of budgets, this raycost has {FORMAT}"
            ));
        }
        let budget: Self = read_value(path, MAX_BYTES, "a budget", help)?;
        if budget.raycost_run != hash(&budget.scenes) {
            return refused(format!("`{name}` was changed after raycost wrote it"));
        }
        Ok(budget)
    }

    /// Refuses a file that is not a budget, whatever its version.
    ///
    /// # Errors
    /// The path holds another file.
    pub fn refuse_other_file(path: &Path) -> Result<(), Diagnostic> {
        if path.is_file() {
            let help = "choose another file with `--out`";
            let _: BudgetVersion = read_value(path, MAX_BYTES, "a budget", help)?;
        }
        Ok(())
    }

    /// Writes the budget to a file, which may hold a file that raycost wrote.
    ///
    /// # Errors
    /// The file cannot be written, or holds something else.
    pub fn write(&self, path: &Path) -> Result<Written, WriteError> {
        write_file(path, Replace::Marked, |out| {
            serde_json::to_writer_pretty(&mut *out, self)?;
            out.write_all(b"\n")
        })
    }
}

fn hash(scenes: &[SceneBudget]) -> RunId {
    let mut hasher = Hasher::default();
    hasher.add_value(&scenes);
    hasher.checksum().into()
}

impl RayTotals {
    /// Adds the totals of more rays.
    pub fn add(&mut self, other: Self) {
        // A file may have any numbers.
        self.rays = self.rays.saturating_add(other.rays);
        self.node_visits = self.node_visits.saturating_add(other.node_visits);
        self.primitive_tests = self.primitive_tests.saturating_add(other.primitive_tests);
    }
}

impl From<Work> for RayTotals {
    fn from(work: Work) -> Self {
        Self {
            rays: work.rays,
            node_visits: work.node_visits,
            primitive_tests: work.primitive_tests,
        }
    }
}
