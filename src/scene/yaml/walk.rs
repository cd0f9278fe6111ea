//! Visits all values of a YAML text with their paths.

use std::cell::Cell;
use std::collections::HashMap;
use std::ops::Range;

use saphyr_parser::{Event, Parser, ScalarStyle, Span, Tag};

use super::expansion::{Excess, Expansion};
use super::fault::Fault;
use super::field_path::{FieldPath, Step};
use super::syntax::{self, bytes, bytes_after};
use world::values::{MAX_NAME, is_long};

/// A value of the text.
pub(super) struct Node<'a> {
    pub path: &'a [Step],
    /// The key, for a value in a mapping.
    pub key: Option<Span>,
    /// The span of the value; empty for a block collection.
    pub value: Span,
    /// True if the value is missing.
    pub is_empty: bool,
}

/// Calls `visit` for every value in the order of the text, and for a collection at its end. The
/// text is the value of a path of `n_levels_above` steps.
///
/// # Errors
/// The first syntax error, or the first use of YAML that scenes do not allow: a second document, a
/// tag, a key that is not a scalar, a duplicate key, or more values or levels than a limit.
pub(super) fn walk(
    text: &str,
    n_levels_above: usize,
    visit: impl FnMut(Node),
) -> Result<(), Fault> {
    let mut walk = Walk {
        text,
        visit,
        frames: Vec::new(),
        path: Vec::new(),
        last_key: Cell::default(),
        has_document: false,
    };
    let mut expansion = Expansion::below(n_levels_above);
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| {
            let opened = walk
                .frames
                .iter()
                .map(|frame| bytes(text, frame.start).start);
            syntax::fault(text, &error, opened)
        })?;
        walk.check(&event, span)?;
        expansion.take(&event).map_err(|excess| {
            let at = bytes(text, span);
            match excess {
                Excess::Levels => syntax::too_deep(at),
                Excess::Aliases => too_many_values(at),
            }
        })?;
        walk.follow(event, span);
    }
    Ok(())
}

fn too_many_values(alias: Range<usize>) -> Fault {
    let message = "the aliases (`*name`) expand to too many values";
    let help = "write some of the values in full, or use a generator such as `sphere_cloud`";
    Fault::at_bytes(alias, message, "with this one").with_help(help)
}

struct Walk<'t, V> {
    text: &'t str,
    visit: V,
    /// The open collections, the outermost first.
    frames: Vec<Frame>,
    path: Vec<Step>,
    /// The characters and the bytes before the last key.
    last_key: Cell<[usize; 2]>,
    has_document: bool,
}

struct Frame {
    start: Span,
    /// The key of the collection.
    key: Option<Span>,
    kind: Kind,
}

enum Kind {
    Sequence {
        next: usize,
    },
    Mapping {
        /// The keys so far, with their lines.
        seen: HashMap<String, usize>,
        /// The key whose value comes next.
        key: Option<Span>,
    },
}

