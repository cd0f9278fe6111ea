//! Arguments → [`Cli::run`] → the one error message and the exit code.

use std::process::ExitCode;

use clap::Parser;
use raycost::cli::Cli;

fn main() -> ExitCode {
    match Cli::parse().run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if let Some(diagnostic) = failure.diagnostic() {
                // Removes the colours where standard error is no terminal.
                anstream::eprintln!("{}\n", diagnostic.render(true));
            }
            ExitCode::from(failure.exit_code())
        }
    }
}
