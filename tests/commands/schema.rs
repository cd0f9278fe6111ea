//! The schemas accept what the parser accepts, and refuse structural mistakes.
//!
//! `tests/with-schema` does the same with the validator of PyPI.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use scene::config::Config;
use scene::yaml::Source;
use serde_json::{Value, json};
use tools::schema::SchemaKind;
use tools::study::StudyPlan;

use crate::common::in_repository;

/// Whether a schema accepts a value: the keywords that the schemas here use.
fn accepts(schema: &Value, value: &Value) -> bool {
    let Value::Object(keywords) = schema else {
        return schema == &json!(true);
    };
    keywords.iter().all(|(keyword, rule)| {
        let rules = || rule.as_array().unwrap().iter();
        let (list, map) = (value.as_array(), value.as_object());
        let n = |rule: &Value| rule.as_u64().unwrap() as usize;
        match keyword.as_str() {
            "$schema" | "title" | "description" | "default" | "then" | "else" => true,
            "anyOf" => rules().any(|schema| accepts(schema, value)),
            "allOf" => rules().all(|schema| accepts(schema, value)),
            "not" => !accepts(rule, value),
            "if" => accepts(rule, value) || accepts(&schema["else"], value),
            "const" => rule == value,
            "enum" => rules().any(|word| word == value),
            "type" => match rule {
                Value::Array(types) => types.iter().any(|kind| is_of_type(kind, value)),
                kind => is_of_type(kind, value),
            },
            "minimum" => value.as_f64().is_none_or(|x| x >= rule.as_f64().unwrap()),
            "maximum" => value.as_f64().is_none_or(|x| x <= rule.as_f64().unwrap()),
            "minLength" => value.as_str().is_none_or(|text| !text.is_empty()),
            "maxLength" => value
                .as_str()
                .is_none_or(|text| text.chars().count() <= n(rule)),
            "pattern" => value.as_str().is_none_or(|text| {
                assert_eq!(rule, "^#[0-9a-fA-F]{6}$");
                world::values::hex_color(text).is_some()
            }),
            "items" => list.is_none_or(|list| list.iter().all(|item| accepts(rule, item))),
            "minItems" => list.is_none_or(|list| list.len() >= n(rule)),
            "maxItems" => list.is_none_or(|list| list.len() <= n(rule)),
            "minProperties" => map.is_none_or(|map| map.len() >= n(rule)),
            "maxProperties" => map.is_none_or(|map| map.len() <= n(rule)),
            "required" => {
                map.is_none_or(|map| rules().all(|key| map.contains_key(key.as_str().unwrap())))
            }
            "properties" => map.is_none_or(|map| {
                let inside = |(key, value): (&String, &Value)| {
                    rule.get(key).is_none_or(|schema| accepts(schema, value))
                };
                map.iter().all(inside)
            }),
            "patternProperties" => map.is_none_or(|map| {
                let paths = map.iter().filter(|(key, _)| key.contains(['.', '[']));
                paths
                    .into_iter()
                    .all(|(_, value)| accepts(&rule["[.\\[]"], value))
            }),
            "additionalProperties" => map.is_none_or(|map| {
                let is_path = |key: &str| {
                    schema.get("patternProperties").is_some() && key.contains(['.', '['])
                };
                let is_known = |key: &str| schema["properties"].get(key).is_some() || is_path(key);
                map.iter()
                    .all(|(key, value)| is_known(key) || accepts(rule, value))
            }),
            unknown => panic!("the keyword {unknown}"),
        }
    })
}

fn is_of_type(kind: &Value, value: &Value) -> bool {
    match kind.as_str().unwrap() {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        other => panic!("the type {other}"),
    }
}

fn is_valid(schema: &Value, yaml: &str) -> bool {
    accepts(schema, &serde_yaml::from_str(yaml).unwrap())
}

fn yaml_files(folder: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(in_repository(folder)).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    paths
        .filter(|path| path.extension().is_some_and(|e| e == "yaml"))
        .collect()
}

