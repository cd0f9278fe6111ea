//! Explores which values the parser accepts at each path of a file.

use std::collections::HashMap;
use std::marker::PhantomData;

use serde_json::{Map, Value, json};

use super::attempt::{Outcome, attempt, quoted};
use super::defaults::SAMPLE;
use super::doc_comments;
use super::numbers::{self, any_of};
use super::relations::relations;
use base::Keyword;
use scene::config::{PixelArray, RatioMetric};
use scene::yaml::{Step, YamlFile};
use world::values::MAX_NAME;

/// A word that is neither a key nor a keyword.
const UNKNOWN: &str = "zzz";
/// A ratio that a metric may be.
const RATIO: &str = "primitive_tests / rays";
/// Longest path that is explored.
const MAX_DEPTH: usize = 12;
/// Longest list that is tried.
const MAX_ITEMS: usize = 8;

/// The values that are accepted at a path.
#[derive(Debug, Clone)]
struct Accepted {
    schema: Value,
    /// Some accepted values; none for a recursive value.
    samples: Vec<Value>,
}

/// Explores the files that a `T` is read from.
pub(super) struct Explorer<T> {
    /// The steps to the value that is explored.
    path: Vec<Step>,
    /// A JSON pointer to the value's schema.
    pointer: String,
    /// The keys of the mappings around the value, and pointers to their schemas.
    around: Vec<(Vec<String>, String)>,
    /// Results where the parser expected the same.
    numbers: HashMap<String, Option<Accepted>>,
    file: PhantomData<T>,
}

impl<T: YamlFile> Explorer<T> {
    /// Starts without knowledge.
    pub(super) fn new() -> Self {
        Self {
            path: Vec::new(),
            pointer: "#".to_owned(),
            around: Vec::new(),
            numbers: HashMap::new(),
            file: PhantomData,
        }
    }

    /// Returns the schema of the whole file.
    pub(super) fn explore_all(mut self) -> Value {
        self.explore().map_or(json!({}), |accepted| accepted.schema)
    }

    fn attempt(&self, value: Value) -> Outcome {
        attempt::<T>(&self.path, value)
    }

    /// Finds the values that are accepted at the path. Returns `None` if there are none.
    fn explore(&mut self) -> Option<Accepted> {
        if self.path.len() > MAX_DEPTH {
            return None;
        }
        let anything = [
            json!(UNKNOWN),
            json!([{ UNKNOWN: [] }]),
            json!({ UNKNOWN: [0] }),
        ];
        if anything
            .into_iter()
            .all(|value| self.attempt(value).is_accepted())
        {
            let (schema, samples) = (json!({}), vec![json!(1)]);
            return Some(Accepted { schema, samples });
        }
        let mapping = self.mapping();
        let text = self.text();
        // Any scalar that is read as a text needs no other schema.
        let is_any_scalar = text
            .as_ref()
            .is_some_and(|text| text.schema["type"].is_array());
        let kinds = if is_any_scalar {
            [text, None, self.list(), mapping, None]
        } else {
            [text, self.number(), self.list(), mapping, self.boolean()]
        };
        let found: Vec<Accepted> = kinds.into_iter().flatten().collect();
        let schemas: Vec<Value> = found.iter().map(|kind| kind.schema.clone()).collect();
        (!schemas.is_empty()).then(|| Accepted {
            schema: any_of(schemas),
            samples: found.into_iter().flat_map(|kind| kind.samples).collect(),
        })
    }

    /// Explores the value one step below.
    fn below(&mut self, step: Step, pointer: &str) -> Option<Accepted> {
        let n = self.pointer.len();
        self.pointer.push_str(pointer);
        self.path.push(step);
        let found = self.explore();
        self.path.pop();
        self.pointer.truncate(n);
        found
    }

    /// Returns the values that the parser says it expects.
    fn expected(&self) -> Option<String> {
        let values = [json!(true), json!([]), json!(0.5)];
        let expected = |value| {
            let verdict = self.attempt(value);
            let (problem, expected) = verdict.own_message()?.rsplit_once(", expected ")?;
            problem.starts_with("invalid").then(|| expected.to_owned())
        };
        values.into_iter().find_map(expected)
    }

