//! The defaults of optional keys: the values that, when written, change nothing.

use std::fmt::Debug;

use serde_json::{Map, Value, json};

use scene::yaml::YamlFile;

/// The key of a schema under which the [`Explorer`](super::explorer::Explorer) leaves an accepted
/// value; [`add_defaults`] removes it.
pub(super) const SAMPLE: &str = "examples";

/// Numbers that are tried, to see where the parsed file shows them.
const NUMBERS: [f64; 7] = [0.0, 1.0, 2.0, 0.5, 0.1, 7.0, 200.0];
/// Vectors that are tried.
const VECTORS: [[f64; 3]; 3] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
/// Longest text of a number that is a default. Longer ones are computed from other values.
const MAX_LENGTH: usize = 6;

/// Puts a value of a schema into a whole file.
type IntoFile<'a> = &'a dyn Fn(Value) -> Value;

/// Adds its default to each optional key of the files that a `T` is read from, if a value can be
/// written that means the same as leaving the key out.
pub(super) fn add_defaults<T: YamlFile + Debug + PartialEq>(root: &mut Value) {
    visit::<T>(root, &|value| value);
}

fn visit<T: YamlFile + Debug + PartialEq>(schema: &mut Value, in_file: IntoFile) {
    let Value::Object(keywords) = schema else {
        return;
    };
    let sample = keywords.shift_remove(SAMPLE).unwrap_or_default();
    let is_choice = keywords.contains_key("maxProperties");
    for (keyword, value) in keywords.iter_mut() {
        match (keyword.as_str(), value) {
            ("anyOf", Value::Array(kinds)) => {
                kinds.iter_mut().for_each(|kind| visit::<T>(kind, in_file));
            }
            ("items", items) => visit::<T>(items, &|item| {
                let mut list = sample.as_array().cloned().unwrap_or_default();
                list.truncate(list.len().max(1));
                match list.first_mut() {
                    Some(first) => *first = item,
                    None => list.push(item),
                }
                in_file(Value::Array(list))
            }),
            ("additionalProperties", values) => {
                visit::<T>(values, &|value| in_file(json!({ "a": value })));
            }
            ("patternProperties", Value::Object(patterns)) => {
                let with = |value| in_file(json!({ "a.b": value }));
                patterns
                    .values_mut()
                    .for_each(|values| visit::<T>(values, &with));
            }
            ("properties", Value::Object(properties)) => {
                let others = match &sample {
                    Value::Object(sample) if !is_choice => sample.clone(),
                    _ => Map::new(),
                };
                for (key, of_key) in properties {
                    let without = others_of::<T>(key, of_key, &others, in_file);
                    let with = |value: Value| {
                        let mut map = without.clone();
                        map.insert(key.clone(), value);
                        in_file(Value::Object(map))
                    };
                    let without = in_file(Value::Object(without.clone()));
                    let default = default_of::<T>(of_key, &with, without);
                    visit::<T>(of_key, &with);
                    if let (Some(default), Value::Object(of_key)) = (default, of_key) {
                        of_key.insert("default".to_owned(), default);
                    }
                }
            }
            _ => {}
        }
    }
}

/// Parses a file.
fn parsed<T: YamlFile>(file: &Value) -> Option<T> {
    T::from_yaml(&file.to_string()).ok()
}

/// Returns the other keys of a mapping that has a key: those of the sample, but for one that
/// excludes the key.
fn others_of<T: YamlFile>(
    key: &str,
    of_key: &Value,
    sample: &Map<String, Value>,
    in_file: IntoFile,
) -> Map<String, Value> {
    let but_for = |left_out: &str| {
        let mut others = sample.clone();
        others.shift_remove(key);
        others.shift_remove(left_out);
        others
    };
    let is_accepted = |others: &Map<String, Value>| {
        let mut map = others.clone();
        map.insert(key.to_owned(), of_key[SAMPLE].clone());
        parsed::<T>(&in_file(Value::Object(map))).is_some()
    };
    let left_out = [key].into_iter().chain(sample.keys().map(String::as_str));
    let mut choices = left_out.map(but_for);
    choices.find(is_accepted).unwrap_or_else(|| but_for(key))
}

