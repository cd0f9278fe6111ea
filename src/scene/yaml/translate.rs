//! Translates messages of serde to faults in plain language.
//!
//! The formats of serde's messages ("unknown field `x`, expected one of …", "invalid type: string
//! "x", expected …") come from the default methods of its `Error` trait. The deserializers of this
//! crate may return "cannot …, expected …" or "needs …, expected …" instead, which is appended to
//! the path of the value. Any other message comes from libyaml.

use serde_path_to_error::Segment;

use super::fault::Fault;
use super::field_path::{FieldPath, Step};
use super::meant;
use super::position::Location;
use super::setting::LocatedText;
use super::syntax::{self, AFTER_COLON};
use host::text::{did_you_mean, number_meant};

/// The starts of the messages of this program's own types.
const OWN_STARTS: [&str; 2] = ["cannot ", "needs "];

/// Translates an error that serde_yaml found at a path of `text`.
pub(super) fn fault(text: &LocatedText, path: FieldPath, error: &serde_yaml::Error) -> Fault {
    let message = message_of(error);
    let (problem, expected) = message.rsplit_once(", expected ").unwrap_or((&message, ""));
    let between = |start: &str| problem.strip_prefix(start)?.strip_suffix('`');

    if let Some(word) = between("unknown field `") {
        return unknown_key(path, word, expected);
    }
    if let Some(word) = between("unknown variant `") {
        return unknown_choice(text, path, word, expected);
    }
    if let Some(word) = missing_key_of(error) {
        return missing_key(text, path, &word);
    }
    let is_ours = OWN_STARTS.iter().any(|start| problem.starts_with(start));
    if is_ours && !expected.is_empty() {
        let message = format!("{} {problem}", subject(&path));
        let label = format!("expected {}", listed(expected));
        return Fault::new(path, message, label);
    }
    if problem.starts_with("invalid ") {
        return invalid(text, path, problem, expected);
    }
    match message.as_str() {
        "repetition limit exceeded" => Fault::new(
            FieldPath::default(),
            "the aliases (`*name`) expand to too many values",
            "begins here",
        )
        .with_help("write some of the values in full, or use a generator such as `sphere_cloud`"),
        _ => syntax::translate_libyaml(text.text, error),
    }
}

/// Returns true if the error is about an unknown key.
pub(super) fn is_unknown_key(error: &serde_yaml::Error) -> bool {
    message_of(error).starts_with("unknown field `")
}

/// Returns the unknown key or word of an error, and the known ones; `None` for other errors.
pub(super) fn unknown_key_of(error: &serde_yaml::Error) -> Option<(String, Vec<String>)> {
    let message = message_of(error);
    let (problem, expected) = message.rsplit_once(", expected ")?;
    let word = problem.strip_prefix("unknown field `");
    let word = word.or_else(|| problem.strip_prefix("unknown variant `"))?;
    let choices = quoted(expected).map(str::to_owned).collect();
    Some((word.strip_suffix('`')?.to_owned(), choices))
}

/// Returns the missing key of an error; `None` for other errors.
pub(super) fn missing_key_of(error: &serde_yaml::Error) -> Option<String> {
    let message = message_of(error);
    let word = message.strip_prefix("missing field `")?.strip_suffix('`')?;
    Some(word.to_owned())
}

/// Returns serde_yaml's message without the path before it and the position
/// after it, which the excerpt shows.
fn message_of(error: &serde_yaml::Error) -> String {
    let mut message = error.to_string();
    if let Some(place) = error.location() {
        let position = format!(" at line {} column {}", place.line(), place.column());
        if let Some(without) = message.strip_suffix(&position) {
            message.truncate(without.len());
        }
    }
    const STARTS: [&str; 6] = [
        "unknown field `",
        "unknown variant `",
        "missing field `",
        "invalid type: ",
        "invalid value: ",
        "invalid length ",
    ];
    match STARTS
        .iter()
        .chain(&OWN_STARTS)
        .filter_map(|start| message.find(start))
        .min()
    {
        Some(begin) => message.split_off(begin),
        None => message,
    }
}