impl<V: FnMut(Node)> Walk<'_, V> {
    fn check(&self, event: &Event, span: Span) -> Result<(), Fault> {
        let fault = |message: &str, expected: &str| {
            Err(Fault::at_bytes(bytes(self.text, span), message, expected))
        };
        if let Some(tag) = tag(event) {
            let message = format!("the tag `{tag}` has no meaning in a scene");
            return fault(&message, "expected a value without `!`");
        }
        if let Event::Scalar(word, ScalarStyle::Plain, ..) = event
            && !word.is_ascii()
        {
            self.check_spaces(word, span)?;
        }
        match (event, self.keys_before()) {
            (Event::DocumentStart(_), _) if self.has_document => {
                fault("a second scene begins here", "expected one scene in a file")
            }
            (Event::Alias(_) | Event::SequenceStart(..) | Event::MappingStart(..), Some(_)) => {
                fault("a key must be a word", "expected a name such as `image`")
            }
            (Event::Scalar(word, ..), Some(_)) if word.is_empty() => {
                fault("a key is missing", "expected a name before the `:`")
            }
            (Event::Scalar(word, ..), Some(_)) if word == "<<" => fault(
                "merge keys (`<<`) are not supported",
                "expected the keys themselves",
            ),
            (Event::Scalar(word, ..), Some(_)) if is_long(word) => fault(
                "a key is too long",
                &format!("expected at most {MAX_NAME} characters"),
            ),
            (Event::Scalar(word, ..), Some(seen)) if seen.contains_key(&**word) => {
                let path = FieldPath(self.path.clone()).key(&**word);
                let message = format!("`{path}` is given twice");
                let label = format!("the second one: the first is in line {}", seen[&**word]);
                let fault = Fault::at_bytes(bytes(self.text, span), message, label);
                Err(match self.path.last() {
                    Some(Step::Index(_)) => {
                        fault.with_help("begin each item of the list with `- `")
                    }
                    _ => fault,
                })
            }
            (Event::Scalar(_, ScalarStyle::Plain, ..), Some(_)) => {
                let key = bytes_after(self.text, span, self.last_key.get());
                self.last_key.set([span.start.index(), key.start]);
                self.check_decimal_comma(key)
            }
            _ => Ok(()),
        }
    }

    /// Refuses a space that YAML takes for a letter, such as the no-break space of web pages, at an
    /// end of a text or after a `:`.
    fn check_spaces(&self, word: &str, span: Span) -> Result<(), Fault> {
        let is_strange = |c: char| c.is_whitespace() && !c.is_ascii();
        let is_inside = word.trim_matches(is_strange) == word;
        if is_inside && !word.split(is_strange).any(|part| part.ends_with(':')) {
            return Ok(());
        }
        let at = bytes(self.text, span).start;
        let mut strange = self.text[at..]
            .char_indices()
            .filter(|(_, c)| is_strange(*c));
        let (offset, space) = strange.next().unwrap_or_default();
        let place = at + offset..at + offset + space.len_utf8();
        let message = format!("a space that no keyboard types: U+{:04X}", space as u32);
        let fault = Fault::at_bytes(place, message, "expected a plain space");
        Err(fault.with_help("type it again: text that is copied from web pages has such spaces"))
    }

    /// Refuses a key that is the end of a decimal number, as in `{ radius: 0,8 }`.
    fn check_decimal_comma(&self, key: Range<usize>) -> Result<(), Fault> {
        let digits = &self.text[key.clone()];
        let behind = self.text[key.end..].trim_start();
        let Some(number) = self.text[..key.start].strip_suffix(',') else {
            return Ok(());
        };
        let whole = number.trim_end_matches(|c: char| c.is_ascii_digit());
        let is_number = digits.bytes().all(|digit| digit.is_ascii_digit());
        if !is_number || whole.len() == number.len() || behind.starts_with(':') {
            return Ok(());
        }
        let message = "a decimal number has a point, not a comma";
        let expected = format!("expected `{}.{digits}`", &number[whole.len()..]);
        Err(Fault::at_bytes(whole.len()..key.end, message, expected))
    }

    /// Returns the keys of the innermost mapping so far if a key comes next.
    fn keys_before(&self) -> Option<&HashMap<String, usize>> {
        match &self.frames.last()?.kind {
            Kind::Mapping { seen, key: None } => Some(seen),
            _ => None,
        }
    }

    fn follow(&mut self, event: Event, span: Span) {
        match event {
            Event::DocumentStart(_) => self.has_document = true,
            Event::Scalar(word, ..) if self.keys_before().is_some() => {
                self.take_key(word.into_owned(), span);
            }
            Event::Scalar(word, ScalarStyle::Plain, ..) if word.is_empty() => {
                let key = self.enter();
                self.leave(key, Span::empty(span.start), true);
            }
            Event::Scalar(..) | Event::Alias(_) => {
                let key = self.enter();
                self.leave(key, span, false);
            }
            Event::SequenceStart(..) => self.open(span, Kind::Sequence { next: 0 }),
            Event::MappingStart(..) => {
                let (seen, key) = (HashMap::new(), None);
                self.open(span, Kind::Mapping { seen, key });
            }
            Event::SequenceEnd | Event::MappingEnd => self.close(span),
            _ => {}
        }
    }

    fn take_key(&mut self, word: String, span: Span) {
        if let Some(Kind::Mapping { seen, key }) = self.innermost() {
            *key = Some(span);
            seen.insert(word.clone(), span.start.line());
            self.path.push(Step::Key(word));
        }
    }

    fn open(&mut self, start: Span, kind: Kind) {
        let key = self.enter();
        self.frames.push(Frame { start, key, kind });
    }

    fn close(&mut self, end: Span) {
        if let Some(Frame { start, key, .. }) = self.frames.pop() {
            // The end of a block collection has no character and may be several lines below.
            let end = if end.is_empty() { start } else { end };
            self.leave(key, Span::new(start.start, end.end), false);
        }
    }

    /// Enters the next value; returns its key.
    fn enter(&mut self) -> Option<Span> {
        match self.innermost()? {
            Kind::Mapping { key, .. } => *key,
            Kind::Sequence { next } => {
                let step = Step::Index(*next);
                self.path.push(step);
                None
            }
        }
    }

    /// Visits the value that ends here and leaves it.
    fn leave(&mut self, key: Option<Span>, value: Span, is_empty: bool) {
        (self.visit)(Node {
            path: &self.path,
            key,
            value,
            is_empty,
        });
        match self.innermost() {
            Some(Kind::Mapping { key, .. }) => *key = None,
            Some(Kind::Sequence { next }) => *next += 1,
            None => return,
        }
        self.path.pop();
    }

    fn innermost(&mut self) -> Option<&mut Kind> {
        self.frames.last_mut().map(|frame| &mut frame.kind)
    }
}

/// Returns the tag of a value unless YAML's core schema defines it.
fn tag<'a>(event: &'a Event) -> Option<&'a Tag> {
    match event {
        Event::Scalar(_, _, _, tag)
        | Event::SequenceStart(_, tag)
        | Event::MappingStart(_, tag) => tag.as_deref().filter(|tag| !tag.is_yaml_core_schema()),
        _ => None,
    }
}
