//! serde's messages → faults in the user's words.
//!
//! The shapes of serde's own messages ("unknown field `x`, expected one of …",
//! "invalid type: string "x", expected …") are part of its documented `Error`
//! trait's default methods. A deserialiser of ours may say "cannot …,
//! expected …" instead, which follows the path of the value; whatever fits
//! none of them is libyaml's.

use serde_path_to_error::Segment;

use super::diagnostic::Fault;
use super::position::{self, Path, Place, Step};
use super::suggestion::{did_you_mean, number_meant};
use super::syntax;

/// The fault that serde_yaml found in `text`.
pub(super) fn fault(
    text: &str,
    path: &serde_path_to_error::Path,
    error: &serde_yaml::Error,
) -> Fault {
    let path = path_of(path);
    let message = message_of(error);
    let (problem, expected) = message.rsplit_once(", expected ").unwrap_or((&message, ""));
    let between = |start: &str| problem.strip_prefix(start)?.strip_suffix('`');

    if let Some(word) = between("unknown field `") {
        return unknown_key(path, word, expected);
    }
    if let Some(word) = between("unknown variant `") {
        return unknown_choice(text, path, word, expected);
    }
    if let Some(word) = between("missing field `") {
        return missing_key(text, path, word);
    }
    if problem.starts_with("cannot ") && !expected.is_empty() {
        let message = format!("{} {problem}", subject(&path));
        let label = format!("expected {}", listed(expected));
        return Fault::new(path, message, label);
    }
    if problem.starts_with("invalid ") {
        return invalid(text, path, problem, expected);
    }
    match message.as_str() {
        "repetition limit exceeded" => Fault::new(
            Path::default(),
            "the aliases (`*name`) stand for too many values",
            "begins here",
        )
        .with_help("write some of the values out, or describe them by a generator"),
        _ => syntax::of_libyaml(text, error),
    }
}

/// serde_yaml's message without the path in front and the position behind,
/// which the snippet shows better.
fn message_of(error: &serde_yaml::Error) -> String {
    let mut message = error.to_string();
    if let Some(place) = error.location() {
        let position = format!(" at line {} column {}", place.line(), place.column());
        if let Some(without) = message.strip_suffix(&position) {
            message.truncate(without.len());
        }
    }
    const STARTS: [&str; 7] = [
        "unknown field `",
        "unknown variant `",
        "missing field `",
        "invalid type: ",
        "invalid value: ",
        "invalid length ",
        "cannot ",
    ];
    match STARTS.iter().filter_map(|start| message.find(start)).min() {
        Some(begin) => message.split_off(begin),
        None => message,
    }
}

fn unknown_key(path: Path, word: &str, expected: &str) -> Fault {
    let list = format!("the choices are {}", listed(expected));
    let help = match did_you_mean(word, quoted(expected)) {
        Some(suggestion) => format!("{suggestion} ({list})"),
        None => list,
    };
    Fault::of_key(path, format!("unknown key `{word}`"), "no such key here").with_help(help)
}

/// A choice is a word, or the one key of a mapping.
fn unknown_choice(text: &str, path: Path, word: &str, expected: &str) -> Fault {
    let is_key = path.0.last() == Some(&Step::Key(word.to_owned()))
        && place_of(text, &path).is_none_or(|place| place.written(text) != word);
    let label = format!("expected {}", listed(expected));
    let fault = match is_key {
        true => Fault::of_key(path, format!("unknown key `{word}`"), label),
        false => {
            let message = format!("{} cannot be `{word}`", subject(&path));
            Fault::new(path, message, label)
        }
    };
    let help = did_you_mean(word, quoted(expected));
    Fault { help, ..fault }
}

fn missing_key(text: &str, path: Path, word: &str) -> Fault {
    let help = match place_of(text, &path).is_some_and(|place| place.is_empty) {
        true => format!("add `{word}: …` below it, indented deeper"),
        false => format!("add `{word}: …`"),
    };
    let message = format!("{} needs the key `{word}`", subject(&path));
    Fault::of_key(path, message, "it is missing here").with_help(help)
}

/// A value of the wrong type or out of its range.
fn invalid(text: &str, path: Path, problem: &str, expected: &str) -> Fault {
    let subject = subject(&path);
    let place = place_of(text, &path);
    let written = place.as_ref().map_or("", |place| place.written(text));
    if expected == "newtype variant" {
        let message = format!("{subject} cannot be the word `{written}` alone");
        return Fault::new(path, message, format!("expected `{written}: …`"));
    }
    if expected == "enum" || expected.starts_with("map ") {
        return not_one_key(path, &subject);
    }
    let found = match place.as_ref().is_some_and(|place| place.is_empty) {
        true => "empty".to_owned(),
        false => found_of(problem, written),
    };
    let fault = Fault::new(
        path,
        format!("{subject} cannot be {found}"),
        format!("expected {}", wanted(expected)),
    );
    let is_type = problem.starts_with("invalid type");
    let is_comment = |place: &Place| place.is_empty && place.is_before_comment(text);
    let help = match expected {
        _ if expected.contains("colour") && place.as_ref().is_some_and(is_comment) => {
            Some("`#` begins a comment: put the colour in quotes".to_owned())
        }
        _ if expected.starts_with("the name") && found.starts_with('`') => {
            Some("a name that looks like a number or a truth value wants quotes".to_owned())
        }
        _ if expected.contains("number") && (is_type || problem.contains(": string ")) => {
            number_meant(written, expected.contains("whole"))
        }
        _ => None,
    };
    Fault { help, ..fault }
}

fn not_one_key(path: Path, subject: &str) -> Fault {
    let is_item = matches!(path.0.last(), Some(Step::Index(_)));
    let fault = Fault::new(
        path,
        format!("{subject} must have exactly one key"),
        "expected one choice, with its own keys below it",
    );
    match is_item {
        true => fault.with_help("begin each item of the list with `- `"),
        false => fault,
    }
}

/// What was found, as it follows the words "cannot be".
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
        // To serde, `1e400` is a text.
        "string" if written.parse::<f64>().is_err() => format!("the text {value}"),
        "string" | "boolean" | "integer" | "floating" if !written.starts_with('*') => {
            format!("`{written}`")
        }
        "boolean" | "integer" => value.to_owned(),
        "floating" => value.replace("point ", ""),
        _ => found.to_owned(),
    }
}

/// What would be right, as it follows the word "expected".
fn wanted(expected: &str) -> String {
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

/// The place of the very value at `path`, none inside an alias.
fn place_of(text: &str, path: &Path) -> Option<Place> {
    position::locate(text, path).filter(|place| place.is_exact)
}

/// "`a`, `b` or `c`" for serde's "one of `a`, `b`, `c`"; anything else as it is.
fn listed(expected: &str) -> String {
    let list = expected.strip_prefix("one of ");
    match list.and_then(|list| list.rsplit_once(", ")) {
        Some((all, last)) => format!("{all} or {last}"),
        None => expected.to_owned(),
    }
}

/// What stands between backquotes.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// The value at the path, as a sentence begins with it.
fn subject(path: &Path) -> String {
    match path.0.is_empty() {
        true => "the scene".to_owned(),
        false => format!("`{path}`"),
    }
}

fn path_of(path: &serde_path_to_error::Path) -> Path {
    Path(
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
