//! The reference of scene files has every key: its tables are made from the schema.
//!
//! A table stands between `<!-- keys: film -->` and `<!-- /keys -->`, with the paths of one mapping or
//! several: keys, and `*` for any name or item; `scene` for a whole scene and `study` for a whole study. `RAYCOST_BLESS=1 cargo test
//! --test commands reference::` writes the tables anew.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::fs;
use std::sync::LazyLock;

use serde_json::Value;
use tools::schema::SchemaKind;

use crate::book::pages;
use crate::common::in_repository;

static SCENE: LazyLock<Value> = LazyLock::new(|| SchemaKind::Scene.schema());
static STUDY: LazyLock<Value> = LazyLock::new(|| SchemaKind::Study.schema());

const BEGIN: &str = "<!-- keys: ";
const END: &str = "<!-- /keys -->";

#[test]
fn tables_are_those_of_the_schema() {
    let mut stale = Vec::new();
    for (path, text) in pages() {
        let mut parts = text.split(BEGIN);
        let mut now = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let (name, rest) = part.split_once(" -->").unwrap();
            let (_, after) = rest.split_once(END).unwrap();
            let table = table(name);
            write!(now, "{BEGIN}{name} -->\n{table}{END}{after}").unwrap();
        }
        if now != text {
            if std::env::var_os("RAYCOST_BLESS").is_some() {
                fs::write(in_repository(&path), now).unwrap();
            }
            stale.push(path);
        }
    }
    assert!(stale.is_empty(), "{stale:?}: set RAYCOST_BLESS=1");
}

#[test]
fn every_key_is_in_a_table() {
    let pages = pages();
    let names = pages.iter().flat_map(|(_, text)| text.split(BEGIN).skip(1));
    let shown: BTreeSet<Vec<&String>> = names
        .flat_map(|part| part.split(" -->").next().unwrap().split(' '))
        .flat_map(mappings)
        .map(|mapping| keys_of(mapping).collect())
        .collect();
    let mut missing = Vec::new();
    visit(&SCENE, String::new(), &mut |path, mapping| {
        let keys: Vec<&String> = keys_of(mapping).collect();
        if !keys.is_empty() && !shown.contains(&keys) {
            missing.push(path.to_owned());
        }
    });
    assert!(missing.is_empty(), "no table has the keys of {missing:#?}");
}

/// Returns the table of the keys of the mappings at these paths.
fn table(paths: &str) -> String {
    let mut text = "\n| key | value | default | meaning |\n|---|---|---|---|\n".to_owned();
    let is_one = !paths.contains(' ');
    // Keys with the same cells share a row.
    let mut rows: Vec<(String, String)> = Vec::new();
    for path in paths.split(' ') {
        let found = mappings(path);
        assert!(!found.is_empty(), "the schema has no keys at `{path}`");
        let (_, name) = path.rsplit_once('.').unwrap_or_default();
        for mapping in found {
            for key in keys_of(mapping) {
                let shown = if is_one || name == "*" {
                    format!("`{key}`")
                } else {
                    format!("`{name}.{key}`")
                };
                let cells = cells(mapping, key).map(|cell| cell.replace('|', "\\|"));
                let cells = cells.join(" | ");
                match rows.iter_mut().find(|(_, known)| *known == cells) {
                    Some((keys, _)) if !is_one => write!(keys, ", {shown}").unwrap(),
                    _ => rows.push((shown, cells)),
                }
            }
        }
    }
    for (keys, cells) in rows {
        writeln!(text, "| {keys} | {cells} |").unwrap();
    }
    text + "\n"
}

/// Returns the value, the default and the meaning of a key.
fn cells(mapping: &Value, key: &String) -> [String; 3] {
    let of_key = &mapping["properties"][key];
    let description = of_key["description"].as_str().unwrap_or_default();
    let (meaning, expected) = match description.split_once("Expected: ") {
        Some((meaning, expected)) => (meaning, expected.trim_end_matches('.')),
        None => (description, plain_type(of_key)),
    };
    let (meaning, said) = without_default(meaning.trim());
    let required = mapping["required"].as_array();
    let is_required = required.is_some_and(|required| required.iter().any(|name| name == key));
    let default = match &of_key["default"] {
        Value::Null if is_required => "required".to_owned(),
        Value::Null => said.unwrap_or_default(),
        default => {
            let default = match default {
                Value::String(word) => format!("`{word}`"),
                default => format!("`{default}`").replace(',', ", "),
            };
            said.filter(|said| said.starts_with(&default))
                .unwrap_or(default)
        }
    };
    let meaning = without_range(&meaning, expected);
    let words = kinds(of_key).into_iter().filter_map(|kind| {
        let word = kind["const"].as_str()?;
        let text = kind["description"].as_str()?.trim_end_matches('.');
        Some(format!("`{word}`: {text}."))
    });
    let meaning: Vec<String> = [meaning].into_iter().chain(words).collect();
    [
        value(expected),
        default,
        meaning.join(" ").replace('\n', " "),
    ]
}

