//! Where each key and value of a YAML text stands.

use std::collections::HashSet;
use std::fmt;
use std::ops::Range;

use saphyr_parser::{Event, Parser, Span};

use super::diagnostic::Fault;

/// One step down a YAML tree.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Step {
    /// Into a mapping.
    Key(String),
    /// Into a sequence, 0 is the first.
    Index(usize),
}

/// The way from the root of a YAML tree to one of its values.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub struct Path(pub Vec<Step>);

impl Path {
    /// The path one key further down.
    pub fn key(mut self, key: impl Into<String>) -> Self {
        self.0.push(Step::Key(key.into()));
        self
    }

    /// The path one index further down.
    pub fn index(mut self, index: usize) -> Self {
        self.0.push(Step::Index(index));
        self
    }
}

/// `objects[2].sphere.radius`
impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (depth, step) in self.0.iter().enumerate() {
            match step {
                Step::Key(key) if depth == 0 => write!(f, "{key}")?,
                Step::Key(key) => write!(f, ".{key}")?,
                Step::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// Checks what serde_yaml does not, or not with a position: syntax, and keys
/// given twice in one mapping.
pub(super) fn check(text: &str) -> Result<(), Fault> {
    walk(text, |_, _, _| {})
}

/// The bytes of the value at `path` (of its key if `at_key`), or of its
/// nearest ancestor in the text.
pub(super) fn locate(text: &str, path: &Path, at_key: bool) -> Option<Range<usize>> {
    let mut deepest = (0, None);
    let _ = walk(text, |here, key, value| {
        if path.0.starts_with(here) && here.len() >= deepest.0 {
            let whole = here.len() == path.0.len();
            // A block collection has no first character of its own: show its key.
            let point_at_key = !whole || at_key || is_block(text, value);
            let span = key.filter(|_| point_at_key).unwrap_or(value);
            deepest = (here.len(), Some(bytes(text, span)));
        }
    });
    deepest.1
}

fn is_block(text: &str, span: Span) -> bool {
    span.is_empty() || bytes(text, span).len() == 0
}

/// A collection that is open during the walk.
struct Frame {
    start: Span,
    /// The key that stands before the collection.
    key: Option<Span>,
    kind: Kind,
}

enum Kind {
    Sequence {
        next: usize,
    },
    Mapping {
        seen: HashSet<String>,
        key: Option<Span>,
    },
}

/// Calls `visit(path, key, value)` for every value of the text, in its order
/// (collections when they end).
fn walk(text: &str, mut visit: impl FnMut(&[Step], Option<Span>, Span)) -> Result<(), Fault> {
    let mut frames: Vec<Frame> = Vec::new();
    let mut path: Vec<Step> = Vec::new();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| syntax(text, &error))?;
        let opened = match event {
            Event::SequenceStart(..) => Some(Kind::Sequence { next: 0 }),
            Event::MappingStart(..) => Some(Kind::Mapping {
                seen: HashSet::new(),
                key: None,
            }),
            _ => None,
        };
        match event {
            Event::SequenceEnd | Event::MappingEnd => {
                if let Some(frame) = frames.pop() {
                    let end = if span.is_empty() { frame.start } else { span };
                    visit(&path, frame.key, Span::new(frame.start.start, end.end));
                }
                leave(&mut frames, &mut path);
            }
            Event::Scalar(ref word, ..) => {
                if take_key(&mut frames, &mut path, word, span)
                    .map_err(|word| duplicate(text, &path, &word, span))?
                {
                    continue;
                }
                let key = enter(&frames, &mut path);
                visit(&path, key, span);
                leave(&mut frames, &mut path);
            }
            Event::Alias(_) => {
                let key = enter(&frames, &mut path);
                visit(&path, key, span);
                leave(&mut frames, &mut path);
            }
            _ => {}
        }
        if let Some(kind) = opened {
            let key = enter(&frames, &mut path);
            frames.push(Frame {
                start: span,
                key,
                kind,
            });
        }
    }
    Ok(())
}

/// Takes the scalar as a key where a mapping waits for one; `Err` holds a key
/// that the mapping had already.
fn take_key(
    frames: &mut [Frame],
    path: &mut Vec<Step>,
    word: &str,
    span: Span,
) -> Result<bool, String> {
    let Some(Frame {
        kind: Kind::Mapping { seen, key },
        ..
    }) = frames.last_mut()
    else {
        return Ok(false);
    };
    if key.is_some() {
        return Ok(false);
    }
    if !seen.insert(word.to_owned()) {
        return Err(word.to_owned());
    }
    *key = Some(span);
    path.push(Step::Key(word.to_owned()));
    Ok(true)
}

/// Steps into the next value of the open collection; gives its key.
fn enter(frames: &[Frame], path: &mut Vec<Step>) -> Option<Span> {
    match &frames.last()?.kind {
        Kind::Mapping { key, .. } => *key,
        Kind::Sequence { next } => {
            path.push(Step::Index(*next));
            None
        }
    }
}

/// Steps out of a value.
fn leave(frames: &mut [Frame], path: &mut Vec<Step>) {
    match frames.last_mut().map(|frame| &mut frame.kind) {
        Some(Kind::Mapping { key, .. }) => *key = None,
        Some(Kind::Sequence { next }) => *next += 1,
        None => return,
    }
    path.pop();
}

fn syntax(text: &str, error: &saphyr_parser::ScanError) -> Fault {
    let start = byte_of(text, error.marker().index());
    let line_start = text[..start].rfind('\n').map_or(0, |newline| newline + 1);
    let line = text[line_start..].lines().next().unwrap_or_default();
    let help = if line.trim_start_matches(' ').starts_with('\t') {
        "YAML forbids tabs in the indentation: use spaces"
    } else {
        "check the indentation, the space after each `:` and that brackets and quotes are closed"
    };
    Fault {
        span: Some(start..start),
        ..Fault::new(Path::default(), "the YAML syntax is broken", error.info()).with_help(help)
    }
}

fn duplicate(text: &str, path: &[Step], word: &str, span: Span) -> Fault {
    let path = Path(path.to_vec()).key(word);
    Fault {
        span: Some(bytes(text, span)),
        ..Fault::new(
            path.clone(),
            format!("`{path}` is given twice"),
            "the second one",
        )
        .with_help("keep one of the two")
    }
}

fn bytes(text: &str, span: Span) -> Range<usize> {
    byte_of(text, span.start.index())..byte_of(text, span.end.index())
}

/// The byte at which the character with this index starts.
fn byte_of(text: &str, n_characters: usize) -> usize {
    text.char_indices()
        .nth(n_characters)
        .map_or(text.len(), |(byte, _)| byte)
}
