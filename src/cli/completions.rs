//! `raycost completions`.

use clap::CommandFactory;
use clap_complete::Shell;

use super::{Cli, Failure};
use host::text;

/// Print a completion script for a shell
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  raycost completions bash > ~/.local/share/bash-completion/completions/raycost"
)]
pub(super) struct CompletionsArguments {
    /// The shell
    shell: Shell,
}

pub(super) fn run(arguments: &CompletionsArguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    let mut command = Cli::command();
    clap_complete::generate(arguments.shell, &mut command, "raycost", &mut script);
    Ok(text::print(&String::from_utf8_lossy(&script))?)
}
