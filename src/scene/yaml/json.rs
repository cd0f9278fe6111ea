//! Values → JSON → YAML.

use serde::Serialize;
use serde_json::{Map, Number, Value};

/// Quotes a text for YAML, which lacks some characters that JSON has in its strings, or ends a line
/// at them: they are escaped.
pub fn quoted(text: &str) -> String {
    let mut yaml = String::with_capacity(text.len() + 2);
    for c in Value::from(text).to_string().chars() {
        match c {
            '\u{7f}'..='\u{9f}'
            | '\u{2028}'
            | '\u{2029}'
            | '\u{feff}'
            | '\u{fffe}'
            | '\u{ffff}' => {
                yaml += &format!("\\u{:04x}", u32::from(c));
            }
            c => yaml.push(c),
        }
    }
    yaml
}

/// Converts a value to JSON; numbers of 32 bits become their shortest decimals.
///
/// # Errors
/// The value has no JSON, such as a path that is not UTF-8.
pub fn json_of(value: &impl Serialize) -> serde_json::Result<Value> {
    serde_json::from_str(&serde_json::to_string(value)?)
}

/// Columns of the longest mapping or list in one line.
const WIDTH: usize = 88;

/// Formats a value as YAML, as people write scenes: mappings and lists that are short and have no
/// mappings in them in one line each. Leaves out keys without a value.
pub fn to_yaml(value: &Value) -> String {
    let mut yaml = block(value).join("\n");
    yaml.push('\n');
    yaml
}

/// Returns the lines of a value.
fn block(value: &Value) -> Vec<String> {
    match value {
        Value::Object(map) => given(map)
            .flat_map(|(key, value)| entry(key, value))
            .collect(),
        Value::Array(list) => list.iter().flat_map(item).collect(),
        scalar => vec![line(scalar)],
    }
}

fn entry(key: &str, value: &Value) -> Vec<String> {
    let key = text(key);
    match short_line(value) {
        Some(line) => vec![format!("{key}: {line}")],
        None => {
            let lines = block(value).into_iter().map(|line| format!("  {line}"));
            std::iter::once(format!("{key}:")).chain(lines).collect()
        }
    }
}

fn item(value: &Value) -> Vec<String> {
    let lines = short_line(value).map_or_else(|| block(value), |line| vec![line]);
    let first_or_other = |(i, line)| match i {
        0 => format!("- {line}"),
        _ => format!("  {line}"),
    };
    lines.into_iter().enumerate().map(first_or_other).collect()
}

/// Returns the value in one line, if it is short and has no mapping inside another value.
fn short_line(value: &Value) -> Option<String> {
    let is_flat = |inner: &Value| !has_mapping(inner);
    let fits = match value {
        Value::Object(map) => map.values().all(is_flat),
        inner => is_flat(inner),
    };
    fits.then(|| line(value)).filter(|line| line.len() <= WIDTH)
}

fn has_mapping(value: &Value) -> bool {
    match value {
        Value::Object(_) => true,
        Value::Array(list) => list.iter().any(has_mapping),
        _ => false,
    }
}

/// Returns the value in one line.
fn line(value: &Value) -> String {
    match value {
        Value::Object(map) if given(map).next().is_none() => "{}".to_owned(),
        Value::Object(map) => {
            let keys = given(map).map(|(key, value)| format!("{}: {}", text(key), line(value)));
            format!("{{ {} }}", keys.collect::<Vec<_>>().join(", "))
        }
        Value::Array(list) => {
            let items: Vec<String> = list.iter().map(line).collect();
            format!("[{}]", items.join(", "))
        }
        Value::String(word) => text(word),
        Value::Number(number) => short_number(number),
        Value::Null | Value::Bool(_) => value.to_string(),
    }
}

fn given(map: &Map<String, Value>) -> impl Iterator<Item = (&String, &Value)> {
    map.iter().filter(|(_, value)| !value.is_null())
}

/// Returns a number without `.0`, except for negative zero.
fn short_number(number: &Number) -> String {
    let text = number.to_string();
    match text.strip_suffix(".0") {
        Some(whole) if whole != "-0" => whole.to_owned(),
        _ => text,
    }
}

/// Returns a text, in quotes unless it is words without a meaning in YAML.
fn text(text: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || " _./-".contains(c);
    let is_words = text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.chars().all(is_plain)
        && !text.ends_with(' ');
    let has_meaning = ["true", "false", "null", "yes", "no", "on", "off", "y", "n"]
        .iter()
        .any(|word| text.eq_ignore_ascii_case(word));
    if is_words && !has_meaning {
        text.to_owned()
    } else {
        quoted(text)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn values_are_written_as_people_write_scenes() {
        let scene = json!({
            "image": { "width": 4, "fog": null, "filter_radius": 0.1_f64 },
            "objects": [
                { "sphere": { "center": [0, -0.0, 1e30], "radius": 1.5 }, "name": "yes" },
                { "name": "a: b", "transform": [] },
            ],
            "lists": [[1, 2], ["on top", "#fff"]],
        });
        let expected = r##"image: { width: 4, filter_radius: 0.1 }
objects:
  - sphere: { center: [0, -0.0, 1e+30], radius: 1.5 }
    name: "yes"
  - { name: "a: b", transform: [] }
lists: [[1, 2], [on top, "#fff"]]
"##;
        assert_eq!(to_yaml(&scene), expected);
        let read: Value = serde_yaml::from_str(&to_yaml(&scene)).unwrap();
        assert_eq!(read["objects"], scene["objects"]);
        assert_eq!(read["lists"], scene["lists"]);
    }
}
