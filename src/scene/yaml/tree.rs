//! YAML values as a tree that remembers how its scalars were written.
//!
//! A scene of several texts is assembled as a tree, and written as one YAML text in flow style. Its
//! reader sees the same scalars as in the texts: a number stays a number, and a quoted number stays
//! text.

use std::collections::HashMap;

use indexmap::IndexMap;
use saphyr_parser::{Event, Parser, ScalarStyle};

use super::field_path::Step;
use super::json::quoted;

/// A value.
#[derive(Debug, Clone)]
pub(super) enum Tree {
    /// A text; if it is plain, it may represent a number or a boolean.
    Scalar { text: String, is_plain: bool },
    /// A list.
    List(Vec<Tree>),
    /// A mapping.
    Map(Keys),
}

/// The keys of a mapping with their values.
pub(super) type Keys = IndexMap<String, Tree>;

/// A collection that has not ended yet.
struct OpenTree {
    tree: Tree,
    anchor: usize,
    /// The key whose value comes next.
    key: Option<String>,
}

impl Tree {
    /// Parses a text without mistakes; aliases are replaced by copies. A text with mistakes gives
    /// the empty value.
    pub(super) fn parse(text: &str) -> Self {
        let mut open: Vec<OpenTree> = Vec::new();
        let mut anchors: HashMap<usize, Self> = HashMap::new();
        for event in Parser::new_from_str(text) {
            let (value, anchor) = match event.map(|(event, _)| event) {
                Ok(Event::Scalar(text, style, anchor, tag)) => {
                    let expects_key = open.last().is_some_and(OpenTree::expects_key);
                    if let Some(OpenTree { key, .. }) = open.last_mut().filter(|_| expects_key) {
                        *key = Some(text.into_owned());
                        continue;
                    }
                    let is_text = tag.is_some_and(|tag| tag.suffix == "str");
                    let is_plain = style == ScalarStyle::Plain && !is_text;
                    let text = text.into_owned();
                    (Self::Scalar { text, is_plain }, anchor)
                }
                Ok(Event::SequenceStart(anchor, _)) => {
                    open.push(OpenTree::new(Self::List(Vec::new()), anchor));
                    continue;
                }
                Ok(Event::MappingStart(anchor, _)) => {
                    open.push(OpenTree::new(Self::Map(IndexMap::new()), anchor));
                    continue;
                }
                Ok(Event::SequenceEnd | Event::MappingEnd) => match open.pop() {
                    Some(OpenTree { tree, anchor, .. }) => (tree, anchor),
                    None => continue,
                },
                Ok(Event::Alias(anchor)) => (anchors.get(&anchor).cloned().unwrap_or_default(), 0),
                Ok(_) => continue,
                // The parser would repeat the error without end.
                Err(_) => break,
            };
            if anchor > 0 {
                anchors.insert(anchor, value.clone());
            }
            match open.last_mut() {
                Some(parent) => parent.take(value),
                None => return value,
            }
        }
        Self::default()
    }

    /// Returns the value one step below; `None` if there is none.
    pub(super) fn child(&mut self, step: &Step) -> Option<&mut Self> {
        match (self, step) {
            (Self::Map(map), Step::Key(key)) => map.get_mut(key),
            (Self::List(list), Step::Index(index)) => list.get_mut(*index),
            _ => None,
        }
    }

    /// Returns the value at a path; `None` if there is none.
    pub(super) fn at(&mut self, path: &[Step]) -> Option<&mut Self> {
        path.iter().try_fold(self, |tree, step| tree.child(step))
    }

    /// Returns the value at a path for reading; `None` if there is none.
    pub(super) fn find(&self, path: &[Step]) -> Option<&Self> {
        path.iter().try_fold(self, |tree, step| match (tree, step) {
            (Self::Map(map), Step::Key(key)) => map.get(key),
            (Self::List(list), Step::Index(index)) => list.get(*index),
            _ => None,
        })
    }