fn unknown_key(path: FieldPath, word: &str, expected: &str) -> Fault {
    let list = format!("the choices are {}", listed(expected));
    let is_known = |key: &str| quoted(expected).any(|known| known == key);
    if let Some((key, value)) = word.split_once(':').filter(|(key, _)| is_known(key)) {
        let fault = Fault::at_key(path, format!("`{word}` lacks a space"), AFTER_COLON);
        return fault.with_help(format!("write `{key}: {value}`"));
    }
    let help = match did_you_mean(word, quoted(expected)) {
        Some(suggestion) => format!("{suggestion} ({list})"),
        None => list,
    };
    Fault::at_key(path, format!("unknown key `{word}`"), "no such key here").with_help(help)
}

/// Returns the fault of an unknown variant: a string, or the only key of a mapping.
fn unknown_choice(text: &LocatedText, path: FieldPath, word: &str, expected: &str) -> Fault {
    let is_key = path.0.last() == Some(&Step::Key(word.to_owned()))
        && location_of(text, &path).is_none_or(|location| location.written(text.text) != word);
    let label = format!("expected {}", listed(expected));
    let fault = if is_key {
        Fault::at_key(path, format!("unknown key `{word}`"), label)
    } else {
        let message = format!("{} cannot be `{word}`", subject(&path));
        Fault::new(path, message, label)
    };
    let help = did_you_mean(word, quoted(expected));
    Fault { help, ..fault }
}

/// Help for a color without quotes.
const UNQUOTED_COLOR: &str = "`#` starts a comment: put the color in quotes";

fn missing_key(text: &LocatedText, path: FieldPath, word: &str) -> Fault {
    let value = location_of(text, &path.clone().key(word));
    let help = if value.is_some_and(|value| value.is_hidden_by_comment(text.text)) {
        UNQUOTED_COLOR.to_owned()
    } else if location_of(text, &path).is_some_and(|location| location.is_empty) {
        format!("add `{word}: …` below it, indented deeper")
    } else {
        format!("add `{word}: …`")
    };
    let message = format!("{} needs the key `{word}`", subject(&path));
    Fault::at_key(path, message, "it is missing here").with_help(help)
}

/// Returns the fault of a value of the wrong type or out of its range.
fn invalid(text: &LocatedText, path: FieldPath, problem: &str, expected: &str) -> Fault {
    let subject = subject(&path);
    let location = location_of(text, &path);
    let written = location
        .as_ref()
        .map_or("", |location| location.written(text.text));
    if expected == "newtype variant" {
        let message = format!("{subject} cannot be the word `{written}` alone");
        return Fault::new(path, message, format!("expected `{written}: …`"));
    }
    if expected == "enum" || expected.starts_with("map ") {
        return not_one_key(path, &subject);
    }
    let found = if location.as_ref().is_some_and(|location| location.is_empty) {
        "empty".to_owned()
    } else {
        found_of(problem, written)
    };
    let fault = Fault::new(
        path,
        format!("{subject} cannot be {found}"),
        format!("expected {}", description(expected)),
    );
    let is_type = problem.starts_with("invalid type");
    let is_comment = |location: &Location| location.is_hidden_by_comment(text.text);
    let help = match expected {
        _ if expected.contains("color") && location.as_ref().is_some_and(is_comment) => {
            Some(UNQUOTED_COLOR.to_owned())
        }
        _ if expected.starts_with("the name") && found.starts_with('`') => {
            Some("quote a name that looks like a number or a boolean".to_owned())
        }
        _ if expected.contains("number") && (is_type || problem.contains(": string ")) => {
            number_meant(written, expected.contains("whole"))
                .or_else(|| meant::advice(written, expected))
        }
        _ if problem.contains(": string ") => meant::advice(written, expected),
        _ if problem.starts_with("invalid length") && has_decimal_commas(written) => {
            Some("write a point in a decimal number: `0.5`, not `0,5`".to_owned())
        }
        _ => None,
    };
    Fault { help, ..fault }
}

