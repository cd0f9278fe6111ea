//! Arguments → [`cli::run`] → the one error message and the exit code.

use std::process::ExitCode;

use host::Allocator;
use host::text;
use raycost::cli;
use render::ranks;

#[global_allocator]
static ALLOCATOR: Allocator = Allocator;

fn main() -> ExitCode {
    host::configure_heap();
    match cli::run(std::env::args_os()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if let Some(message) = failure.message() {
                text::print_error(&message);
            }
            // A rank that fails, or is asked to end, ends the others.
            ranks::abort(failure.exit_code());
            ExitCode::from(failure.exit_code())
        }
    }
}