    /// Returns the value of a key of a mapping; `None` if there is none.
    pub(super) fn get(&self, key: &str) -> Option<&Self> {
        match self {
            Self::Map(map) => map.get(key),
            _ => None,
        }
    }

    /// Returns true if it is the empty value.
    pub(super) fn is_empty(&self) -> bool {
        matches!(self, Self::Scalar { text, is_plain: true } if text.is_empty())
    }

    /// Removes the value at a path; returns true if it existed within another value.
    pub(super) fn remove(&mut self, path: &[Step]) -> bool {
        let Some((last, above)) = path.split_last() else {
            return false;
        };
        match (self.at(above), last) {
            (Some(Self::Map(map)), Step::Key(key)) => map.shift_remove(key).is_some(),
            (Some(Self::List(list)), Step::Index(index)) if *index < list.len() => {
                list.remove(*index);
                true
            }
            _ => false,
        }
    }

    /// Formats the value as a YAML text in flow style.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        self.write(&mut text);
        text
    }

    /// Appends the value in flow style.
    fn write(&self, out: &mut String) {
        match self {
            Self::Scalar { text, is_plain } if *is_plain && text.chars().all(is_safe) => {
                out.push_str(text);
            }
            Self::Scalar { text, .. } => out.push_str(&quoted(text)),
            Self::List(list) => {
                out.push('[');
                for item in list {
                    match item {
                        // An empty scalar would not be an item.
                        Self::Scalar {
                            text,
                            is_plain: true,
                        } if text.is_empty() => out.push('~'),
                        _ => item.write(out),
                    }
                    out.push_str(", ");
                }
                out.push(']');
            }
            Self::Map(map) => {
                out.push('{');
                for (key, value) in map {
                    out.push_str(&quoted(key));
                    out.push_str(": ");
                    value.write(out);
                    out.push_str(", ");
                }
                out.push('}');
            }
        }
    }
}

/// The empty value.
impl Default for Tree {
    fn default() -> Self {
        Self::Scalar {
            text: String::new(),
            is_plain: true,
        }
    }
}

impl OpenTree {
    fn new(tree: Tree, anchor: usize) -> Self {
        let key = None;
        Self { tree, anchor, key }
    }

    fn expects_key(&self) -> bool {
        self.key.is_none() && matches!(self.tree, Tree::Map(_))
    }

    fn take(&mut self, value: Tree) {
        match &mut self.tree {
            Tree::List(list) => list.push(value),
            Tree::Map(map) => {
                map.extend(self.key.take().map(|key| (key, value)));
            }
            Tree::Scalar { .. } => {}
        }
    }
}

/// Returns true if a plain scalar of such characters means the same in flow style. All numbers,
/// booleans and nulls have only such characters.
fn is_safe(c: char) -> bool {
    c.is_ascii_alphanumeric() || "_.+-~".contains(c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_written_text_means_the_same() {
        let text = "
a: [1, -0.5, 1e400, 0x1F, 1_000, .inf, ~, null, true, '1', \"x: y\", red green, \"#ff0000\"]
b: &b { c: 'it''s', d: [], e: {}, f: }
g: *b
größe 5: |
  two
  lines
\"h.i\": 99999999999999999999
j:
  - k: a - b
  - \"\\u2028\\0\\x7f\\x85\\ufeff\\uffff\"
\"\\ufeff\": 1
";
        let written = Tree::parse(text).text();
        let read = |text: &str| -> Result<serde_yaml::Value, String> {
            serde_yaml::from_str(text).map_err(|error| error.to_string())
        };
        // A number of more than 64 bits is an error in both.
        assert!(read(text).is_err() && read(&written).is_err());
        let [text, written] =
            [text, &written].map(|text| text.replace("99999999999999999999", "9"));
        assert_eq!(read(&text).unwrap(), read(&written).unwrap());
    }

    #[test]
    fn a_text_with_a_mistake_is_empty() {
        assert_eq!(Tree::parse("a: [1\nb: -").text(), "");
    }
}