const KINDS: [(&str, SchemaKind, &str); 5] = [
    ("configs", SchemaKind::Scene, "scene.json"),
    ("configs/library", SchemaKind::Part, "part.json"),
    ("configs/studies", SchemaKind::Study, "study.json"),
    ("configs/studies/ranks", SchemaKind::Study, "study.json"),
    ("configs/studies/16_cores", SchemaKind::Study, "study.json"),
];

#[test]
fn every_file_of_configs_names_its_schema_and_is_valid() {
    for (folder, kind, name) in KINDS {
        let schema = kind.schema();
        for path in yaml_files(folder) {
            let text = fs::read_to_string(&path).unwrap();
            let line = text.lines().next().unwrap();
            let named = line
                .strip_prefix("# yaml-language-server: $schema=")
                .unwrap();
            assert!(
                path.parent()
                    .unwrap()
                    .join(named)
                    .ends_with(Path::new("schema").join(name))
            );
            assert!(is_valid(&schema, &text), "{}", path.display());
        }
    }
    let full = fs::read_to_string(in_repository("tests/full.yaml")).unwrap();
    assert!(is_valid(&SchemaKind::Scene.schema(), &full));
}

#[test]
fn defaults_are_values_that_change_nothing() {
    let schema = SchemaKind::Scene.schema();
    let default = |path: &str| {
        let steps = path.split('.').map(|key| match key {
            "*" => "/additionalProperties".to_owned(),
            key => format!("/properties/{key}"),
        });
        let of_key = schema.pointer(&steps.collect::<String>()).unwrap();
        of_key.get("default").cloned()
    };
    assert_eq!(default("image.samples_per_pixel"), Some(json!(1)));
    assert_eq!(default("image.filter"), Some(json!("box")));
    assert_eq!(default("shading.ambient"), Some(json!(0.05)));
    assert_eq!(default("materials.*.two_sided"), Some(json!(true)));
    assert_eq!(default("camera.look_at.up"), Some(json!([0, 1, 0])));
    assert_eq!(default("fog.anisotropy"), Some(json!(0)));
    assert_eq!(default("camera.look_at.lens.rotation_deg"), Some(json!(0)));
    // Neither a required key nor a value that is computed from others has one.
    assert_eq!(default("image.width"), None);
    assert_eq!(default("camera.look_at.lens.focus_distance"), None);
}

/// `RAYCOST_BLESS=1 cargo test --test commands schema::` writes them anew.
#[test]
fn the_schemas_of_configs_are_those_of_the_program() {
    for (_, kind, name) in KINDS {
        let path = in_repository("configs/schema").join(name);
        let schema = format!("{:#}\n", kind.schema());
        if std::env::var_os("RAYCOST_BLESS").is_some() {
            fs::write(&path, &schema).unwrap();
        }
        let kept = fs::read_to_string(&path).unwrap_or_default();
        assert!(
            kept == schema,
            "{name} is of another raycost: set RAYCOST_BLESS=1"
        );
    }
}

/// Calls `visit` for each value in a scene, with its path as a JSON pointer.
fn visit(value: &Value, pointer: String, visitor: &mut impl FnMut(&str)) {
    visitor(&pointer);
    match value {
        Value::Object(map) => map.iter().for_each(|(key, value)| {
            visit(value, format!("{pointer}/{key}"), visitor);
        }),
        Value::Array(list) => list.iter().enumerate().for_each(|(i, value)| {
            visit(value, format!("{pointer}/{i}"), visitor);
        }),
        _ => {}
    }
}

