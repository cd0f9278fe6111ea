//! The reference of scene files has every key: its lists are made from the schema.
//!
//! A list stands between `<!-- keys: film -->` and `<!-- /keys -->`, with the paths of one mapping or
//! several: keys, and `*` for any name or item; `scene` for a whole scene and `study` for a whole study. `RAYCOST_BLESS=1 cargo test
//! --test commands reference::` writes the lists anew.

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

/// The paths of all tables.
static SHOWN: LazyLock<BTreeSet<String>> = LazyLock::new(|| {
    let of_page = |text: String| {
        let names = text.split(BEGIN).skip(1);
        let paths = names.flat_map(|part| part.split(" -->").next().unwrap().split(' '));
        paths.map(str::to_owned).collect::<Vec<_>>()
    };
    pages()
        .into_iter()
        .flat_map(|(_, text)| of_page(text))
        .collect()
});

/// Returns the list of the keys of the mappings at these paths. A key has no row if it stands only for keys that are
/// in a table.
fn table(paths: &str) -> String {
    let mut text = "\n".to_owned();
    let paths: Vec<&str> = paths.split(' ').collect();
    let common = common_prefix(&paths);
    // Keys with the same meaning share a row.
    let mut rows: Vec<(String, String)> = Vec::new();
    for path in &paths {
        let found = mappings(path);
        assert!(!found.is_empty(), "the schema has no keys at `{path}`");
        let steps = path.trim_start_matches("scene").split('.').skip(common);
        let below = steps.filter(|name| !name.is_empty() && *name != "*");
        let below: String = below.map(|name| format!("{name}.")).collect();
        for mapping in found {
            for key in keys_of(mapping) {
                let own = match *path {
                    "scene" => key.clone(),
                    path => format!("{path}.{key}"),
                };
                let is_shown = SHOWN.contains(&own) || SHOWN.contains(&format!("{own}.*"));
                if is_shown && stands_for_keys(&mapping["properties"][key]) {
                    continue;
                }
                let meaning = meaning(mapping, key);
                match rows.iter_mut().find(|(_, known)| *known == meaning) {
                    Some((keys, _)) if paths.len() > 1 => {
                        write!(keys, ", `{below}{key}`").unwrap();
                    }
                    _ => rows.push((format!("`{below}{key}`"), meaning)),
                }
            }
        }
    }
    for (keys, meaning) in rows {
        writeln!(text, "- {keys}: {meaning}").unwrap();
    }
    text + "\n"
}

/// Whether a value has no other form than a mapping, or a list of mappings.
fn stands_for_keys(of_key: &Value) -> bool {
    kinds(of_key).into_iter().all(|kind| {
        let is_mapping = |kind: &Value| kind["properties"].is_object() || kind["type"] == "null";
        let items = kinds(&kind["items"]);
        is_mapping(kind) || items.into_iter().all(is_mapping)
    })
}

/// Returns the number of steps with which all paths begin.
fn common_prefix(paths: &[&str]) -> usize {
    let first: Vec<&str> = paths[0].split('.').collect();
    let begins = |n: usize| {
        let is_below = |path: &&str| path.split('.').take(n).eq(first[..n].iter().copied());
        paths.iter().all(is_below)
    };
    (0..=first.len()).rev().find(|n| begins(*n)).unwrap_or(0)
}

/// Returns the value of a key with its default, and what it means, unless the key says that itself.
fn meaning(mapping: &Value, key: &String) -> String {
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
        Value::Null if is_required => Some("required".to_owned()),
        Value::Null => said,
        default if *default == u32::MAX => Some("no limit".to_owned()),
        default => {
            let default = match default {
                Value::String(word) => format!("`{word}`"),
                default => format!("`{default}`").replace(',', ", "),
            };
            said.filter(|said| said.starts_with(&default))
                .or(Some(default))
        }
    };
    let mut value = value(expected);
    let meaning = without_range(&meaning, &value);
    let words = kinds(of_key).into_iter().filter_map(|kind| {
        let word = kind["const"].as_str()?;
        let text = kind["description"].as_str()?.trim_end_matches('.');
        Some(format!("`{word}`: {text}."))
    });
    let words: Vec<String> = words.collect();
    let listed = value.split(", ").flat_map(|words| words.split(" or "));
    let is_explained = |word: &str| {
        words
            .iter()
            .any(|text| text.starts_with(&format!("{word}:")))
    };
    if listed.into_iter().all(is_explained) {
        value = "a choice".to_owned();
    }
    let default = default.map(|default| format!(" ({default})"));
    let value = format!("{value}{}.", default.unwrap_or_default());
    let is_new = meaning.to_lowercase() != format!("the {}.", key.replace('_', " "));
    let meaning = is_new.then_some(meaning);
    let sentences: Vec<String> = [value].into_iter().chain(meaning).chain(words).collect();
    sentences.join(" ").replace('\n', " ")
}

/// Leaves out a range of the meaning that the value states.
fn without_range(meaning: &str, value: &str) -> String {
    let (range, _) = value.split_once(" (").unwrap_or((value, ""));
    let range = range.trim_start_matches("whole, ");
    let range = range.replace("above 0", "greater than 0");
    let joints = [", from ", " from ", ", "];
    let stated = joints.map(|joint| format!("{joint}{range}"));
    let ends = [".", ",", ";", ":"];
    stated.iter().fold(meaning.to_owned(), |text, stated| {
        ends.into_iter().fold(text, |text, end| {
            text.replace(&format!("{stated}{end}"), end)
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
        () if has("boolean") => "boolean",
        () => "text",
    }
}

/// Leaves out bounds that are those of all numbers, says kinds in few words, and marks examples in braces and
/// brackets as code, which Markdown would read otherwise.
fn value(expected: &str) -> String {
    const BOUNDS: [[&str; 2]; 15] = [
        [" (1e-15 to 1e15)", ""],
        [" (at most 1e15)", ""],
        [" (at most 1e20)", ""],
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
        ["a text", "text"],
    ];
    let plain = |text: String, [bounds, words]: [&str; 2]| text.replace(bounds, words);
    let expected = BOUNDS.into_iter().fold(expected.to_owned(), plain);
    let expected = without_noun(expected);
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

/// Leaves out the noun of a range and of an example, which the meaning repeats.
fn without_noun(expected: String) -> String {
    if let Some((_, range)) = expected.rsplit_once(" from ")
        && range.starts_with(|c: char| c.is_ascii_digit() || c == '-')
    {
        return range.to_owned();
    }
    match expected.split_once(" such as ") {
        Some((noun, example)) if !noun.contains([',', '`']) => format!("as {example}"),
        _ => expected,
    }
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
