//! The failure of a command: its message and its exit code.

use crate::session::RenderError;
use base::stop::Stopped;
use host::folder::WriteError;
use host::text::Diagnostic;

/// Reasons why a command failed.
#[derive(Debug)]
pub enum Failure {
    /// The user's input is wrong: exit code 2.
    Input(Diagnostic),
    /// The output is incomplete, as a message on standard output says: exit code 4.
    Partial,
    /// More work than the gate of `diff` or a budget allows: exit code 3.
    Gate(Diagnostic),
    /// The system refused, for example to write a file: exit code 1.
    Machine(Diagnostic),
    /// The command line is wrong; clap's message with its styles: exit code 2.
    Usage(String),
    /// Several inputs failed: the greatest exit code.
    Several(Vec<Failure>),
    /// A signal stopped the program: exit code 128 plus its number. The message says what was kept,
    /// if another run can continue.
    Stopped(Stopped, Option<Diagnostic>),
    /// The reader of the output has closed its pipe, as `| head` does: exit code 0,
    /// without a message.
    ClosedOutput,
}

impl From<Diagnostic> for Failure {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::Input(diagnostic)
    }
}

impl From<Stopped> for Failure {
    fn from(stopped: Stopped) -> Self {
        Self::Stopped(stopped, None)
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Scene(diagnostic) => Self::Input(diagnostic),
            RenderError::Machine(diagnostic) => Self::Machine(diagnostic),
            RenderError::Stopped(stopped, _) => stopped.into(),
            RenderError::Observer(error) => error.into(),
        }
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        RenderError::from(error).into()
    }
}

/// Converts the error of writing to the terminal.
impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::BrokenPipe => Self::ClosedOutput,
            _ => Self::Machine(Diagnostic::new(format!(
                "cannot write to the terminal: {error}"
            ))),
        }
    }
}

impl Failure {
    /// Returns the failure of a command that failed after a signal, and because of it.
    pub(super) fn because_of(self, stopped: Stopped) -> Self {
        match self {
            Self::Stopped(_, kept) => Self::Stopped(stopped, kept),
            _ => stopped.into(),
        }
    }

    /// Returns the process's exit code.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Partial => 4,
            Self::Gate(_) => 3,
            Self::Input(_) | Self::Usage(_) => 2,
            Self::Machine(_) => 1,
            Self::Several(all) => all.iter().map(Self::exit_code).max().unwrap_or(1),
            Self::Stopped(stopped, _) => stopped.exit_code(),
            Self::ClosedOutput => 0,
        }
    }

    /// Returns the message without styles, and without the word `error`, as part of another one;
    /// `None` if nothing is printed.
    pub(super) fn text(&self) -> Option<String> {
        let text = anstream::adapter::strip_str(&self.message()?).to_string();
        let text = text.strip_prefix("error: ").unwrap_or(&text);
        Some(text.to_owned())
    }

    /// Returns the message with its styles; `None` if nothing is printed.
    pub fn message(&self) -> Option<String> {
        match self {
            Self::Input(diagnostic) | Self::Gate(diagnostic) | Self::Machine(diagnostic) => {
                Some(diagnostic.render(true))
            }
            Self::Several(all) => {
                let messages: Vec<String> = all.iter().filter_map(Self::message).collect();
                Some(messages.join("\n"))
            }
            Self::Usage(text) => Some(text.trim_end().to_owned()),
            Self::Stopped(_, kept) => kept.as_ref().map(|kept| kept.render(true)),
            Self::ClosedOutput | Self::Partial => None,
        }
    }
}
