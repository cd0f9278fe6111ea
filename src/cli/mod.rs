//! The command line: one file a subcommand.

mod charges;
mod check;
mod closing;
mod completions;
mod diff;
mod failure;
mod hottest;
mod progress;
mod rectangle;
mod render;
mod scene;
mod studies;
mod study;
mod tables;
mod trace;
mod tree;
mod trust;
mod view;

use clap::{Parser, Subcommand};

pub use failure::Failure;

use crate::output::format::shell_word;

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
    /// Tell what rendering a scene would do, and render nothing
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

impl Cli {
    /// Does what the arguments say.
    ///
    /// # Errors
    /// The one message and the exit code to end with.
    pub fn run(self) -> Result<(), Failure> {
        match self.command {
            Command::Render(arguments) => render::run(&arguments),
            Command::Check(arguments) => check::run(&arguments),
            Command::View(arguments) => view::run(&arguments),
            Command::Diff(arguments) => diff::run(&arguments),
            Command::Trace(arguments) => trace::run(&arguments),
            Command::Study(arguments) => study::run(&arguments),
            Command::Completions(arguments) => completions::run(&arguments),
        }
    }
}

impl Cli {
    /// Finds what is wrong with the scene of a `check`, and prints nothing.
    fn check_alone(&self) -> Result<(), crate::yaml::Diagnostic> {
        match &self.command {
            Command::Check(arguments) => arguments.check_alone(),
            _ => Ok(()),
        }
    }
}