/// Leaves out a range of the meaning that the value states.
fn without_range(meaning: &str, expected: &str) -> String {
    const RANGES: [[&str; 2]; 4] = [
        [", 0 to 1", "from 0 to 1"],
        [", greater than 0", "greater than 0"],
        [", at least 0", "at least 0"],
        [", 0 to 255", "from 0 to 255"],
    ];
    let (kind, _) = expected.split_once(" (").unwrap_or((expected, ""));
    let stated = RANGES
        .into_iter()
        .filter(|[_, stated]| kind.ends_with(stated));
    stated.fold(meaning.to_owned(), |text, [range, _]| {
        [".", ";", ":"].into_iter().fold(text, |text, end| {
            text.replace(&format!("{range}{end}"), end)
        })
    })
}

/// Returns the type of a value of which the parser says nothing special.
fn plain_type(schema: &Value) -> &str {
    let kinds = kinds(schema);
    let has = |name: &str| kinds.iter().any(|kind| kind["type"] == name);
    match () {
        () if has("object") => "keys",
        () if has("array") => "a list",
        () if has("boolean") => "`true` or `false`",
        () => "text",
    }
}

/// Leaves out bounds that are those of all numbers, says kinds in few words, and marks examples in braces and
/// brackets as code, which Markdown would read otherwise.
fn value(expected: &str) -> String {
    const BOUNDS: [[&str; 2]; 13] = [
        [" (1e-15 to 1e15)", ""],
        [" (at most 1e15)", ""],
        [" from -1e15 to 1e15", ""],
        ["from 0 to 18446744073709551615", "of at least 0"],
        ["from 0 to 4294967295", "of at least 0"],
        [
            "a color: [r, g, b], \"#rrggbb\" or one number for a gray",
            "a color",
        ],
        ["a number from ", ""],
        ["a whole number from ", "whole, "],
        ["a number greater than ", "above "],
        ["a number of at least ", "at least "],
        ["a whole number of at least ", "whole, at least "],
        ["a point [", "["],
        ["a direction [", "["],
    ];
    let plain = |text: String, [bounds, words]: [&str; 2]| text.replace(bounds, words);
    let expected = BOUNDS.into_iter().fold(expected.to_owned(), plain);
    let mut text = String::new();
    let mut depth = 0;
    for c in expected.chars() {
        let (opens, closes) = ("{[".contains(c), "}]".contains(c));
        if opens && depth == 0 {
            text.push('`');
        }
        text.push(c);
        depth += i32::from(opens) - i32::from(closes);
        if closes && depth == 0 {
            text.push('`');
        }
    }
    text
}

/// Splits a doc comment into its meaning and the default that it states at its end.
fn without_default(meaning: &str) -> (String, Option<String>) {
    let stated = ["; ", ". "].into_iter().find_map(|separator| {
        let (meaning, end) = meaning.rsplit_once(separator)?;
        let end = end.trim_end_matches('.');
        let default = end
            .strip_suffix(" if not given")
            .or(end.strip_suffix(" by default"))?
            .trim_end_matches(',');
        Some((format!("{meaning}."), Some(default.to_owned())))
    });
    stated.unwrap_or_else(|| (meaning.to_owned(), None))
}

/// Returns the mappings at a path of keys, and `*` for any name or item.
fn mappings(path: &str) -> Vec<&'static Value> {
    let (schema, path) = match path.strip_prefix("study") {
        Some(path) => (&*STUDY, path.trim_start_matches('.')),
        None => (&*SCENE, path.strip_prefix("scene").unwrap_or(path)),
    };
    let mut found = vec![schema];
    for key in path.split('.').filter(|key| !key.is_empty()) {
        let below = found
            .iter()
            .flat_map(|schema| kinds(schema))
            .flat_map(|kind| {
                let steps = match key {
                    "*" => vec![&kind["additionalProperties"], &kind["items"]],
                    key => vec![&kind["properties"][key]],
                };
                steps.into_iter().filter(|step| step.is_object())
            });
        found = below.collect();
    }
    let kinds = found.into_iter().flat_map(kinds);
    kinds
        .filter(|kind| kind["properties"].is_object())
        .collect()
}

fn kinds(schema: &Value) -> Vec<&Value> {
    match schema["anyOf"].as_array() {
        Some(kinds) => kinds.iter().flat_map(self::kinds).collect(),
        None => vec![schema],
    }
}

fn keys_of(mapping: &Value) -> impl Iterator<Item = &String> {
    mapping["properties"]
        .as_object()
        .into_iter()
        .flatten()
        .map(|(key, _)| key)
}

/// Calls `each` with every mapping below a schema, and its path.
fn visit<'s>(schema: &'s Value, path: String, each: &mut impl FnMut(&str, &'s Value)) {
    for kind in kinds(schema) {
        each(&path, kind);
        let steps = [&kind["additionalProperties"], &kind["items"]];
        for step in steps.into_iter().filter(|step| step.is_object()) {
            visit(step, format!("{path}.*"), each);
        }
        for key in keys_of(kind) {
            visit(&kind["properties"][key], format!("{path}.{key}"), each);
        }
    }
}
