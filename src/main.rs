//! Arguments → [`Cli::run`] → the one error message and the exit code.

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;
use raycost::cli::Cli;

fn main() -> ExitCode {
    match Cli::parse().run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if let Some(diagnostic) = failure.diagnostic() {
                // anstream removes the colours where this is no terminal. With
                // nobody to hear the message, the exit code has to do.
                let _ = writeln!(anstream::stderr(), "{}", diagnostic.render(true));
            }
            ExitCode::from(failure.exit_code())
        }
    }
}
