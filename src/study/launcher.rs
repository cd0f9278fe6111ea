//! The command that starts the ranks of a run.

use serde::{Deserialize, Serialize};

use crate::yaml::{Fault, FieldPath};

/// What stands for the number of ranks.
const RANKS: &str = "{ranks}";

/// A command such as `mpirun -n {ranks}`, which starts the command behind it on so many ranks.
/// Its words are separated by blanks.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Launcher(String);

impl Launcher {
    /// Checks that it is a command with the number of ranks, and nothing else in braces.
    ///
    /// # Errors
    /// It is none.
    pub(super) fn check(&self, path: FieldPath) -> Result<(), Fault> {
        let others = self.0.replace(RANKS, "");
        if self.0.contains(RANKS) && !others.contains(['{', '}']) {
            return Ok(());
        }
        let message = "the `launcher` is no command with the number of ranks";
        let expected = "expected a command such as `mpirun -n {ranks}`";
        Err(Fault::new(path, message, expected))
    }

    /// The program that starts the ranks.
    pub fn program(&self) -> &str {
        self.0.split_whitespace().next().unwrap_or_default()
    }

    /// The words of the command for so many ranks.
    pub fn words(&self, n_ranks: u64) -> Vec<String> {
        let n_ranks = n_ranks.to_string();
        let words = self.0.split_whitespace();
        words.map(|word| word.replace(RANKS, &n_ranks)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::yaml;

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
