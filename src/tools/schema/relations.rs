//! Relations of a mapping's keys: required ones, and ones that exclude each other.

use serde_json::{Map, Value, json};

use super::attempt::{Outcome, quoted};

/// Adds to a schema which keys are required and which exclude each other. Returns a mapping with
/// the required ones.
pub(super) fn relations(
    attempt: &dyn Fn(Value) -> Outcome,
    samples: &Map<String, Value>,
    schema: &mut Value,
) -> Map<String, Value> {
    let own_message = |map: &Map<String, Value>| {
        let verdict = attempt(Value::Object(map.clone()));
        verdict.own_message().map(str::to_owned)
    };
    let with = |map: &Map<String, Value>, keys: &[&String]| {
        let added = keys
            .iter()
            .filter_map(|&key| Some((key.clone(), samples.get(key)?.clone())));
        map.clone()
            .into_iter()
            .chain(added)
            .collect::<Map<String, Value>>()
    };
    let mut least = Map::new();
    let mut conditions = Vec::new();
    while let Some(message) = own_message(&least) {
        let lacking = lacking(&message, samples);
        let Some(first) = lacking.iter().find(|key| !least.contains_key(**key)) else {
            break;
        };
        let (before, first) = (least.clone(), *first);
        least = with(&least, &[first]);
        // Keys that can replace the missing one.
        let is_instead = |key: &&String| {
            !before.contains_key(*key)
                && own_message(&with(&before, &[key])).is_none_or(|other| other != message)
        };
        let instead: Vec<&String> = samples.keys().filter(is_instead).collect();
        match instead.as_slice() {
            [one] => conditions.push(json!({ "required": [one] })),
            keys => {
                let keys = keys.iter().map(|key| json!({ "required": [key] }));
                conditions.push(json!({ "anyOf": keys.collect::<Vec<Value>>() }));
            }
        }
    }
    let is_fine = |map: &Map<String, Value>| {
        own_message(map).is_none_or(|message| !message.starts_with("cannot"))
    };
    if is_fine(&least) {
        let fine: Vec<&String> = samples
            .keys()
            .filter(|key| is_fine(&with(&least, &[key])))
            .collect();
        for (i, a) in fine.iter().enumerate() {
            for b in &fine[..i] {
                if !is_fine(&with(&least, &[a, b])) {
                    conditions.push(json!({ "not": { "required": [b, a] } }));
                }
            }
        }
        // Keys that the required keys already exclude.
        let excluded = samples.keys().filter(|key| !is_fine(&with(&least, &[key])));
        for key in excluded {
            for other in least.keys() {
                let mut without = least.clone();
                without.shift_remove(other);
                if *other != *key && own_message(&with(&without, &[key])).is_none() {
                    conditions.push(json!({ "not": { "required": [other, key] } }));
                }
            }
        }
    }
    add_conditions(schema, conditions);
    least
}

/// Returns the keys that a mapping lacks, of which one is enough, by the parser's message.
fn lacking<'k>(message: &str, samples: &'k Map<String, Value>) -> Vec<&'k String> {
    let missing = message.strip_prefix("missing field `");
    let words: Vec<&str> = match missing.and_then(|rest| rest.split('`').next()) {
        Some(key) => vec![key],
        None if message.starts_with("cannot lack") => quoted(message).collect(),
        None => Vec::new(),
    };
    samples
        .keys()
        .filter(|key| words.contains(&key.as_str()))
        .collect()
}

/// Puts the required keys into one list, and other conditions after it.
fn add_conditions(schema: &mut Value, conditions: Vec<Value>) {
    let mut required = Vec::new();
    let mut others = Vec::new();
    for condition in conditions {
        match condition["required"].as_array() {
            Some(keys) => required.extend(keys.iter().cloned()),
            None => others.push(condition),
        }
    }
    if !required.is_empty() {
        schema["required"] = Value::Array(required);
    }
    if !others.is_empty() {
        schema["allOf"] = Value::Array(others);
    }
}
