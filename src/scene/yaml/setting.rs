//! A setting of the command line: `camera.look_at.fov_y_deg=30`.
//!
//! Left of the `=` is the path of a value, as messages show it; a key that contains `.`, `[`, `=`
//! or `"` is put in double quotes. Right of it is a value in YAML.

use std::ops::Range;

use super::fault::Fault;
use super::field_path::{FieldPath, Step};
use super::position::{self, Location};
use super::tree::Tree;
use world::values::{MAX_NAME, is_long};

/// The path and the value of a setting, with their positions in its text.
#[derive(Debug, Clone)]
pub(super) struct SettingText {
    pub(super) path: FieldPath,
    /// The bytes of each step.
    steps: Vec<Range<usize>>,
    /// The first byte of the value.
    value: usize,
}

/// The text of a scene file or of a setting, in which values are located.
pub(super) struct LocatedText<'a> {
    pub(super) text: &'a str,
    /// The setting; `None` for a scene file.
    pub(super) setting: Option<&'a SettingText>,
}

impl LocatedText<'_> {
    /// Returns true if the value at `path` is in the text itself, not copied from an anchor.
    pub(super) fn has(&self, path: &FieldPath) -> bool {
        self.locate(path).is_some_and(|location| location.is_exact)
    }

    /// Locates the value at `path`, or its nearest ancestor in the text.
    pub(super) fn locate(&self, path: &FieldPath) -> Option<Location> {
        match self.setting {
            None => position::locate(self.text, path),
            Some(setting) => setting.locate(self.text, path),
        }
    }
}

/// The remedy for a setting without a path or a value.
const ADVICE: &str = "write `--set key.key=value`, such as `--set image.seed=7` or \
                      `--set 'objects[0].sphere.radius=0.5'`";

impl SettingText {
    /// Parses the text of a setting.
    ///
    /// # Errors
    /// The path or the value is not valid.
    pub(super) fn parse(text: &str) -> Result<Self, Fault> {
        let (steps, equals) = steps_of(text)?;
        let value = equals + 1;
        let written = text[value..].trim();
        if written.is_empty() || written.starts_with('#') {
            let message = "the setting has no value";
            let fault = Fault::at_bytes(equals..value, message, "expected a value behind it");
            return Err(match written {
                "" => fault,
                _ => fault.with_help("a `#` begins a comment, but in quotes: `key='\"#ff8800\"'`"),
            });
        }
        position::check(&text[value..], steps.len()).map_err(|fault| fault.moved(value))?;
        let (path, steps) = steps.into_iter().unzip();
        let path = FieldPath(path);
        Ok(Self { path, steps, value })
    }

    /// Returns the value.
    pub(super) fn tree(&self, text: &str) -> Tree {
        Tree::parse(&text[self.value..])
    }

    /// Returns the bytes of the path up to its first `n` steps.
    pub(super) fn steps(&self, n: usize) -> Range<usize> {
        let end = n.max(1).min(self.steps.len());
        self.steps[end - 1].clone()
    }

    /// Locates the value at a path of the scene; for an ancestor of the setting's value, its step.
    pub(super) fn locate(&self, text: &str, path: &FieldPath) -> Option<Location> {
        let depth = self.path.0.len();
        let Some(below) = path
            .0
            .get(depth..)
            .filter(|_| path.0.starts_with(&self.path.0))
        else {
            let common = path.0.iter().zip(&self.path.0).take_while(|(a, b)| a == b);
            return Some(Location::from_step(self.steps(common.count())));
        };
        let inside = position::locate(&text[self.value..], &FieldPath(below.to_vec()))?;
        let inside = inside.moved(self.value);
        Some(match below {
            [] => inside.with_key(self.steps(depth)),
            _ => inside,
        })
    }
}

/// A step and its bytes.
type StepInText = (Step, Range<usize>);

/// Returns the steps of a path, and the byte of the `=` after them.
fn steps_of(text: &str) -> Result<(Vec<StepInText>, usize), Fault> {
    let mut steps = Vec::new();
    let mut at = 0;
    loop {
        let rest = &text[at..];
        let (step, n) = if rest.starts_with('[') {
            index(text, at)?
        } else {
            key(text, at)?
        };
        steps.push((step, at..at + n));
        at += n;
        match text[at..].chars().next() {
            Some('=') => return Ok((steps, at)),
            Some('.') => at += 1,
            Some('[') => {}
            Some(c) => {
                let message = "the path goes on without a `.`";
                let found = at..at + c.len_utf8();
                return Err(Fault::at_bytes(found, message, "expected `.`, `[` or `=`"));
            }
            None => {
                let message = "the setting has no `=`";
                let end = text.len();
                return Err(
                    Fault::at_bytes(0..end, message, "expected `key=value`").with_help(ADVICE)
                );
            }
        }
    }
}

/// Returns the key at a byte, and its length including quotes.
fn key(text: &str, at: usize) -> Result<(Step, usize), Fault> {
    let rest = &text[at..];
    let fault = |message: &str, n: usize, expected: &str| {
        Err(Fault::at_bytes(at..at + n, message, expected).with_help(ADVICE))
    };
    let (key, n) = match rest.strip_prefix('"') {
        Some(quoted) => match quoted.split_once('"') {
            Some((key, _)) => (key, key.len() + 2),
            None => return fault("a quote is not closed", 1, "no closing quote"),
        },
        None => {
            let n = rest.find(['.', '[', '=']).unwrap_or(rest.len());
            (&rest[..n], n)
        }
    };
    if key.is_empty() {
        return fault("a key is missing", n, "expected a name such as `image`");
    }
    if is_long(key) {
        let expected = format!("expected at most {MAX_NAME} characters");
        return fault("a key is too long", n, &expected);
    }
    Ok((Step::Key(key.to_owned()), n))
}

/// Returns the index at a byte, and its length including brackets.
fn index(text: &str, at: usize) -> Result<(Step, usize), Fault> {
    let rest = &text[at..];
    let n = rest.find(']').map_or(rest.len(), |end| end + 1);
    match rest[1..n].strip_suffix(']').map(str::parse) {
        Some(Ok(index)) => Ok((Step::Index(index), n)),
        _ => {
            let message = "an item of a list is named by its number";
            Err(Fault::at_bytes(
                at..at + n,
                message,
                "expected `[0]` for the first",
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_written_as_messages_show_them() {
        let parse = |text: &str| SettingText::parse(text).map(|setting| setting.path);
        let path = FieldPath::default().key("objects").index(12).key("sphere");
        assert_eq!(parse("objects[12].sphere={ radius: 1 }"), Ok(path.clone()));
        assert_eq!(path.to_string(), "objects[12].sphere");
        let quoted = FieldPath::default()
            .key("materials")
            .key("a.b = c")
            .key("d e");
        assert_eq!(parse("materials.\"a.b = c\".d e=0"), Ok(quoted));
        for broken in [
            "",
            "=",
            "a",
            "a=",
            "a= ",
            ".a=1",
            "a..b=1",
            "a[x]=1",
            "a[-1]=1",
            "a[1=1",
            "a[]=1",
            "\"a=1",
            "\"a\"b=1",
            "a=[1",
            "a={",
            "a=\"",
            "a=1\n---\n2",
            "a[99999999999999999999]=1",
        ] {
            let fault = parse(broken).unwrap_err();
            assert!(
                matches!(fault.spot, super::super::fault::Spot::Bytes(_)),
                "{broken}"
            );
        }
    }
}