/// Returns true if only some commas of a list are followed by a space, as in `[0,5, 1, 2]`.
fn has_decimal_commas(written: &str) -> bool {
    let commas = || written.split(',').skip(1);
    let is_decimal = |behind: &str| behind.starts_with(|c: char| c.is_ascii_digit());
    commas().any(is_decimal) && commas().any(|behind| behind.starts_with(' '))
}

fn not_one_key(path: FieldPath, subject: &str) -> Fault {
    let is_item = matches!(path.0.last(), Some(Step::Index(_)));
    let fault = Fault::new(
        path,
        format!("{subject} must have exactly one key"),
        "expected one choice, with its own keys below it",
    );
    if is_item {
        fault.with_help("begin each item of the list with `- `")
    } else {
        fault
    }
}

/// Describes the found value; follows the words "cannot be".
fn found_of(problem: &str, written: &str) -> String {
    match problem.strip_prefix("invalid length ") {
        Some("0") => return "an empty list".to_owned(),
        Some(n) => return format!("a list of {n}"),
        None => {}
    }
    let found = problem.split_once(": ").map_or(problem, |(_, found)| found);
    let (kind, value) = found.split_once(' ').unwrap_or((found, ""));
    match kind {
        "map" => "a mapping of keys".to_owned(),
        "sequence" => "a list".to_owned(),
        "unit" => "empty".to_owned(),
        // serde reads `1e400` as a string.
        "string" if written.parse::<f64>().is_err() => format!("the text {value}"),
        "string" | "boolean" | "integer" | "floating" if !written.starts_with('*') => {
            format!("`{written}`")
        }
        "boolean" | "integer" => value.to_owned(),
        "floating" => value.replace("point ", ""),
        _ => found.to_owned(),
    }
}

/// Describes the expected value; follows the word "expected".
fn description(expected: &str) -> String {
    let n_of = |start: &str, end: &str| expected.strip_prefix(start)?.strip_suffix(end);
    if let Some(n) = n_of("an array of length ", "").or(n_of("sequence of ", " elements")) {
        return format!("a list of {n}");
    }
    match expected {
        "a map" => "keys with values: { key: value, … }".to_owned(),
        "a sequence" => "a list: begin each item with `- `".to_owned(),
        "a string" => "a text".to_owned(),
        "an integer" => "a whole number".to_owned(),
        "a float" => "a number".to_owned(),
        "unit variant" => "a word alone".to_owned(),
        _ if expected.starts_with("struct ") => "keys with values: { key: value, … }".to_owned(),
        _ => expected.to_owned(),
    }
}

/// Locates exactly the value at `path`; `None` for a value inside an alias.
fn location_of(text: &LocatedText, path: &FieldPath) -> Option<Location> {
    text.locate(path).filter(|location| location.is_exact)
}

/// Converts serde's "one of `a`, `b`, `c`" to "`a`, `b` or `c`"; returns any
/// other text unchanged.
fn listed(expected: &str) -> String {
    let list = expected.strip_prefix("one of ");
    match list.and_then(|list| list.rsplit_once(", ")) {
        Some((all, last)) => format!("{all} or {last}"),
        None => expected.to_owned(),
    }
}

/// Iterates over the texts in backquotes.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// Names the value at the path; begins a sentence.
pub(super) fn subject(path: &FieldPath) -> String {
    if path.0.is_empty() {
        "the scene".to_owned()
    } else {
        format!("`{path}`")
    }
}

pub(super) fn path_of(path: &serde_path_to_error::Path) -> FieldPath {
    FieldPath(
        path.iter()
            .filter_map(|segment| match segment {
                Segment::Seq { index } => Some(Step::Index(*index)),
                Segment::Map { key } => Some(Step::Key(key.clone())),
                Segment::Enum { variant } => Some(Step::Key(variant.clone())),
                Segment::Unknown => None,
            })
            .collect(),
    )
}
