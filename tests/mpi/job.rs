//! A job of several ranks in a folder of its own.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use render::checkpoint::CheckpointFile;
use tempfile::TempDir;

use crate::common::{assert_success, in_repository, raycost};

/// Lets Open MPI start more ranks than processors, and as root in a container.
pub const ENVIRONMENT: [(&str, &str); 4] = [
    ("OMPI_ALLOW_RUN_AS_ROOT", "1"),
    ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
    ("OMPI_MCA_rmaps_base_oversubscribe", "1"),
    ("PRTE_MCA_rmaps_default_mapping_policy", ":oversubscribe"),
];

/// A scene of the repository and its flags, rendered by any number of ranks into folders.
pub struct Job {
    folder: TempDir,
    pub arguments: Vec<String>,
}

impl Job {
    pub fn new(scene: &str, flags: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::os::unix::fs::symlink(in_repository("configs"), folder.path().join("configs"))
            .unwrap();
        let scene = format!("configs/{scene}.yaml");
        let arguments = ["render", &scene].into_iter().chain(flags.iter().copied());
        Self {
            folder,
            arguments: arguments.map(str::to_owned).collect(),
        }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Renders by one process without MPI.
    pub fn render_alone(&self, out: &str) {
        let mut command = raycost();
        command
            .args(&self.arguments)
            .args(["--quiet", "--out", out]);
        let output = command.current_dir(self.folder.path()).output().unwrap();
        assert_success(&output);
    }

    /// A command of this number of ranks. A rank besides the first is started by `sh` with
    /// the lines `before` it.
    pub fn ranks(&self, n: usize, out: &str, more: &[&str], before: &str) -> Command {
        let program = env!("CARGO_BIN_EXE_raycost");
        let mut command = self.launch();
        let arguments = |command: &mut Command| {
            command.args(&self.arguments);
            command.args(["--threads=1", "--out", out]).args(more);
        };
        command.args(["-n", "1", program]);
        arguments(&mut command);
        if n > 1 {
            let script = format!("{before}\nexec \"$0\" \"$@\"");
            command.args([
                ":",
                "-n",
                &(n - 1).to_string(),
                "sh",
                "-c",
                &script,
                program,
            ]);
            arguments(&mut command);
        }
        command
    }

    /// `mpirun`, in the folder.
    pub fn launch(&self) -> Command {
        let mut command = Command::new("mpirun");
        command.current_dir(self.folder.path());
        command.envs(ENVIRONMENT);
        command
    }

    /// Renders by this number of ranks.
    pub fn render(&self, n: usize, out: &str, more: &[&str]) -> Output {
        let output = self.ranks(n, out, more, "").output().unwrap();
        assert_success(&output);
        output
    }

    /// Number of tiles that an interrupted run has kept.
    pub fn n_kept(&self, out: &str) -> usize {
        let file = CheckpointFile::open(&self.path(out).join("unfinished.tiles"));
        file.map_or(0, |file| file.n_tiles())
    }
}

/// Whether a folder has the files of a rendering.
pub fn is_written(folder: &Path) -> bool {
    folder.join("summary.json").exists()
}
