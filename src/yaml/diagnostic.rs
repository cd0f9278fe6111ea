//! One mistake, told to the person who wrote the YAML.

use std::fmt;
use std::ops::Range;

use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use super::position::Path;
use super::source::Source;
use super::syntax::line_start;
use crate::terminal::{one_line, visible};

/// Most characters that are shown of a message, and of what stands beside the
/// caret: a value may be as long as its author likes.
const MAX_MESSAGE: usize = 200;
/// Most characters that are underlined.
const MAX_UNDERLINED: usize = 60;

/// A mistake in a scene, before it is put beside the text.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Where it stands.
    pub spot: Spot,
    /// What is wrong, one line.
    pub message: String,
    /// What would be right, put beside the caret.
    pub expected: String,
    /// What to do, when there is more to say.
    pub help: Option<String>,
}

/// Where a mistake stands.
#[derive(Debug, Clone, PartialEq)]
pub enum Spot {
    /// The value at a path.
    Value(Path),
    /// The key at the end of a path.
    Key(Path),
    /// These bytes of the text.
    Bytes(Range<usize>),
}

impl Fault {
    /// A fault of the value at `path`.
    pub fn new(path: Path, message: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::at(Spot::Value(path), message, expected)
    }

    /// A fault of the key at the end of `path`.
    pub fn of_key(path: Path, message: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::at(Spot::Key(path), message, expected)
    }

    /// A fault of these bytes of the text.
    pub fn of_bytes(
        bytes: Range<usize>,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::at(Spot::Bytes(bytes), message, expected)
    }

    fn at(spot: Spot, message: impl Into<String>, expected: impl Into<String>) -> Self {
        Self {
            spot,
            message: message.into(),
            expected: expected.into(),
            help: None,
        }
    }

    /// The same, with a hint what to do.
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// A message for the user: what is wrong, where, and what to do.
#[derive(Debug, Clone)]
pub struct Diagnostic {
    message: String,
    place: Option<Place>,
    note: Option<String>,
    help: Option<String>,
}

/// Where a diagnostic points.
#[derive(Debug, Clone)]
struct Place {
    file: String,
    /// The line (1 is the first), and its text.
    line: usize,
    text: String,
    /// Bytes of `text` under the caret.
    span: Range<usize>,
    label: String,
}

impl Diagnostic {
    /// A diagnostic without a place in a text.
    pub fn new(message: impl Into<String>) -> Self {
        Self {
            message: one_line(&message.into()).into_owned(),
            place: None,
            note: None,
            help: None,
        }
    }

    /// The fault of something that stands in no text: on the command line.
    pub fn without_place(fault: Fault) -> Self {
        Self {
            help: fault.help.map(|help| one_line(&help).into_owned()),
            ..Self::new(fault.message)
        }
    }

    /// The same, with a hint what to do.
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(one_line(&help.into()).into_owned());
        self
    }

    /// The same, with what another program said, which may be several lines.
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.note = Some(visible(note.into().trim_end()).into_owned());
        self
    }

    /// The fault beside the line that holds byte `span.start` of the source.
    pub(super) fn of_fault(source: &Source, span: Range<usize>, fault: Fault) -> Self {
        let text = source.text();
        let start = span.start.min(text.len());
        let line_start = line_start(text, start);
        let line_text = text[line_start..].lines().next().unwrap_or_default();
        let begin = (start - line_start).min(line_text.len());
        let end = span.end.saturating_sub(line_start).min(line_text.len());
        let marked = line_text.get(begin..end).unwrap_or_default();
        let shown = marked.char_indices().nth(MAX_UNDERLINED);
        let n_shown = shown.map_or(marked.len(), |(byte, _)| byte);
        Self {
            message: cut(&fault.message),
            place: Some(Place {
                file: one_line(source.name()).into_owned(),
                line: 1 + text[..line_start].matches('\n').count(),
                text: line_text.to_owned(),
                span: begin..begin + n_shown,
                label: cut(&fault.expected),
            }),
            note: None,
            help: fault.help.map(|help| cut(&help)),
        }
    }

    /// The message as it goes to a terminal; `styled` adds colours.
    pub fn render(&self, styled: bool) -> String {
        let mut group =
            Level::ERROR
                .primary_title(self.message.as_str())
                .elements(self.place.as_ref().map(|place| {
                    Snippet::source(place.text.as_str())
                        .line_start(place.line)
                        .path(place.file.as_str())
                        .annotation(
                            AnnotationKind::Primary
                                .span(place.span.clone())
                                .label(place.label.as_str()),
                        )
                }));
        if let Some(note) = &self.note {
            group = group.element(Level::NOTE.message(note.as_str()));
        }
        if let Some(help) = &self.help {
            group = group.element(Level::HELP.message(help.as_str()));
        }
        let renderer = if styled {
            Renderer::styled()
        } else {
            Renderer::plain()
        };
        renderer.decor_style(DecorStyle::Ascii).render(&[group])
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for Diagnostic {}

/// The text on one line, cut to [`MAX_MESSAGE`] characters.
fn cut(text: &str) -> String {
    match text.char_indices().nth(MAX_MESSAGE) {
        None => one_line(text).into_owned(),
        Some((end, _)) => one_line(&text[..end]).into_owned() + "…",
    }
}
