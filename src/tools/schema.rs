//! The JSON Schemas of scene files and studies, which editors use to complete and check them.
//!
//! The types of the settings have schemas, with their doc comments, ranges and defaults. They are
//! put into one form here: a choice of keys is one mapping, a description is one paragraph and
//! what messages expect, and defaults are as short as in a file.

use schemars::generate::SchemaSettings;
use schemars::transform::transform_subschemas;
use schemars::{JsonSchema, Schema};
use serde_json::{Map, Value, json};

use crate::study::StudyPlan;
use base::keywords;
use scene::config::Config;

keywords! {
    /// A kind of file that has a schema.
    #[derive(Default)]
    pub enum SchemaKind {
        /// A scene
        #[default]
        Scene = "scene",
        /// A file that scenes include
        Part = "part",
        /// A study
        Study = "study",
    }
}

impl SchemaKind {
    /// Returns the JSON Schema of such files.
    pub fn schema(self) -> Value {
        let mut schema = match self {
            Self::Scene => generate::<Config>("a scene of raycost"),
            Self::Part => generate::<Config>("a part of a scene of raycost"),
            Self::Study => return generate::<StudyPlan>("a study of raycost"),
        };
        // Included files may have the other sections.
        let required = schema
            .as_object_mut()
            .and_then(|schema| schema.shift_remove("required"));
        if self == Self::Scene {
            schema["if"] = json!({ "required": ["include"] });
            schema["else"] = json!({ "required": required });
        }
        schema
    }
}

/// Returns the JSON Schema of the files that a `T` is read from.
fn generate<T: JsonSchema>(title: &str) -> Value {
    let mut settings = SchemaSettings::draft2020_12().for_deserialize();
    settings.inline_subschemas = true;
    let mut schema = settings.into_generator().into_root_schema_for::<T>();
    join_alternatives(&mut schema);
    describe(&mut schema);
    let keywords = schema.ensure_object();
    keywords.insert("title".to_owned(), title.into());
    leave_out_notes(keywords);
    schema.into()
}

/// Makes `anyOf` of `oneOf`, without alternatives in it: mappings with a single key become one
/// mapping, and join the keys beside them. Leaves out null, which means the same as no key.
fn join_alternatives(schema: &mut Schema) {
    transform_subschemas(&mut join_alternatives, schema);
    let Some(keywords) = schema.as_object_mut() else {
        return;
    };
    for keyword in ["type", "enum"] {
        if let Some(Value::Array(kinds)) = keywords.get_mut(keyword) {
            kinds.retain(|kind| *kind != json!("null") && !kind.is_null());
            if let ("type", [only]) = (keyword, kinds.as_slice()) {
                let only = only.clone();
                keywords.insert(keyword.to_owned(), only);
            }
        }
    }
    let alternatives = keywords.shift_remove("oneOf");
    let Some(Value::Array(mut kinds)) = alternatives.or(keywords.shift_remove("anyOf")) else {
        return;
    };
    kinds.retain(|kind| kind["type"] != "null");
    if kinds.len() > 1 {
        let flat = kinds
            .into_iter()
            .flat_map(|mut kind| match kind.get_mut("anyOf") {
                Some(Value::Array(kinds)) => std::mem::take(kinds),
                _ => vec![kind],
            });
        let (choices, others): (Vec<Value>, Vec<Value>) = flat.partition(is_choice);
        kinds = others;
        if choices.len() > 1 {
            kinds.push(joined(choices));
        } else {
            kinds.extend(choices);
        }
    }
    match <[Value; 1]>::try_from(kinds) {
        Ok([Value::Object(only)]) if keywords.contains_key("properties") => {
            add_choice(keywords, only)
        }
        Ok([Value::Object(only)]) => {
            for (keyword, value) in only {
                keywords.entry(keyword).or_insert(value);
            }
        }
        Ok(_) => {}
        Err(kinds) => drop(keywords.insert("anyOf".to_owned(), kinds.into())),
    }
}

/// Returns true for a mapping with exactly one key.
fn is_choice(kind: &Value) -> bool {
    let properties = kind["properties"].as_object();
    kind["maxProperties"] == 1 || properties.is_some_and(|keys| keys.len() == 1)
}

/// Adds the keys of a choice to a mapping with other keys.
fn add_choice(keywords: &mut Map<String, Value>, mut choice: Map<String, Value>) {
    let Some(Value::Object(mut properties)) = choice.shift_remove("properties") else {
        return;
    };
    let each = properties.keys().map(|key| json!({ "required": [key] }));
    let needed = json!({ "anyOf": each.collect::<Vec<Value>>() });
    if let Some(all) = keywords.entry("allOf").or_insert(json!([])).as_array_mut() {
        all.push(needed);
    }
    if let Some(Value::Object(others)) = keywords.shift_remove("properties") {
        properties.extend(others);
    }
    keywords.shift_remove("unevaluatedProperties");
    keywords.insert("properties".to_owned(), properties.into());
    keywords.insert("additionalProperties".to_owned(), false.into());
}

/// Returns a mapping with exactly one of the keys of some mappings.
fn joined(choices: Vec<Value>) -> Value {
    let mut properties = Map::new();
    for mut choice in choices {
        let description = choice["description"].take();
        let is_joined = choice["maxProperties"] == 1;
        for (key, property) in choice["properties"].as_object_mut().into_iter().flatten() {
            if description.is_string() && !is_joined {
                property["description"] = description.clone();
            }
            properties.insert(key.clone(), property.take());
        }
    }
    json!({
        "type": "object", "properties": properties, "additionalProperties": false,
        "minProperties": 1, "maxProperties": 1,
    })
}

