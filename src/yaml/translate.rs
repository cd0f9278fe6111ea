//! serde's messages → faults in the user's words.
//!
//! The shapes of serde's own messages ("unknown field `x`, expected one of …",
//! "invalid type: string "x", expected …") are part of its documented `Error`
//! trait's default methods; whatever fits none of them is shown as it is.

use serde_path_to_error::Segment;

use super::diagnostic::{Fault, did_you_mean};
use super::position::{Path, Step};

/// The fault that serde_yaml found in `text`.
pub(super) fn fault(
    text: &str,
    path: &serde_path_to_error::Path,
    error: &serde_yaml::Error,
) -> Fault {
    let path = path_of(path);
    let message = message_of(error);
    let (problem, expected) = message.split_once(", expected ").unwrap_or((&message, ""));
    let word = quoted(problem).next().unwrap_or_default().to_owned();

    if problem.starts_with("unknown field") {
        let fault = Fault::new(
            path.key(&word),
            format!("unknown key `{word}`"),
            "no such key here",
        );
        return with_choices(fault.at_key(), &word, expected);
    }
    if problem.starts_with("unknown variant") {
        let label = format!("expected {}", choices(expected));
        let fault = Fault::new(path.key(&word), format!("unknown choice `{word}`"), label);
        return with_choices(fault.at_key(), &word, expected);
    }
    if problem.starts_with("missing field") {
        let owner = owner_of(&path);
        return Fault::new(
            path,
            format!("{owner} needs the key `{word}`"),
            "it is missing here",
        )
        .with_help(format!("add `{word}: …`"))
        .at_key();
    }
    if expected.is_empty() {
        let fault = Fault::new(path, message.clone(), "");
        return match error.location() {
            Some(place) if fault.path.0.is_empty() => Fault {
                span: Some(place.index().min(text.len())..place.index().min(text.len())),
                ..fault
            },
            _ => fault,
        };
    }
    let found = found_of(problem);
    let subject = match path.0.is_empty() {
        true => "the scene".to_owned(),
        false => format!("`{path}`"),
    };
    Fault::new(
        path,
        format!("{subject} cannot be {found}"),
        format!("expected {}", choices(expected)),
    )
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
    const STARTS: [&str; 6] = [
        "unknown field ",
        "unknown variant ",
        "missing field ",
        "invalid type: ",
        "invalid value: ",
        "invalid length ",
    ];
    match STARTS.iter().filter_map(|start| message.find(start)).min() {
        Some(begin) => message.split_off(begin),
        None => message,
    }
}

fn with_choices(fault: Fault, word: &str, expected: &str) -> Fault {
    let help = match did_you_mean(word, quoted(expected)) {
        Some(suggestion) => format!("{suggestion} (the choices are {})", choices(expected)),
        None => format!("the choices are {}", choices(expected)),
    };
    fault.with_help(help)
}

/// "one of `a`, `b`" without serde's "one of" and "there are no fields".
fn choices(expected: &str) -> String {
    expected
        .strip_prefix("one of ")
        .unwrap_or(expected)
        .to_owned()
}

/// What stands between backquotes.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// "invalid type: string "x"" → "the text "x"".
fn found_of(problem: &str) -> String {
    if let Some(n) = problem.strip_prefix("invalid length ") {
        return format!("a list of {n}");
    }
    let found = problem.split_once(": ").map_or(problem, |(_, found)| found);
    const WORDS: [(&str, &str); 6] = [
        ("string ", "the text "),
        ("floating point ", ""),
        ("integer ", ""),
        ("boolean ", ""),
        ("sequence", "a list"),
        ("unit value", "empty"),
    ];
    for (serde_word, word) in WORDS {
        if let Some(rest) = found.strip_prefix(serde_word) {
            return format!("{word}{rest}");
        }
    }
    match found {
        "map" => "a mapping of keys".to_owned(),
        other => other.to_owned(),
    }
}

/// The thing that lacks a key, as its last keys name it.
fn owner_of(path: &Path) -> String {
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