/// Values that fit some keys and not others.
fn replacements() -> Vec<Value> {
    let mut values = vec![
        json!(true),
        json!("zzz"),
        json!("none"),
        json!("gold"),
        json!("auto"),
        json!("#a0b1c2"),
        json!("#a0b1c"),
        json!([]),
        json!([1]),
        json!([1, 2]),
        json!([0.1, 0.2, 0.3]),
        json!([1, 2, 3, 4]),
        json!({}),
        json!({ "zzz": 1 }),
        json!({ "sphere": { "center": [0, 0, 0], "radius": 1 } }),
    ];
    let numbers = [-1e20, -1e3, -1.0, -0.5, 1e-20, 0.5, 1.5, 1e16];
    values.extend(numbers.map(|x| json!(x)));
    values.extend(
        [
            -1,
            0,
            1,
            2,
            3,
            8,
            16,
            33,
            255,
            256,
            300,
            65_536,
            2_000_000_000,
        ]
        .map(|n| json!(n)),
    );
    values
}

/// Whether a message is about the kind or the range of one value, or about keys: not about
/// values that contradict each other.
fn is_structural(message: &str) -> bool {
    let of_several = [
        "without volume",
        "without area",
        "the zero vector",
        "on one line",
        "without a length",
        "at both ends",
        "more than 1,000",
    ];
    let is_of_one =
        message.contains(" cannot be ") && !of_several.iter().any(|words| message.contains(words));
    let of_keys = [
        "unknown key",
        "needs the key",
        "exactly one key",
        "needs a shape",
        "needs a size",
        "needs an angle of view",
    ];
    is_of_one || of_keys.iter().any(|words| message.contains(words))
}

/// Whether the parser accepts a scene; if not, its message.
fn parsed(scene: &Value) -> Result<(), String> {
    let parsed = Source::new("scene.yaml", scene.to_string()).parse::<Config>();
    parsed.map(drop).map_err(|error| error.to_string())
}

/// Sections with entries that do not depend on each other.
const LISTS: [&str; 3] = ["objects", "materials", "lights"];

/// The scene without what the value at a pointer does not need: without the sections and the
/// entries of lists that the parser does not miss. A scene of a few lines is parsed many times
/// faster than one with everything.
fn reduced(scene: &Value, pointer: &str) -> Value {
    let mut reduced = scene.clone();
    let steps: Vec<&str> = pointer.split('/').skip(1).take(2).collect();
    let Some((section, rest)) = steps.split_first() else {
        return reduced;
    };
    let mut remove = |pointer: &str, key: &str| {
        let before = reduced.clone();
        match reduced.pointer_mut(pointer) {
            Some(Value::Object(map)) => drop(map.shift_remove(key)),
            Some(Value::Array(list)) => list[key.parse::<usize>().unwrap()] = Value::Null,
            _ => return,
        }
        let mut without = reduced.clone();
        drop_nulls(&mut without);
        if parsed(&without).is_err() {
            reduced = before;
        }
    };
    for key in scene
        .as_object()
        .unwrap()
        .keys()
        .filter(|key| key != section)
    {
        remove("", key);
    }
    for list in LISTS {
        let kept = rest.first().filter(|_| list == *section);
        let is_whole = list == *section && kept.is_none();
        for key in keys(&scene[list]).iter().filter(|_| !is_whole) {
            if kept.is_none_or(|kept| kept != key) {
                remove(&format!("/{list}"), key);
            }
        }
    }
    reduced
}

/// The keys of a mapping, or the indices of a list.
fn keys(value: &Value) -> Vec<String> {
    match value {
        Value::Object(map) => map.keys().cloned().collect(),
        Value::Array(list) => (0..list.len()).map(|i| i.to_string()).collect(),
        _ => Vec::new(),
    }
}

/// Removes the entries of sections that stand for nothing, which keep the places of others.
fn drop_nulls(scene: &mut Value) {
    for list in LISTS {
        if let Some(Value::Array(list)) = scene.get_mut(list) {
            list.retain(|entry| !entry.is_null());
        }
    }
}

