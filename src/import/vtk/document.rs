//! The elements of a VTK XML file.

use std::borrow::Cow;

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use super::super::fault::cut;
use super::super::{FileFault, Result};

/// Maximum number of elements of a file, and maximum nesting depth: VTK's files have a few for each
/// array of each piece.
const MAX_ELEMENTS: usize = 1 << 16;
const MAX_DEPTH: usize = 32;
/// Maximum number of attributes of an element: VTK writes a dozen.
const MAX_ATTRIBUTES: usize = 64;

/// An element.
#[derive(Debug, Default)]
pub(super) struct Element<'a> {
    pub(super) name: String,
    attributes: Vec<(String, String)>,
    pub(super) children: Vec<Self>,
    /// The last text in the element that is not blank.
    pub(super) text: &'a [u8],
}

impl Element<'_> {
    /// Returns the value of an attribute.
    pub(super) fn attribute(&self, name: &str) -> Option<&str> {
        let found = self.attributes.iter().find(|(known, _)| known == name);
        found.map(|(_, value)| value.as_str())
    }

    /// Returns the value of a required attribute.
    ///
    /// # Errors
    /// The attribute is missing.
    pub(super) fn required(&self, name: &str) -> Result<&str> {
        self.attribute(name).ok_or_else(|| {
            let problem = format!("an element `{}` has no `{name}`", cut(&self.name));
            FileFault::new(problem, "a VTK file as VTK writes it")
        })
    }

    /// Returns the value of an attribute as a count; 0 without it.
    ///
    /// # Errors
    /// The value is not a number.
    pub(super) fn number(&self, name: &str) -> Result<usize> {
        match self.attribute(name) {
            None => Ok(0),
            Some(_) => self.numbers(name).map(|[number]| number),
        }
    }

    /// Returns the numbers in an attribute.
    ///
    /// # Errors
    /// The attribute is missing, or has other words or a different number of them.
    pub(super) fn numbers<T: std::str::FromStr, const N: usize>(
        &self,
        name: &str,
    ) -> Result<[T; N]> {
        let value = self.required(name)?;
        let words = value.split_ascii_whitespace().map(|word| word.parse().ok());
        let numbers = words.collect::<Option<Vec<T>>>();
        numbers
            .and_then(|found| found.try_into().ok())
            .ok_or_else(|| {
                let problem = format!("`{name}` is `{}`", cut(value));
                let expected = if N == 1 {
                    "a number".to_owned()
                } else {
                    format!("{N} numbers")
                };
                FileFault::new(problem, expected)
            })
    }

    /// Returns true if a child is an array of this name.
    pub(super) fn has_array(&self, name: &str) -> bool {
        let mut children = self.children.iter();
        children.any(|child| child.attribute("Name") == Some(name))
    }

    /// Returns the child of this name.
    pub(super) fn child(&self, name: &str) -> Option<&Self> {
        self.children.iter().find(|child| child.name == name)
    }
}

/// Parses the elements of a file; also returns its appended data: the bytes after the `_`.
pub(super) fn parse(bytes: &[u8]) -> Result<(Element<'_>, &[u8])> {
    let mut reader = Reader::from_reader(bytes);
    reader.config_mut().expand_empty_elements = true;
    let mut open: Vec<Element> = vec![Element::default()];
    for _ in 0..4 * MAX_ELEMENTS {
        let event = reader.read_event().map_err(|error| {
            let problem = format!("it is damaged: {error}");
            FileFault::new(problem, "a VTK file as VTK writes it")
        })?;
        match event {
            Event::Start(start) => {
                let element = element(&start)?;
                let is_data = element.name == "AppendedData";
                open.push(element);
                if is_data {
                    let rest = &bytes[reader.buffer_position() as usize..];
                    let rest = rest.trim_ascii_start().strip_prefix(b"_");
                    return Ok((closed(open), rest.unwrap_or_default()));
                }
                if open.len() > MAX_DEPTH {
                    return Err(too_many());
                }
            }
            Event::End(_) => {
                let element = open.pop().unwrap_or_default();
                open.last_mut().ok_or_else(too_many)?.children.push(element);
            }
            Event::Text(text) => {
                if let Cow::Borrowed(text) = text.into_inner()
                    && let text = text.trim_ascii()
                    && !text.is_empty()
                    && let Some(element) = open.last_mut()
                {
                    element.text = text;
                }
            }
            Event::Eof if open.len() == 1 => return Ok((closed(open), &[])),
            Event::Eof => return Err(FileFault::new("it ends early", "a whole file")),
            _ => {}
        }
    }
    Err(too_many())
}

/// Closes all open elements and returns the outermost.
fn closed(mut open: Vec<Element<'_>>) -> Element<'_> {
    while open.len() > 1 {
        let element = open.pop().unwrap_or_default();
        if let Some(parent) = open.last_mut() {
            parent.children.push(element);
        }
    }
    let root = open.pop().unwrap_or_default();
    root.children.into_iter().next().unwrap_or_default()
}

fn element<'a>(start: &BytesStart<'_>) -> Result<Element<'a>> {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let mut attributes = Vec::new();
    for attribute in start.attributes().with_checks(false).take(MAX_ATTRIBUTES) {
        let damaged = || FileFault::new("an attribute is damaged", "`name=\"value\"`");
        let attribute = attribute.map_err(|_| damaged())?;
        let value = attribute.normalized_value(XmlVersion::Implicit1_0);
        let value = value.map_err(|_| damaged())?.into_owned();
        attributes.push((text(attribute.key.as_ref()), value));
    }
    Ok(Element {
        name: text(start.name().as_ref()),
        attributes,
        ..Element::default()
    })
}

fn too_many() -> FileFault {
    FileFault::new(
        "it has too many elements",
        format!("at most {MAX_ELEMENTS}, at most {MAX_DEPTH} within each other"),
    )
}
