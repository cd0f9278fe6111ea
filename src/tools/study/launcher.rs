//! The command that starts the ranks of a run.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use scene::yaml::{Fault, FieldPath};

/// The placeholder for the number of ranks.
const RANKS: &str = "{ranks}";

/// The programs that start ranks, by their names in `PATH`.
const STARTERS: [&str; 3] = ["mpirun", "mpiexec", "srun"];

/// Their options with a value that can neither name a program nor change which program is started.
const WITH_VALUE: [&str; 13] = [
    "-n",
    "-np",
    "--np",
    "--ntasks",
    "-N",
    "--nodes",
    "--ntasks-per-node",
    "-c",
    "--cpus-per-task",
    "--mpi",
    "--bind-to",
    "--map-by",
    "--cpu-bind",
];

/// Their harmless options without a value.
const WITHOUT_VALUE: [&str; 4] = [
    "--oversubscribe",
    "--use-hwthread-cpus",
    "--allow-run-as-root",
    "--exclusive",
];

/// A command such as `mpirun -n {ranks}`, which starts the command after it on this number of
/// ranks. Its words are separated by blanks.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Launcher(String);

impl Launcher {
    /// Checks that the command contains `{ranks}`, and nothing else in braces.
    ///
    /// # Errors
    /// If it does not.
    pub(super) fn check(&self, path: FieldPath) -> Result<(), Fault> {
        let others = self.0.replace(RANKS, "");
        if self.0.contains(RANKS) && !others.contains(['{', '}']) {
            return Ok(());
        }
        let message = "`launcher` must contain `{ranks}` and no other braces";
        let expected = "expected a command such as `mpirun -n {ranks}`";
        Err(Fault::new(path, message, expected))
    }

    /// Returns the first word by which the command may start another program than this one on
    /// ranks: a word that is neither the plain name of a known starter nor one of its harmless
    /// options. Even `mpirun` starts any program among its words.
    pub fn suspect(&self) -> Option<&str> {
        let mut words = self.0.split_whitespace();
        if let Some(program) = words.next().filter(|program| !STARTERS.contains(program)) {
            return Some(program);
        }
        while let Some(word) = words.next() {
            match word.split_once('=') {
                Some((option, _)) if WITH_VALUE.contains(&option) => {}
                None if WITH_VALUE.contains(&word) => drop(words.next()),
                None if WITHOUT_VALUE.contains(&word) => {}
                _ => return Some(word),
            }
        }
        None
    }

    /// Returns the command as the study states it.
    pub fn command(&self) -> &str {
        &self.0
    }

    /// Returns the program that starts the ranks.
    pub fn program(&self) -> &str {
        self.0.split_whitespace().next().unwrap_or_default()
    }

    /// Returns the words of the command for `n_ranks` ranks.
    pub fn words(&self, n_ranks: u64) -> Vec<String> {
        let n_ranks = n_ranks.to_string();
        let words = self.0.split_whitespace();
        words.map(|word| word.replace(RANKS, &n_ranks)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::yaml;

    #[test]
    fn only_ranks_of_this_program_are_above_suspicion() {
        for (command, suspect) in [
            ("mpirun -n {ranks}", None),
            ("mpiexec --oversubscribe -np {ranks} --bind-to core", None),
            ("srun --ntasks={ranks} --ntasks-per-node=1 --mpi=pmix", None),
            ("curl {ranks}", Some("curl")),
            ("./mpirun -n {ranks}", Some("./mpirun")),
            ("/usr/bin/mpirun -n {ranks}", Some("/usr/bin/mpirun")),
            ("mpirun -n {ranks} sh -c", Some("sh")),
            ("mpirun -n {ranks} -x LD_PRELOAD=./a.so", Some("-x")),
            ("mpirun -n {ranks} --mca plm_rsh_agent ./a", Some("--mca")),
            (
                "srun -n {ranks} --task-prolog=./a",
                Some("--task-prolog=./a"),
            ),
            (
                "mpirun --oversubscribe=1 {ranks}",
                Some("--oversubscribe=1"),
            ),
            ("MPIRUN -n {ranks}", Some("MPIRUN")),
        ] {
            assert_eq!(Launcher(command.to_owned()).suspect(), suspect, "{command}");
        }
    }

    #[test]
    fn every_place_of_the_ranks_is_filled_in() {
        let launcher: Launcher =
            yaml::from_str("srun  --ntasks={ranks} --nodes={ranks} -q").unwrap();
        assert_eq!(launcher.program(), "srun");
        let words = launcher.words(16);
        assert_eq!(words, ["srun", "--ntasks=16", "--nodes=16", "-q"]);
        let check = |text: &str| Launcher(text.to_owned()).check(FieldPath::default());
        assert!(check("mpirun -n {ranks}").is_ok());
        for wrong in ["mpirun", "", "mpirun -n {n}", "mpirun -n {ranks} {hosts}"] {
            assert!(check(wrong).is_err(), "{wrong}");
        }
    }
}
