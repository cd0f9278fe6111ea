//! Error messages that point at a line of text.

use std::fmt;
use std::ops::Range;

use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use super::terminal::{one_line, visible};

/// Maximum number of characters of a message with an excerpt: a value in it may have any length.
const MAX_MESSAGE: usize = 240;
/// Maximum number of characters of any other text, which may have two paths.
const MAX_TEXT: usize = 1000;
/// Maximum number of characters of the label beside the caret and of the remedy, which may list all
/// choices.
const MAX_LIST: usize = 480;
/// Maximum number of characters of the output of another program.
const MAX_NOTE: usize = 10_000;
/// Maximum number of underlined characters.
const MAX_UNDERLINED: usize = 60;

/// An error message for the user: what is wrong, where, and how to correct it.
#[derive(Clone)]
pub struct Diagnostic {
    message: String,
    excerpt: Option<Excerpt>,
    note: Option<String>,
    help: Option<String>,
    /// Other mistakes, shown below this one.
    others: Vec<Diagnostic>,
}

/// The line that a diagnostic points at.
#[derive(Debug, Clone)]
struct Excerpt {
    file: String,
    /// The line's number, counted from 1, and its text.
    line: usize,
    text: String,
    /// The bytes of `text` that are underlined.
    span: Range<usize>,
    label: String,
}

impl Diagnostic {
    /// Creates a diagnostic without an excerpt.
    pub fn new(message: impl Into<String>) -> Self {
        Self {
            message: one_line(&shortened(message.into(), MAX_TEXT)).into_owned(),
            excerpt: None,
            note: None,
            help: None,
            others: Vec::new(),
        }
    }

    /// Returns only the message.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Adds other mistakes, shown below this one.
    pub fn with_others(mut self, others: Vec<Self>) -> Self {
        self.others = others;
        self
    }

    /// Adds advice on how to correct it.
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(one_line(&shortened(help.into(), MAX_TEXT)).into_owned());
        self
    }

    /// Adds the output of another program, which may have several lines.
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        let note = shortened(note.into(), MAX_NOTE);
        self.note = Some(visible(note.trim_end()).into_owned());
        self
    }

    /// Adds an excerpt: the first line of the bytes `span` of `text`, which is named `file`, with
    /// carets below these bytes and the label beside them. Message, label and advice are cut to one
    /// line each.
    pub fn at(mut self, file: &str, text: &str, span: Range<usize>, label: &str) -> Self {
        let start = span.start.min(text.len());
        let line_start = line_start(text, start);
        let line_text = text[line_start..].lines().next().unwrap_or_default();
        let begin = (start - line_start).min(line_text.len());
        let end = span.end.saturating_sub(line_start).min(line_text.len());
        let marked = line_text.get(begin..end).unwrap_or_default();
        let shown = marked.char_indices().nth(MAX_UNDERLINED);
        let n_shown = shown.map_or(marked.len(), |(byte, _)| byte);
        self.message = truncated(&self.message, MAX_MESSAGE);
        self.help = self.help.map(|help| truncated(&help, MAX_LIST));
        self.excerpt = Some(Excerpt {
            file: one_line(file).into_owned(),
            line: 1 + text[..line_start].matches('\n').count(),
            text: line_text.to_owned(),
            span: begin..begin + n_shown,
            label: truncated(label, MAX_LIST),
        });
        self
    }

    /// Formats the message for a terminal; `styled` adds colors. A blank line precedes each
    /// other mistake.
    pub fn render(&self, styled: bool) -> String {
        let mut text = self.render_own(styled);
        for other in &self.others {
            text += "\n\n";
            text += &other.render(styled);
        }
        text
    }

    fn render_own(&self, styled: bool) -> String {
        let mut group =
            Level::ERROR
                .primary_title(self.message.as_str())
                .elements(self.excerpt.as_ref().map(|excerpt| {
                    Snippet::source(excerpt.text.as_str())
                        .line_start(excerpt.line)
                        .path(excerpt.file.as_str())
                        .annotation(
                            AnnotationKind::Primary
                                .span(excerpt.span.clone())
                                .label(excerpt.label.as_str()),
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

/// The message, as `main` prints it after `Error:`.
impl fmt::Debug for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = self.render(false);
        f.write_str(text.strip_prefix("error: ").unwrap_or(&text))
    }
}

impl std::error::Error for Diagnostic {}

/// Returns the start and the end of a text that has more than `n_most` characters: a long value is
/// between the words about it.
pub fn shortened(text: String, n_most: usize) -> String {
    let n = text.chars().count();
    if n <= n_most {
        return text;
    }
    let start = text.chars().take(n_most / 2);
    let end = text.chars().skip(n - n_most / 2);
    start.chain(['…']).chain(end).collect()
}

/// Returns the text as one line of at most `n_most` characters, and an ellipsis if it is longer.
pub fn truncated(text: &str, n_most: usize) -> String {
    let line = one_line(text);
    match line.char_indices().nth(n_most) {
        None => line.into_owned(),
        Some((end, _)) => format!("{}…", &line[..end]),
    }
}

/// Returns the start of the line that contains byte `at`.
pub fn line_start(text: &str, at: usize) -> usize {
    text[..at].rfind('\n').map_or(0, |newline| newline + 1)
}
