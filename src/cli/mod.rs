//! The command line: one file a subcommand.

mod charges;
mod check;
mod completions;
mod diff;
mod failure;
mod hottest;
mod progress;
mod rectangle;
mod render;
mod run_summary;
mod scene;
mod studies;
mod study;
mod tables;
mod timing_quality;
mod trace;
mod tree;
mod view;

use std::ffi::OsString;
use std::path::Path;

use clap::{Parser, Subcommand};

pub use failure::Failure;

use crate::stop;
use crate::text::numbers::shell_word;
use crate::text::{self, Diagnostic, one_line};

/// A ray tracer that shows its work
///
/// Reads a scene from a YAML file; writes its picture, a map of what each
/// pixel cost, and VTK files with ParaView states to look at both.
#[derive(Debug, Parser)]
#[command(version, propagate_version = true, subcommand_required = true)]
#[command(after_help = "Start with:\n  raycost render configs/seed_sphere.yaml")]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render a scene and write its files
    Render(render::Arguments),
    /// Say what rendering a scene would do, and render nothing; or verify an output folder
    Check(check::Arguments),
    /// Write a page that shows an output folder in a browser
    View(view::Arguments),
    /// Compare the costs of two outputs
    Diff(diff::Arguments),
    /// Show all rays of some pixels and what each costs
    Trace(trace::Arguments),
    /// Measure how the cost of scenes depends on what you vary
    Study(study::Arguments),
    /// Print a completion script for a shell
    Completions(completions::Arguments),
}

/// Does what the arguments of the command line say; the first one is the
/// program's name.
///
/// # Errors
/// The one message and the exit code to end with.
pub fn run(arguments: impl Iterator<Item = OsString>) -> Result<(), Failure> {
    let arguments: Vec<OsString> = arguments.collect();
    match Cli::try_parse_from(&arguments) {
        Ok(cli) => cli.run(),
        Err(usage) if usage.use_stderr() => Err(Failure::Usage(text_of(&usage, &arguments))),
        Err(help) => Ok(text::print_styled(&text_of(&help, &arguments))?),
    }
}

/// clap's text with its styles. It repeats arguments as they are: an error of
/// those that hold what cannot be seen is that of the same arguments as text.
fn text_of(found: &clap::Error, arguments: &[OsString]) -> String {
    let visible = arguments
        .iter()
        .map(|argument| one_line(&argument.to_string_lossy()).into_owned());
    let again = Cli::try_parse_from(visible).err();
    let text = again.as_ref().unwrap_or(found).render();
    text.ansi().to_string().trim_end().to_owned() + "\n"
}

impl Cli {
    fn run(self) -> Result<(), Failure> {
        stop::listen().map_err(|error| {
            Failure::Machine(Diagnostic::new(format!(
                "cannot listen for signals: {error}"
            )))
        })?;
        match (self.run_command(), stop::check()) {
            // Whatever failed, failed since it had to end.
            (Err(_), Err(stopped)) => Err(stopped.into()),
            (ended, _) => ended,
        }
    }

    fn run_command(self) -> Result<(), Failure> {
        match self.command {
            Command::Render(arguments) => render::run(&arguments),
            Command::Check(arguments) => on_threads(|| check::run(&arguments)),
            Command::View(arguments) => on_threads(|| view::run(&arguments)),
            Command::Diff(arguments) => on_threads(|| diff::run(&arguments)),
            Command::Trace(arguments) => trace::run(&arguments),
            Command::Study(arguments) => study::run(&arguments),
            Command::Completions(arguments) => completions::run(&arguments),
        }
    }
}

impl Cli {
    /// Finds what is wrong with the scene of a `check`, and prints nothing.
    fn check_alone(&self) -> Result<(), Diagnostic> {
        match &self.command {
            Command::Check(arguments) => arguments.check_alone(),
            _ => Ok(()),
        }
    }
}

/// Does work on threads of its own: rayon's would panic where the system
/// refuses them.
fn on_threads(work: impl FnOnce() -> Result<(), Failure> + Send) -> Result<(), Failure> {
    render::thread_pool(None)?.install(work)
}

/// The path as it is shown on a terminal.
fn shown(path: &Path) -> String {
    one_line(&path.to_string_lossy()).into_owned()
}