    fn text(&self) -> Option<Accepted> {
        let verdict = self.attempt(json!(UNKNOWN));
        if verdict.is_accepted() {
            let mut schema = json!({ "type": "string" });
            if self.attempt(json!(0.5)).is_accepted() {
                // A scalar of any kind is read as a text.
                schema["type"] = json!(["string", "number", "boolean"]);
            }
            let of_length = |n| json!("n".repeat(n));
            if !self.attempt(of_length(MAX_NAME + 1)).is_accepted() {
                schema["maxLength"] = json!(MAX_NAME);
            }
            let samples = vec![json!("a")];
            return Some(Accepted { schema, samples });
        }
        let message = verdict.message().unwrap_or_default();
        let words = quoted(message).filter(|word| self.attempt(json!(word)).is_accepted());
        let words: Vec<String> = words.map(str::to_owned).collect();
        let mut schemas = keywords(&words);
        let mut samples: Vec<Value> = words.into_iter().map(Value::from).collect();
        if self.attempt(json!("#12aBeF")).is_accepted() {
            schemas.push(json!({ "type": "string", "pattern": "^#[0-9a-fA-F]{6}$" }));
            samples.push(json!("#12abef"));
        }
        if self.attempt(json!(RATIO)).is_accepted() {
            let costs: Vec<&str> = RatioMetric::costs().map(PixelArray::name).collect();
            let cost = format!("({})", costs.join("|"));
            let pattern = format!("^ *{cost} */ *{cost} *$");
            schemas.push(json!({ "type": "string", "pattern": pattern }));
            samples.push(json!(RATIO));
        }
        (!schemas.is_empty()).then(|| Accepted {
            schema: any_of(schemas),
            samples,
        })
    }

    fn number(&mut self) -> Option<Accepted> {
        let expected = self
            .expected()
            .filter(|text| text.contains(char::is_numeric));
        if let Some(known) = expected.as_ref().and_then(|text| self.numbers.get(text)) {
            return known.clone();
        }
        let found = numbers::explore(&mut |number| self.attempt(number).is_accepted());
        let found = found.map(|(schema, samples)| Accepted {
            schema,
            samples: samples.into_iter().map(numbers::short).collect(),
        });
        if let Some(expected) = expected {
            self.numbers.insert(expected, found.clone());
        }
        found
    }

    /// Explores booleans. An empty value, which optional keys accept, is the same as no key.
    fn boolean(&self) -> Option<Accepted> {
        let samples = vec![json!(true)];
        let is_accepted = self.attempt(json!(true)).is_accepted();
        let schema = json!({ "type": "boolean" });
        is_accepted.then_some(Accepted { schema, samples })
    }

    fn list(&mut self) -> Option<Accepted> {
        let is_refused = |message: &str| {
            message.starts_with("invalid type") || message.starts_with("unknown variant")
        };
        if self
            .attempt(json!([]))
            .own_message()
            .is_some_and(is_refused)
        {
            return None;
        }
        let mut schema = json!({ "type": "array" });
        let items = self.below(Step::Index(0), "/items");
        let Some(Accepted {
            schema: of_items,
            samples,
        }) = items
        else {
            let samples = vec![json!([])];
            return Some(Accepted { schema, samples });
        };
        schema["items"] = of_items;
        let list = |n: usize, variant: usize| -> Value {
            let item = |i| {
                samples
                    .get((7 * variant + 3 * i * i + i * variant) % samples.len().max(1))
                    .cloned()
            };
            (0..n).filter_map(item).collect()
        };
        let is_length = |n: &usize| {
            let verdict = self.attempt(list(*n, 0));
            !verdict
                .own_message()
                .is_some_and(|message| message.starts_with("invalid length"))
        };
        let lengths: Vec<usize> = (0..=MAX_ITEMS).filter(is_length).collect();
        let (least, most) = (*lengths.first()?, *lengths.last()?);
        if least > 0 {
            schema["minItems"] = json!(least);
        }
        if most < MAX_ITEMS {
            schema["maxItems"] = json!(most);
        }
        let n = least.max(1);
        let samples: Vec<Value> = (0..5).map(|variant| list(n, variant)).collect();
        schema[SAMPLE] = samples[0].clone();
        Some(Accepted { schema, samples })
    }

    fn mapping(&mut self) -> Option<Accepted> {
        let verdict = self.attempt(json!({ UNKNOWN: 0 }));
        let is_inside = matches!(&verdict, Outcome::Refused(below, _) if !below.is_empty());
        let message = verdict.message().unwrap_or_default();
        let is_choice = message.starts_with(&format!("unknown variant `{UNKNOWN}`"));
        if is_choice || message.starts_with(&format!("unknown field `{UNKNOWN}`")) {
            let keys: Vec<String> = quoted(message).map(str::to_owned).collect();
            if let Some((_, pointer)) = self.around.iter().find(|(around, _)| *around == keys) {
                let (schema, samples) = (json!({ "$ref": pointer }), Vec::new());
                return Some(Accepted { schema, samples });
            }
            self.around.push((keys.clone(), self.pointer.clone()));
            let found = self.keys(&keys, is_choice);
            self.around.pop();
            return found;
        }
        if !is_inside && !verdict.is_accepted() {
            return None;
        }
        let of_values = self.below(Step::Key(UNKNOWN.to_owned()), "/additionalProperties");
        let values = of_values.unwrap_or(Accepted {
            schema: json!({}),
            samples: Vec::new(),
        });
        let schema = json!({ "type": "object", "additionalProperties": values.schema });
        let samples = values
            .samples
            .into_iter()
            .map(|value| json!({ "a": value }));
        let samples = samples.take(2).collect();
        Some(Accepted { schema, samples })
    }