/// Returns the value that means the same in a file as leaving its key out. Returns `None` if no
/// value is found, or if all that are tried mean the same.
fn default_of<T: YamlFile + Debug + PartialEq>(
    schema: &Value,
    with: IntoFile,
    without: Value,
) -> Option<Value> {
    let absent: T = parsed(&without)?;
    let mut default = None;
    let mut others = Vec::new();
    for value in samples(schema) {
        match parsed::<T>(&with(value.clone())) {
            Some(same) if same == absent => default = default.or(Some(value)),
            other => others.extend(other),
        }
    }
    if others.is_empty() || default.is_some() {
        return default.filter(|_| !others.is_empty());
    }
    // The numbers that stand in the place of a sample's.
    let text = format!("{absent:?}");
    let numbers = others
        .iter()
        .map(|other| numbers_instead(&text, &format!("{other:?}")));
    let numbers = numbers.flat_map(|numbers| {
        let degrees = numbers
            .iter()
            .map(|x| json!((x.to_degrees() * 1e4).round() / 1e4));
        let each = numbers.iter().map(|&x| in_short(x)).chain(degrees);
        let list = Value::Array(numbers.iter().map(|&x| in_short(x)).collect());
        each.chain([list]).collect::<Vec<Value>>()
    });
    let is_short = |value: &Value| !value.is_number() || value.to_string().len() <= MAX_LENGTH;
    let is_default = |value: &Value| parsed::<T>(&with(value.clone())).as_ref() == Some(&absent);
    numbers.filter(is_short).find(is_default)
}

/// Returns values of a schema without mappings.
fn samples(schema: &Value) -> Vec<Value> {
    if let Some(kinds) = schema["anyOf"].as_array() {
        return kinds.iter().flat_map(samples).collect();
    }
    let words = schema["enum"].as_array().into_iter().flatten();
    let words = words.chain(schema.get("const")).cloned();
    let of_type: Vec<Value> = match schema["type"].as_str() {
        Some("boolean") => vec![json!(true), json!(false)],
        Some("number" | "integer") => NUMBERS.map(in_short).to_vec(),
        Some("array") => {
            let vectors = VECTORS.map(|vector| vector.map(in_short).to_vec().into());
            [json!([]), schema[SAMPLE].clone()]
                .into_iter()
                .chain(vectors)
                .collect()
        }
        _ => Vec::new(),
    };
    words.chain(of_type).collect()
}

/// Returns the numbers of a text from where it begins to differ from another to where it ends.
fn numbers_instead(text: &str, other: &str) -> Vec<f64> {
    let is_number = |c: char| c.is_ascii_alphanumeric() || ".-+_".contains(c);
    let n_equal = |a: &mut dyn Iterator<Item = char>, b: &mut dyn Iterator<Item = char>| -> usize {
        let equal = a.zip(b).take_while(|(a, b)| a == b);
        equal.map(|(a, _)| a.len_utf8()).sum()
    };
    let n_before = n_equal(&mut text.chars(), &mut other.chars());
    let n_after = n_equal(&mut text.chars().rev(), &mut other.chars().rev());
    let begin = text[..n_before].trim_end_matches(is_number).len();
    let rest = text[text.len() - n_after..].trim_start_matches(is_number);
    let end = (text.len() - rest.len()).max(begin);
    let words = text[begin..end].split(|c| !is_number(c));
    let numbers = words.filter_map(|word| word.parse().ok());
    numbers.filter(|x: &f64| x.is_finite()).collect()
}

/// Returns the shortest number that a single-precision one is read from.
fn in_short(x: f64) -> Value {
    let single = (x as f32).to_string().parse();
    super::numbers::short(single.unwrap_or(x))
}
