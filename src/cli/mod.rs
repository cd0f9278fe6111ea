//! The command line: one file per subcommand, and one row in the list of commands.

mod budget;
mod charges;
mod check;
mod completions;
mod device;
mod diff;
mod failure;
mod hints;
mod hottest;
mod json;
mod lanes;
mod merge;
mod new;
mod progress;
mod rectangle;
mod render;
mod run_summary;
mod scene;
mod schema;
mod states;
mod study;
mod timing_quality;
mod trace;
mod verify_output;
mod version;
mod view;

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Parser, Subcommand};

pub use failure::Failure;

use crate::session;
use base::Keyword;
use base::numbers::bytes;
use base::stop::{self, Cancellation};
use host::folder::Written;
use host::signals;
use host::text::{self, Diagnostic, one_line, shell_word, shortened, shown};

/// A ray tracer that shows its work
///
/// Reads a scene from a YAML file; writes its picture, a map of the cost of each pixel,
/// and VTK files with ParaView states that show both.
#[derive(Debug, Parser)]
#[command(version, long_version = version::LONG.as_str())]
#[command(propagate_version = true, subcommand_required = true)]
#[command(after_help = "Start with:\n  raycost new scene.yaml\n  raycost render scene.yaml")]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

/// Defines [`Command`] and its dispatch from one list. A row has the subcommand and the type of its
/// arguments in its file, whose `run` takes them.
macro_rules! commands {
    ($($(#[$doc:meta])* $command:ident($file:ident::$arguments:ident),)*) => {
        #[derive(Debug, Subcommand)]
        enum Command {
            $($(#[$doc])* $command($file::$arguments),)*
        }

        impl Command {
            fn run(&self) -> Result<(), Failure> {
                match self {
                    $(Self::$command(arguments) => $file::run(arguments),)*
                }
            }
        }
    };
}

commands! {
    /// Render a scene and write its files
    Render(render::RenderArguments),
    /// Merge the parts of a picture that `raycost render --part` wrote
    Merge(merge::MergeArguments),
    /// Check a scene without rendering it, or verify an output folder
    Check(check::CheckArguments),
    /// Write a page that shows an output folder in a browser
    View(view::ViewArguments),
    /// Compare the costs of two outputs, or an output with the file of another program
    Diff(diff::DiffArguments),
    /// Keep the exact totals of scenes, and check later that no counter grew
    Budget(budget::BudgetArguments),
    /// Show all rays of some pixels and the cost of each
    Trace(trace::TraceArguments),
    /// Measure how the cost of scenes depends on the factors that you vary
    Study(study::StudyArguments),
    /// Write the paths in ParaView states anew, after a folder has moved
    States(states::StatesArguments),
    /// Write a scene file to begin with
    New(new::NewArguments),
    /// Print the JSON Schema of scene files or of studies
    Schema(schema::SchemaArguments),
    /// Print a completion script for a shell
    Completions(completions::CompletionsArguments),
}

/// Parses the command line and runs its subcommand; the first argument is the program's name.
///
/// # Errors
/// The message to print and the exit code.
pub fn run(arguments: impl Iterator<Item = OsString>) -> Result<(), Failure> {
    let arguments: Vec<OsString> = arguments.collect();
    let cli = match Cli::try_parse_from(&arguments) {
        Ok(cli) => cli,
        Err(usage) if usage.use_stderr() => {
            let file = file_as_command(&usage, &arguments);
            let text = || Failure::Usage(text_of(&usage, &arguments));
            let failure = file.map_or_else(text, Failure::Input);
            render::fail_on_a_rank(&failure);
            return Err(failure);
        }
        Err(help) => return Ok(text::print_styled(&text_of(&help, &arguments))?),
    };
    signals::listen().map_err(|error| {
        let message = format!("cannot listen for signals: {error}");
        Failure::Machine(Diagnostic::new(message))
    })?;
    match (cli.command.run(), stop::check()) {
        // A command that fails after a signal fails because of the signal.
        (Err(failure), Err(stopped)) => Err(failure.because_of(stopped)),
        (ended, _) => ended,
    }
}

/// Maximum number of words of a file name with spaces that a message recognizes.
const MAX_WORDS: usize = 16;

/// Returns the failure of a command line that has a file in the place of the command, or a name
/// with spaces without quotes.
fn file_as_command(usage: &clap::Error, arguments: &[OsString]) -> Option<Diagnostic> {
    match usage.kind() {
        ErrorKind::InvalidSubcommand => {
            let file = Path::new(arguments.get(1)?);
            if !is_scene(file) {
                return None;
            }
            let message = format!("`{}` is not a command", shown(file));
            let help = format!("to render it: `raycost render {}`", shell_word(file));
            Some(Diagnostic::new(message).with_help(help))
        }
        ErrorKind::UnknownArgument => {
            let joined = (2..arguments.len()).flat_map(|end| {
                (end.saturating_sub(MAX_WORDS - 1).max(1)..end)
                    .map(move |start| arguments[start..=end].join(OsStr::new(" ")))
            });
            let Some(file) = joined.map(PathBuf::from).find(|file| file.is_file()) else {
                return second_scene(usage, arguments);
            };
            let message = format!("`{}` has a space in its name", shown(&file));
            let help = format!("put it in quotes: {}", shell_word(&file));
            Some(Diagnostic::new(message).with_help(help))
        }
        _ => None,
    }
}

/// Returns the failure of a command for one scene that has two.
fn second_scene(usage: &clap::Error, arguments: &[OsString]) -> Option<Diagnostic> {
    let Some(ContextValue::String(second)) = usage.get(ContextKind::InvalidArg) else {
        return None;
    };
    let file = Path::new(second);
    let command = one_line(&arguments.get(1)?.to_string_lossy()).into_owned();
    if !file.is_file() || command.starts_with('-') {
        return None;
    }
    let message = format!(
        "`raycost {command}` takes one file, and `{}` is a second",
        shown(file)
    );
    let help = format!(
        "run it once for each: `raycost {command} {}`",
        shell_word(file)
    );
    Some(Diagnostic::new(message).with_help(help))
}

/// Checks that the argument of a command that reads an output is not a file.
///
/// # Errors
/// It is a file.
fn refuse_file(folder: &Path) -> Result<(), Diagnostic> {
    if !folder.is_file() {
        return Ok(());
    }
    let message = format!("`{}` is a file, not the folder of an output", shown(folder));
    let help = if is_scene(folder) {
        let scene = shell_word(folder);
        format!("render it, `raycost render {scene}`, and name the folder that it writes")
    } else {
        "name a folder that `raycost render` wrote".to_owned()
    };
    Err(Diagnostic::new(message).with_help(help))
}

/// Returns true if the name is that of a scene: of YAML, or of a mesh.
fn is_scene(file: &Path) -> bool {
    let extension = file.extension().unwrap_or_default();
    import::is_geometry(file) || extension == "yaml" || extension == "yml"
}

/// Maximum number of characters of an argument in a message.
const MAX_ARGUMENT: usize = 240;

/// Returns clap's text with its styles. clap repeats arguments verbatim, so long arguments are parsed
/// again shortened, and control characters made visible.
fn text_of(found: &clap::Error, arguments: &[OsString]) -> String {
    let visible = arguments.iter().map(|argument| {
        let argument = shortened(argument.to_string_lossy().into_owned(), MAX_ARGUMENT);
        one_line(&argument).into_owned()
    });
    let again = Cli::try_parse_from(visible).err();
    let text = again.as_ref().unwrap_or(found).render();
    text.ansi().to_string().trim_end().to_owned() + "\n"
}

impl Cli {
    /// Checks the scene of a `check` without printing a report. Returns the files that determine
    /// its picture. Other subcommands have none.
    fn checked_files(&self) -> Result<Vec<PathBuf>, Diagnostic> {
        match &self.command {
            Command::Check(arguments) => arguments.checked_files(),
            _ => Ok(Vec::new()),
        }
    }
}

/// Returns the name and the length of each file.
fn names_and_lengths<'a>(written: impl IntoIterator<Item = &'a Written>) -> Vec<String> {
    let one = |file: &Written| format!("{} ({})", file.file, bytes(file.bytes));
    written.into_iter().map(one).collect()
}

/// Returns the parser of a keyword on the command line.
fn keyword<T: Keyword + Send + Sync>() -> impl TypedValueParser<Value = T> {
    let value = |keyword: &T| PossibleValue::new(keyword.name()).help(keyword.help());
    let parser = PossibleValuesParser::new(T::KEYWORDS.iter().map(value));
    parser.map(|name| T::from_name(&name).expect("one of the possible values"))
}

/// Runs `work` on a new thread pool: rayon's global pool would panic if the system refused its
/// threads.
fn on_threads(work: impl FnOnce() -> Result<(), Failure> + Send) -> Result<(), Failure> {
    thread_pool(None)?.install(work)
}

/// Starts threads; `None` for one per processor.
fn thread_pool(n_threads: Option<u16>) -> Result<rayon::ThreadPool, Failure> {
    session::thread_pool(n_threads, &Cancellation::default()).map_err(Failure::Machine)
}