    /// Explores a mapping with these keys; with exactly one of them if it is a choice.
    fn keys(&mut self, keys: &[String], is_choice: bool) -> Option<Accepted> {
        let mut properties = Map::new();
        let mut samples = Map::new();
        for (i, key) in keys.iter().enumerate() {
            let found = self.below(Step::Key(key.clone()), &format!("/properties/{key}"));
            let Some(found) = found else {
                continue;
            };
            let expected = {
                self.path.push(Step::Key(key.clone()));
                let expected = self.expected();
                self.path.pop();
                expected
            };
            let mut schema = described(found.schema, keys, key, expected);
            if let Some(sample) = found.samples.get(i % found.samples.len().max(1)) {
                samples.insert(key.clone(), sample.clone());
                schema[SAMPLE] = sample.clone();
            }
            properties.insert(key.clone(), schema);
        }
        if properties.is_empty() {
            return None;
        }
        let mut schema = json!({
            "type": "object",
            "properties": properties,
            "additionalProperties": false,
        });
        // A mapping whose keys are variants may have several.
        let is_choice = is_choice && {
            let two: Map<String, Value> = samples.clone().into_iter().take(2).collect();
            two.len() < 2 || !self.attempt(Value::Object(two)).is_accepted()
        };
        // A study takes paths of values as keys.
        let path = format!("{UNKNOWN}.{UNKNOWN}");
        let verdict = self.attempt(json!({ path.as_str(): 0 }));
        if !verdict
            .message()
            .is_some_and(|message| message.starts_with("unknown"))
        {
            let pointer = "/patternProperties/[.\\[]";
            let values = self.below(Step::Key(path), pointer);
            let values = values.map_or(json!({}), |values| values.schema);
            schema["patternProperties"] = json!({ "[.\\[]": values });
        }
        if is_choice {
            (schema["minProperties"], schema["maxProperties"]) = (json!(1), json!(1));
            let samples = samples
                .into_iter()
                .map(|(key, value)| json!({ key: value }));
            let samples = samples.collect();
            return Some(Accepted { schema, samples });
        }
        let sample = relations(&|value| self.attempt(value), &samples, &mut schema);
        let samples = vec![Value::Object(sample)];
        schema[SAMPLE] = samples[0].clone();
        Some(Accepted { schema, samples })
    }
}

/// Returns the schema of a key with its doc comment and the values that the parser expects.
fn described(mut schema: Value, keys: &[String], key: &str, expected: Option<String>) -> Value {
    const OF_SERDE: [&str; 10] = [
        "struct ",
        "path string",
        "a sequence",
        "a map",
        "a string",
        "map ",
        "enum",
        "an array",
        "unit",
        "tuple",
    ];
    let is_own = |text: &String| !OF_SERDE.iter().any(|start| text.starts_with(start));
    let doc = doc_comments::find(keys, key);
    let expected = expected
        .filter(is_own)
        .map(|text| format!("Expected: {text}."));
    let parts: Vec<String> = doc.into_iter().chain(expected).collect();
    if let (Value::Object(schema), false) = (&mut schema, parts.is_empty()) {
        schema.shift_insert(0, "description".to_owned(), parts.join("\n\n").into());
    }
    schema
}

/// Returns the schemas of keywords, with their doc comments if they have any.
fn keywords(words: &[String]) -> Vec<Value> {
    let docs: Vec<Option<String>> = words
        .iter()
        .map(|word| doc_comments::find(words, word))
        .collect();
    if words.is_empty() {
        Vec::new()
    } else if docs.iter().all(Option::is_none) {
        vec![json!({ "enum": words })]
    } else {
        let keyword = |(word, doc): (&String, Option<String>)| match doc {
            Some(doc) => json!({ "const": word, "description": doc }),
            None => json!({ "const": word }),
        };
        words.iter().zip(docs).map(keyword).collect()
    }
}
