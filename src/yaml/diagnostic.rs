//! One mistake, told to the person who wrote the YAML.

use std::fmt;
use std::ops::Range;

use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use super::position::Path;
use super::source::Source;

/// A mistake in a scene, before it is put beside the text.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Where it stands, as a path of keys and indices.
    pub path: Path,
    /// Where it stands, as bytes of the text; found from the path if `None`.
    pub span: Option<Range<usize>>,
    /// Point at the key itself, not at its value.
    pub at_key: bool,
    /// What is wrong, one line.
    pub message: String,
    /// What would be right, put beside the caret.
    pub expected: String,
    /// What to do, when there is more to say.
    pub help: Option<String>,
}

impl Fault {
    /// A fault of the value at `path`.
    pub fn new(path: Path, message: impl Into<String>, expected: impl Into<String>) -> Self {
        Self {
            path,
            span: None,
            at_key: false,
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

    /// The same, pointing at the key instead of its value.
    pub fn at_key(mut self) -> Self {
        self.at_key = true;
        self
    }
}

/// A message for the user: what is wrong, where, and what to do.
#[derive(Debug, Clone)]
pub struct Diagnostic {
    message: String,
    place: Option<Place>,
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
            message: message.into(),
            place: None,
            help: None,
        }
    }

    /// The same, with a hint what to do.
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// The fault beside the line that holds byte `span.start` of the source.
    pub(super) fn at(source: &Source, span: Range<usize>, fault: Fault) -> Self {
        let text = source.text();
        let start = span.start.min(text.len());
        let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
        let line_text = text[line_start..].lines().next().unwrap_or_default();
        let begin = (start - line_start).min(line_text.len());
        let end = span.end.saturating_sub(line_start).min(line_text.len());
        Self {
            message: fault.message,
            place: Some(Place {
                file: source.name().to_owned(),
                line: 1 + text[..line_start].matches('\n').count(),
                text: line_text.to_owned(),
                span: begin..end.max(begin),
                label: fault.expected,
            }),
            help: fault.help,
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

/// "did you mean `x`?" for the known word nearest to `word`, if one is near.
pub fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    known
        .into_iter()
        .map(|candidate| (strsim::jaro_winkler(word, candidate), candidate))
        .filter(|&(similarity, _)| similarity > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| format!("did you mean `{candidate}`?"))
}
