//! `raycost states`.

use std::path::PathBuf;

use super::{Failure, refuse_file, shown};
use base::numbers::counted;
use host::text::{self, Diagnostic};
use output::results::relocate_states;
use tools::series::FRAMES;

/// Write the paths in ParaView states anew, after a folder has moved
///
/// ParaView's states name their files by absolute paths: in a folder that was moved or copied,
/// views are empty. This names the files that lie beside each state now.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  raycost states out/seed_extended")]
pub(super) struct StatesArguments {
    /// Folders that `raycost render`, `trace` or `diff` wrote
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
}

pub(super) fn run(arguments: &StatesArguments) -> Result<(), Failure> {
    for folder in &arguments.folders {
        refuse_file(folder)?;
        if !folder.is_dir() {
            let message = format!("`{}` does not exist", shown(folder));
            let help = "name a folder that `raycost render` wrote";
            return Err(Diagnostic::new(message).with_help(help).into());
        }
        // A link may lead to a folder of another run.
        let is_own = |path: &PathBuf| path.is_dir() && !path.is_symlink();
        let frames = Some(folder.join(FRAMES)).filter(is_own);
        let frames = frames.into_iter().flat_map(|frames| frames.read_dir());
        let frames = frames.flatten().flatten().map(|entry| entry.path());
        let frames = frames.filter(is_own);
        let mut n_written = 0;
        for place in [folder.clone()].into_iter().chain(frames) {
            n_written += relocate_states(&place)?;
        }
        let text = match n_written {
            0 => format!("states  {} needs none anew\n", shown(folder)),
            n => format!("wrote   {} in {}\n", counted(n, "state"), shown(folder)),
        };
        text::print(&text)?;
    }
    Ok(())
}