/// Describes the keys and the keywords, and nothing else.
fn describe(schema: &mut Schema) {
    transform_subschemas(&mut describe, schema);
    let Some(keywords) = schema.as_object_mut() else {
        return;
    };
    keywords.shift_remove("format");
    for keyword in ["minimum", "maximum", "const"] {
        if let Some(number) = keywords.get_mut(keyword) {
            shorten(number);
        }
    }
    let is_plain = |keyword: &str| keyword == "type" || keyword == "maxLength" || is_note(keyword);
    if keywords.get("type") == Some(&json!("string")) && keywords.keys().all(|key| is_plain(key)) {
        // A scalar of any kind is read as a text.
        keywords.insert("type".to_owned(), json!(["string", "number", "boolean"]));
    }
    for (keyword, below) in keywords {
        match (keyword.as_str(), below) {
            ("properties", Value::Object(properties)) => {
                for property in properties.values_mut().filter_map(Value::as_object_mut) {
                    describe_key(property);
                    shorten_default(property);
                }
            }
            ("items" | "additionalProperties", Value::Object(value)) => leave_out_notes(value),
            ("anyOf", Value::Array(kinds)) => {
                for kind in kinds.iter_mut().filter_map(Value::as_object_mut) {
                    if !kind.contains_key("const") {
                        leave_out_notes(kind);
                    } else if let Some(Value::String(doc)) = kind.get_mut("description") {
                        *doc = paragraph(doc);
                    }
                }
            }
            _ => {}
        }
    }
}

/// Joins the doc comment of a key, and what messages expect of its value.
fn describe_key(property: &mut Map<String, Value>) {
    let doc = property.shift_remove("description");
    let doc = doc.as_ref().and_then(Value::as_str).map(paragraph);
    let expected = property.shift_remove("expected");
    let expected = expected.and_then(|text| Some(text.as_str()?.to_owned()));
    let expected = expected.or_else(|| words(property.get("anyOf")?.as_array()?));
    let expected = expected.map(|text| format!("Expected: {text}."));
    let parts: Vec<String> = doc.into_iter().chain(expected).collect();
    property.shift_insert(0, "description".to_owned(), parts.join("\n\n").into());
}

/// Lists keywords, as in "`a`, `b` or `c`"; `None` if there are other values.
fn words(kinds: &[Value]) -> Option<String> {
    let word = |kind: &Value| Some(format!("`{}`", kind["const"].as_str()?));
    let words: Vec<String> = kinds.iter().map(word).collect::<Option<_>>()?;
    let (last, others) = words.split_last()?;
    Some(format!("{} or {last}", others.join(", ")))
}

/// Returns a doc comment as one paragraph up to its first example, without links.
fn paragraph(doc: &str) -> String {
    let lines = doc.lines().take_while(|line| !line.starts_with("```"));
    let lines: Vec<&str> = lines.filter(|line| !line.is_empty()).collect();
    let mut parts = lines
        .join(" ")
        .split("[`")
        .map(str::to_owned)
        .collect::<Vec<_>>();
    for part in &mut parts[1..] {
        if let Some((name, rest)) = part.split_once("`]") {
            let address = rest.strip_prefix('(').and_then(|rest| rest.split_once(')'));
            *part = format!("{name}`{}", address.map_or(rest, |(_, rest)| rest));
        }
    }
    parts.join("`")
}

/// Writes a default as short as in a file; leaves out the default of a mapping, which its keys
/// have, and an empty list that a file cannot have.
fn shorten_default(property: &mut Map<String, Value>) {
    let kinds = property.get("anyOf").and_then(Value::as_array);
    let is_number = |kind: &Value| kind["type"] == "number";
    let may_be_number = kinds.is_some_and(|kinds| kinds.iter().any(is_number));
    let may_be_empty = !property.contains_key("minItems");
    let Some(mut default) = property.shift_remove("default") else {
        return;
    };
    let round = |number: &mut Value| {
        if let Some(x) = number.as_f64().filter(|_| number.is_f64()) {
            *number = (x as f32)
                .to_string()
                .parse()
                .map_or(Value::Null, |x: f64| json!(x));
        }
        shorten(number);
    };
    match &mut default {
        Value::Array(list) => {
            list.iter_mut().for_each(round);
            match list.as_slice() {
                [] if !may_be_empty => return,
                [first, others @ ..] if may_be_number && others.iter().all(|x| x == first) => {
                    default = first.clone();
                }
                _ => {}
            }
        }
        Value::Null | Value::Object(_) => return,
        number => round(number),
    }
    property.insert("default".to_owned(), default);
}

/// Writes a number without a fraction as an integer.
fn shorten(number: &mut Value) {
    if let Some(x) = number
        .as_f64()
        .filter(|x| number.is_f64() && x.fract() == 0.0 && x.abs() <= 1e15)
    {
        *number = json!(x as i64);
    }
}

fn is_note(keyword: &str) -> bool {
    ["description", "expected", "default"].contains(&keyword)
}

/// Removes the description of a value that is not a key's.
fn leave_out_notes(keywords: &mut Map<String, Value>) {
    keywords.retain(|keyword, _| !is_note(keyword));
}
