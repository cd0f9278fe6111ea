//! The elements of a VTK XML file.

use std::borrow::Cow;
use std::fmt;

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

/// Maximum nesting depth.
pub const MAX_DEPTH: usize = 32;

/// The fault of a document.
#[derive(Debug)]
pub enum XmlFault {
    /// The text is not XML, for this reason.
    Damaged(String),
    /// An attribute is not a name and a quoted value.
    DamagedAttribute,
    /// An element has more attributes than the limit.
    TooManyAttributes,
    /// There are more elements than the limit, or too many within each other.
    TooManyElements,
    /// The text ends within an element.
    EndsEarly,
}

/// Formats the reason as the end of a sentence.
impl fmt::Display for XmlFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Damaged(why) => why,
            Self::DamagedAttribute => "an attribute is damaged",
            Self::TooManyAttributes => "an element has too many attributes",
            Self::TooManyElements => "it has too many elements",
            Self::EndsEarly => "it ends early",
        })
    }
}

/// An element.
#[derive(Debug, Default)]
pub struct Element<'a> {
    /// The name of its tag.
    pub name: String,
    attributes: Vec<(String, String)>,
    /// The elements in it, in the order of the file.
    pub children: Vec<Self>,
    /// The last text in the element that is not blank.
    pub text: &'a [u8],
}

impl Element<'_> {
    /// Returns the value of an attribute.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        let found = self.attributes.iter().find(|(known, _)| known == name);
        found.map(|(_, value)| value.as_str())
    }

    /// Returns the children of this name.
    pub fn children_named(&self, name: &str) -> impl Iterator<Item = &Self> {
        self.children.iter().filter(move |child| child.name == name)
    }

    /// Returns the first child of this name.
    pub fn child(&self, name: &str) -> Option<&Self> {
        self.children.iter().find(|child| child.name == name)
    }

    /// Returns the child whose attribute `Name` is this one.
    pub fn array(&self, name: &str) -> Option<&Self> {
        let mut children = self.children.iter();
        children.find(|child| child.attribute("Name") == Some(name))
    }
}

/// Parses the elements of a file; also returns its appended data: the bytes after the `_`.
///
/// # Errors
/// The text is not XML, has more than `max_events` tags, texts and comments, or more than
/// `max_attributes` of an element.
pub fn parse(
    bytes: &[u8],
    max_events: usize,
    max_attributes: usize,
) -> Result<(Element<'_>, &[u8]), XmlFault> {
    let mut reader = Reader::from_reader(bytes);
    reader.config_mut().expand_empty_elements = true;
    let mut open: Vec<Element> = vec![Element::default()];
    for _ in 0..max_events {
        let event = reader.read_event();
        match event.map_err(|error| XmlFault::Damaged(error.to_string()))? {
            Event::Start(start) => {
                let element = parse_element(&start, max_attributes)?;
                let is_data = element.name == "AppendedData";
                open.push(element);
                if is_data {
                    let rest = &bytes[reader.buffer_position() as usize..];
                    let rest = rest.trim_ascii_start().strip_prefix(b"_");
                    return Ok((closed(open), rest.unwrap_or_default()));
                }
                if open.len() > MAX_DEPTH {
                    return Err(XmlFault::TooManyElements);
                }
            }
            Event::End(_) => {
                let element = open.pop().unwrap_or_default();
                let parent = open.last_mut().ok_or(XmlFault::TooManyElements)?;
                parent.children.push(element);
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
            Event::Eof => return Err(XmlFault::EndsEarly),
            _ => {}
        }
    }
    Err(XmlFault::TooManyElements)
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

fn parse_element<'a>(
    start: &BytesStart<'_>,
    max_attributes: usize,
) -> Result<Element<'a>, XmlFault> {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let mut attributes = Vec::new();
    for attribute in start.attributes().with_checks(false) {
        if attributes.len() == max_attributes {
            return Err(XmlFault::TooManyAttributes);
        }
        let attribute = attribute.map_err(|_| XmlFault::DamagedAttribute)?;
        let value = attribute.normalized_value(XmlVersion::Implicit1_0);
        let value = value.map_err(|_| XmlFault::DamagedAttribute)?.into_owned();
        attributes.push((text(attribute.key.as_ref()), value));
    }
    Ok(Element {
        name: text(start.name().as_ref()),
        attributes,
        ..Element::default()
    })
}