/// Each value of a scene is replaced by others: what the parser accepts the schema accepts,
/// and what it refuses for the kind of the value or its range the schema refuses, too.
#[test]
fn the_schema_is_as_strict_as_the_parser() {
    let full = fs::read_to_string(in_repository("tests/full.yaml")).unwrap();
    let scene: Value = serde_yaml::from_str(&full).unwrap();
    let schema = SchemaKind::Scene.schema();
    // The pointers of values by what they need of the scene.
    let mut entries: BTreeMap<String, Vec<String>> = BTreeMap::new();
    visit(&scene, String::new(), &mut |pointer| {
        let steps: Vec<&str> = pointer.splitn(4, '/').take(3).collect();
        let is_in_list = steps.get(1).is_some_and(|section| LISTS.contains(section));
        let entry = steps[..steps.len().min(if is_in_list { 3 } else { 2 })].join("/");
        entries.entry(entry).or_default().push(pointer.to_owned());
    });
    let counts = entries.par_iter().map(|(entry, pointers)| {
        let scene = reduced(&scene, entry);
        let of_pointer = |pointer: &String| check_replacements(&scene, pointer, &schema);
        pointers.iter().map(of_pointer).fold([0; 2], sum)
    });
    let [n_accepted, n_refused] = counts.reduce(|| [0; 2], sum);
    println!("{n_accepted} accepted, {n_refused} refused");
    assert!(
        n_accepted > 500 && n_refused > 3000,
        "{n_accepted} {n_refused}"
    );
}

fn sum(a: [u32; 2], b: [u32; 2]) -> [u32; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// Replaces a value of a scene, whose lists have nulls for what it does not need; returns how
/// many replacements were accepted, and how many were refused for their kind or range.
fn check_replacements(scene: &Value, pointer: &str, schema: &Value) -> [u32; 2] {
    let (mut n_accepted, mut n_refused) = (0, 0);
    for value in replacements() {
        let mut changed = scene.clone();
        *changed.pointer_mut(pointer).unwrap() = value.clone();
        drop_nulls(&mut changed);
        let is_valid = accepts(schema, &changed);
        match parsed(&changed) {
            Ok(()) => {
                n_accepted += 1;
                assert!(is_valid, "{pointer}: the parser accepts {value}");
            }
            Err(error) if !is_structural(&error) => {}
            Err(error) => {
                n_refused += 1;
                assert!(!is_valid, "{pointer}: the schema accepts {value}:\n{error}");
            }
        }
    }
    [n_accepted, n_refused]
}

/// Every key of every mapping has a description.
#[test]
fn every_key_is_described() {
    fn undescribed(schema: &Value, path: &str, found: &mut BTreeSet<String>) {
        if schema.is_null() {
            return;
        }
        if let Some(properties) = schema["properties"].as_object() {
            for (key, schema) in properties {
                let path = format!("{path}.{key}");
                let doc = schema["description"].as_str().unwrap_or_default();
                if doc.is_empty() || doc.starts_with("Expected:") {
                    found.insert(path.clone());
                }
                undescribed(schema, &path, found);
            }
        }
        for keyword in ["items", "additionalProperties"] {
            undescribed(&schema[keyword], &format!("{path}[]"), found);
        }
        for schema in schema["anyOf"].as_array().into_iter().flatten() {
            undescribed(schema, path, found);
        }
    }
    let mut found = BTreeSet::new();
    undescribed(&SchemaKind::Scene.schema(), "", &mut found);
    assert_eq!(found, BTreeSet::new());
}

#[test]
fn mistakes_of_studies_are_refused() {
    let schema = SchemaKind::Study.schema();
    let study =
        "title: x\nscenes: [a.yaml]\nvary: { threads: [1, 2], camera.look_at.fov_y_deg: [20] }\n";
    assert!(is_valid(&schema, study));
    scene::yaml::from_str::<StudyPlan>(study).unwrap();
    for (old, new) in [
        ("[a.yaml]", "[]"),
        ("[1, 2]", "[0]"),
        ("[1, 2]", "1"),
        ("threads", "theads"),
        ("title", "titel"),
    ] {
        assert!(!is_valid(&schema, &study.replace(old, new)), "{new}");
    }
}
